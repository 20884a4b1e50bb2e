#include "models/leave_one_out.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "models/modal_refit.hpp"
#include "models/mode_pairs.hpp"
#include "models/receptance.hpp"
#include "models/receptance_peaks.hpp"

namespace stillcut {
namespace {

constexpr double kAnotherMode = 0.5;  // half an octave, or half a right angle's cosine: not the measured mode

double relative(double predicted, double measured) { return predicted / measured - 1.0; }
double peak_of(const Mode& mode) { return 1.0 / (2.0 * mode.stiffness * mode.damping_ratio); }

// The interpolation that a way is; nothing for the mean.
std::optional<InterpolationKind> kind_of(MapMethod method) {
  switch (method) {
    case MapMethod::frf:
      return InterpolationKind::frf;
    case MapMethod::modal:
      return InterpolationKind::modal;
    case MapMethod::trend:
      return InterpolationKind::trend;
    case MapMethod::mean:
      break;
  }
  return std::nullopt;
}

MapMethod method_of(InterpolationKind kind) {
  return *std::find_if(kMapMethods.begin(), kMapMethods.end(),
                       [&](MapMethod method) { return kind_of(method) == kind; });
}

// The modes of the response that a way predicts; empty where the others have no mode in common.
std::vector<Mode> predicted_modes(const DynamicsMap& others, const Posture& left_out, MapMethod method,
                                  Interpolation interpolation) {
  try {
    if (!kind_of(method)) {
      const std::vector<double> equal(others.postures.size(), 1.0 / static_cast<double>(others.postures.size()));
      return average_modes(others, equal, interpolation.joint_scale);
    }
    interpolation.kind = *kind_of(method);
    return predict_posture(others, left_out, interpolation).posture.modes;
  } catch (const std::invalid_argument&) {
    return {};
  }
}

// Each measured mode with the one that was predicted for it.
std::vector<ModePrediction> paired(std::span<const Mode> measured, std::span<const Mode> predicted) {
  std::vector<ModePrediction> result;
  const auto pairs = pair_modes(measured, predicted);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    ModePrediction& mode = result.emplace_back();
    mode.measured = measured[i];
    if (!pairs[i] || mode_difference(mode.measured, predicted[*pairs[i]]) > kAnotherMode) continue;
    mode.predicted = predicted[*pairs[i]];
    mode.frequency_error = relative(mode.predicted->natural_frequency, mode.measured.natural_frequency);
    mode.damping_error = relative(mode.predicted->damping_ratio, mode.measured.damping_ratio);
    mode.peak_error = relative(peak_of(*mode.predicted), peak_of(mode.measured));
  }
  return result;
}

DynamicsMap without(const DynamicsMap& map, std::size_t left_out) {
  DynamicsMap others = map;
  others.postures.erase(others.postures.begin() + static_cast<std::ptrdiff_t>(left_out));
  return others;
}

LeftOutPrediction compare(const Posture& measured, const std::vector<ReceptancePeak>& measured_peaks,
                          const std::vector<Mode>& response, MapMethod method) {
  LeftOutPrediction result;
  result.measured_peak = highest_peak(measured_peaks).receptance;
  std::vector<Mode> modes = response;
  if (!response.empty()) {
    const std::vector<ReceptancePeak> peaks = receptance_peaks(response);
    result.predicted_peak = highest_peak(peaks).receptance;
    const int beyond = static_cast<int>(peaks.size()) - static_cast<int>(measured_peaks.size());
    result.spurious_peaks = std::max(0, beyond);
    result.missing_peaks = std::max(0, -beyond);
    if (method == MapMethod::frf) modes = refit_modes(response, measured.modes.size()).modes;
  } else {
    result.missing_peaks = static_cast<int>(measured_peaks.size());
  }
  result.peak_error = relative(result.predicted_peak, result.measured_peak);
  result.modes = paired(measured.modes, modes);
  return result;
}

// Gathers absolute errors, those that exist.
class Gather {
 public:
  void add(double error) {
    if (std::isnan(error)) return;
    worst_ = std::max(worst_, std::abs(error));
    squares_ += error * error;
    ++count_;
  }
  [[nodiscard]] WorstAndRms result() const {
    return {worst_, count_ == 0 ? 0.0 : std::sqrt(squares_ / static_cast<double>(count_))};
  }

