// What `stillcut lobes` answers: a stability lobe diagram for each posture and feed direction asked, with the
// mode-coupling limit and, when asked, the band of confidence; and how it is written for programs and people.
#pragma once

#include <functional>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "models/confidence.hpp"
#include "models/interpolation.hpp"
#include "models/lobes.hpp"
#include "models/mode_coupling.hpp"
#include "tools/cell_posture.hpp"

namespace stillcut {

// Relative standard deviations that a user stated.
struct ToleranceAsked {
  std::optional<double> frequency, damping, stiffness, ktc;
};

struct LobeQuestion {
  std::vector<std::string> postures;    // as --posture takes them; empty: the cell's
  std::vector<double> feed_directions;  // rad; empty: the cell's
  std::vector<double> speeds;           // rad/s
  LobeSettings settings;
  std::optional<Confidence> confidence;  // with a band
  ToleranceAsked tolerance;              // what is not stated is the map's leave-one-out scatter, or a default
};

struct LobeCurve {
  PredictedPosture predicted;
  Cut cut;                         // with the curve's feed direction
  std::vector<DepthLimit> limits;  // one a speed
  std::vector<DepthBand> bands;    // one a speed, or none
  ModeCouplingLimit coupling;
  std::optional<ModeCouplingLimit> undamped_coupling;  // none where there are too many modes to compute it
};

struct LobeStudy {
  LobeQuestion question;
  Tolerance tolerance;                // of the bands
  bool map_scatter = false;           // whether the map's leave-one-out scatter went into it
  double coupling_below = 0.0;        // rad/s, the highest frequency of mode coupling looked for
  std::vector<LobeCurve> curves;      // every posture in every feed direction
  std::vector<std::string> warnings;  // lines that the user must read
};

// Up to which frequency (rad/s) a mean over the turning tool tells of mode coupling at every one of the speeds: the
// tooth-passing frequency of the lowest.
double slow_beside_teeth(const Tool& tool, std::span<const double> speeds);

// Computes all curves. Throws InputError. `progress` is told the share done.
LobeStudy study_lobes(const Cell& cell, const LobeQuestion& question, const std::function<void(double)>& progress);

// spindle_speed_rpm,a_lim_mm,chatter_frequency_hz; before them posture,feed_direction_deg where there are several
// curves, after them a_low_mm,a_high_mm where a confidence was asked.
void write_lobes_csv(const LobeStudy& study, std::ostream& out);

// One object; where there are several curves it holds one for each in the list "diagrams".
nlohmann::ordered_json lobes_json(const LobeStudy& study);

// Two lines a curve for people: its lowest and highest limit, and the mode coupling.
void print_lobes_summary(const LobeStudy& study, std::ostream& out);

// "from 8.3 mm on, at 14.2 Hz"; "none up to 20 mm"; "at every depth". Depth in m.
std::string coupling_text(const ModeCouplingLimit& limit, double max_depth);

// "home, 45°": what tells this curve from the others.
std::string curve_name(const LobeCurve& curve);

}  // namespace stillcut
