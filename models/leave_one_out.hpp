// How far a dynamics map can be trusted between its postures: every posture is predicted from all the others, and the
// prediction is held beside its own measurement. Four ways side by side, and which of them to use for this map.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dsp/numbers.hpp"
#include "models/confidence.hpp"
#include "models/interpolation.hpp"

namespace stillcut {

// `mean`: every mode's mean over the other postures, wherever they stand. It is no way to predict but what a map has to
// beat; the others are the interpolations of models/interpolation.
enum class MapMethod { mean, frf, modal, trend };
inline constexpr std::array kMapMethods{MapMethod::mean, MapMethod::frf, MapMethod::modal, MapMethod::trend};
const char* name_of(MapMethod method);

// A measured mode and what was predicted for it: nothing where the predicted mode is half an octave off, or points half
// a right angle's cosine elsewhere (mode_difference above 0.5). Errors are relative, predicted/measured - 1; NaN where
// none was.
struct ModePrediction {
  Mode measured;
  std::optional<Mode> predicted;  // paired by models/mode_pairs
  double frequency_error = kNaN, damping_error = frequency_error;
  double peak_error = frequency_error;  // of the mode's own peak receptance, 1/(2 k zeta)
};

// One posture predicted by one way. Responses are compared by the largest singular value of the receptance tensor over
// frequency (models/receptance_peaks).
struct LeftOutPrediction {
  std::vector<ModePrediction> modes;                 // one for each measured mode, in rising frequency
  double measured_peak = 0.0, predicted_peak = 0.0;  // m/N, highest of the response
  double peak_error = 0.0;                           // relative
  int spurious_peaks = 0;                            // peaks of the predicted response beyond the number measured
  int missing_peaks = 0;                             // the other way round
};

struct LeftOutPosture {
  std::string id, nearest;                                      // itself, and the nearest of the others
  double nearest_distance = 0.0;                                // rad or m
  bool outside = false;                                         // of the map without it
  std::array<LeftOutPrediction, kMapMethods.size()> by_method;  // in the order of kMapMethods

  [[nodiscard]] const LeftOutPrediction& by(MapMethod method) const {
    return by_method[static_cast<std::size_t>(method)];
  }
};

struct WorstAndRms {
  double worst = 0.0, rms = 0.0;  // of the absolute values
};

struct MethodErrors {
  WorstAndRms first_frequency, frequency, damping;               // relative: the lowest measured mode; all modes
  WorstAndRms mode_peak, peak;                                   // relative: of each mode; of the whole response
  int spurious_peaks = 0, missing_peaks = 0, missing_modes = 0;  // sums
  // One number to choose by: root mean square over modes of the frequency error in half-widths (zeta) together with
  // the relative error of the mode's peak; a missing mode counts 1, and so does every spurious peak.
  double score = 0.0;
};

struct LeaveOneOut {
  bool in_joints = false;          // distances in rad; otherwise m
  std::vector<MapMethod> methods;  // those that were tried, in the order of kMapMethods; the others have no figures
  std::vector<LeftOutPosture> postures;
  std::array<MethodErrors, kMapMethods.size()> total;
  MapMethod best =
      MapMethod::modal;     // lowest score of the three interpolations; the plainer one where they are within 5 %
  bool beats_mean = false;  // whether its score is below that of the mean

  [[nodiscard]] const MethodErrors& of(MapMethod method) const { return total[static_cast<std::size_t>(method)]; }
};

// For `frf` the superposed modes are first fitted with as many as were measured (models/modal_refit), as one identifies
// modes in a predicted response; peaks are counted in the superposed response itself. Postures may have different
// numbers of modes; a posture for which a way finds none counts all its modes as missing. `power` and `joint_scale` of
// `interpolation` hold, its kind does not matter. `progress` is told the share done, 0 to 1. `with_frf` false leaves
// that way out, whose fits cost a second a posture in a map of 49. Throws std::invalid_argument for a map of fewer than
// two postures, and as predict_posture does.
LeaveOneOut leave_one_out(const DynamicsMap& map, const Interpolation& interpolation = {},
                          const std::function<void(double)>& progress = {}, bool with_frf = true);

// How far the map's own way (all of `interpolation` holds) is off at postures that were left out: root mean square of
// the relative errors over all modes, for bands of confidence. Nothing where the map is too small to tell. Throws as
// leave_one_out does for modes.
std::optional<ModalScatter> left_out_scatter(const DynamicsMap& map, const Interpolation& interpolation);

}  // namespace stillcut