 private:
  double worst_ = 0.0, squares_ = 0.0;
  int count_ = 0;
};

MethodErrors summed(const std::vector<LeftOutPosture>& postures, MapMethod method) {
  MethodErrors total;
  Gather first, frequency, damping, mode_peak, peak;
  double squares = 0.0;
  int count = 0;
  for (const LeftOutPosture& posture : postures) {
    const LeftOutPrediction& prediction = posture.by(method);
    total.spurious_peaks += prediction.spurious_peaks;
    total.missing_peaks += prediction.missing_peaks;
    peak.add(prediction.peak_error);
    first.add(prediction.modes.front().frequency_error);
    squares += prediction.spurious_peaks;
    for (const ModePrediction& mode : prediction.modes) {
      ++count;
      if (!mode.predicted) ++total.missing_modes;
      frequency.add(mode.frequency_error);
      damping.add(mode.damping_error);
      mode_peak.add(mode.peak_error);
      const double half_widths = mode.frequency_error / mode.measured.damping_ratio;
      squares += mode.predicted ? half_widths * half_widths + mode.peak_error * mode.peak_error : 1.0;
    }
  }
  total.first_frequency = first.result();
  total.frequency = frequency.result();
  total.damping = damping.result();
  total.mode_peak = mode_peak.result();
  total.peak = peak.result();
  total.score = std::sqrt(squares / count);
  return total;
}

MapMethod best_of(const LeaveOneOut& report) {
  constexpr double kClearlyBetter = 0.95, kNothing = 1e-3;
  MapMethod best = MapMethod::modal;
  for (const MapMethod method : {MapMethod::trend, MapMethod::frf}) {
    if (std::find(report.methods.begin(), report.methods.end(), method) == report.methods.end()) continue;
    if (report.of(method).score < kClearlyBetter * report.of(best).score - kNothing) best = method;
  }
  return best;
}

}  // namespace

const char* name_of(MapMethod method) {
  const auto kind = kind_of(method);
  return kind ? kInterpolationNames[static_cast<std::size_t>(*kind)] : "mean";
}

LeaveOneOut leave_one_out(const DynamicsMap& map, const Interpolation& interpolation,
                          const std::function<void(double)>& progress, bool with_frf) {
  if (map.postures.size() < 2) {
    throw std::invalid_argument("dynamics map: leaving one out needs two postures at least; it holds " +
                                std::to_string(map.postures.size()));
  }
  check_map(map);
  LeaveOneOut report;
  report.in_joints = map.has_joints;
  for (const MapMethod method : kMapMethods)
    if (with_frf || method != MapMethod::frf) report.methods.push_back(method);
  for (std::size_t left = 0; left < map.postures.size(); ++left) {
    if (progress) progress(static_cast<double>(left) / static_cast<double>(map.postures.size()));
    const DynamicsMap others = without(map, left);
    Posture measured = map.postures[left];
    sort_modes(measured.modes);
    const std::vector<ReceptancePeak> peaks = receptance_peaks(measured.modes);
    // The superposition never lacks a mode, so it can tell the distances in every map.
    const PredictedPosture superposed = predict_posture(
        others, measured,
        {.kind = InterpolationKind::frf, .power = interpolation.power, .joint_scale = interpolation.joint_scale});
    LeftOutPosture& posture = report.postures.emplace_back();
    posture.id = measured.id;
    posture.nearest = superposed.nearest;
    posture.nearest_distance = superposed.nearest_distance;
    posture.outside = superposed.outside;
    for (const MapMethod method : report.methods) {
      posture.by_method[static_cast<std::size_t>(method)] =
          compare(measured, peaks, predicted_modes(others, measured, method, interpolation), method);
    }
  }
  for (const MapMethod method : report.methods)
    report.total[static_cast<std::size_t>(method)] = summed(report.postures, method);
  report.best = best_of(report);
  report.beats_mean = report.of(report.best).score < report.of(MapMethod::mean).score;
  return report;
}

std::optional<ModalScatter> left_out_scatter(const DynamicsMap& map, const Interpolation& interpolation) {
  constexpr int kFew = 4;  // errors from which no scatter can be told
  check_map(map);
  if (map.postures.size() < 2) return std::nullopt;
  const MapMethod method = method_of(interpolation.kind);
  ModalScatter squares{0.0, 0.0, 0.0};
  int count = 0;
  for (std::size_t left = 0; left < map.postures.size(); ++left) {
    const Posture& measured = map.postures[left];
    std::vector<Mode> modes = predicted_modes(without(map, left), measured, method, interpolation);
    if (method == MapMethod::frf && !modes.empty()) modes = refit_modes(modes, measured.modes.size()).modes;
    for (const ModePrediction& mode : paired(measured.modes, modes)) {
      if (!mode.predicted) continue;
      const double stiffness_error = relative(mode.predicted->stiffness, mode.measured.stiffness);
      squares.frequency += mode.frequency_error * mode.frequency_error;
      squares.damping += mode.damping_error * mode.damping_error;
      squares.stiffness += stiffness_error * stiffness_error;
      ++count;
    }
  }
  if (count < kFew) return std::nullopt;
  constexpr double kMost = 0.99;  // a deviation has to stay below 1
  const auto rms = [&](double sum) { return std::min(kMost, std::sqrt(sum / count)); };
  return ModalScatter{rms(squares.frequency), rms(squares.damping), rms(squares.stiffness)};
}

}  // namespace stillcut
