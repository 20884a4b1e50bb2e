#include "tools/predictor.hpp"

#include <cmath>
#include <stdexcept>

#include "models/interpolation.hpp"
#include "models/lobes.hpp"
#include "models/modal_refit.hpp"
#include "tools/cell_posture.hpp"

namespace stillcut {
namespace {

// From a robot state's stamp to the first use of its diagram: more than the computation takes, so that live run and
// playback agree on when a diagram came into use.
constexpr std::int64_t kUsableAfter_ns = 250'000'000;
constexpr int kPoints = 121;  // of a diagram: what the model thread computes in a fraction of that time
// A posture that has moved less than this since the last computation has the same lobes.
constexpr double kSameAngle = 0.005;    // rad
constexpr double kSameLength = 0.0005;  // m

bool same_question(const RobotState& a, const RobotState& b) {
  bool same = a.milling == b.milling && std::abs(a.feed_direction - b.feed_direction) < kSameAngle;
  for (std::size_t j = 0; j < 6; ++j) same = same && std::abs(a.joint_position[j] - b.joint_position[j]) < kSameAngle;
  for (std::size_t i = 0; i < 3; ++i) same = same && std::abs(a.tcp_position[i] - b.tcp_position[i]) < kSameLength;
  const bool both_unknown = std::isnan(a.radial_depth) && std::isnan(b.radial_depth);
  return same && (both_unknown || std::abs(a.radial_depth - b.radial_depth) < 0.1 * kSameLength);
}

}  // namespace

Predictor::Predictor(const Cell& cell) : cell_file_{cell.file.string()} {
  tool_ = require(cell, cell.tool, "tool");
  material_ = require(cell, cell.material, "material");
  cut_ = require(cell, cell.cut, "cut");
  spindle_ = require(cell, cell.spindle, "spindle");
  CellDynamics dynamics = read_cell_dynamics(cell);
  map_ = std::move(dynamics.map);
  interpolation_ = dynamics.interpolation;
  posture_ = posture_of(cell, map_);
}

NominalPrediction Predictor::nominal() const {
  const PredictedPosture predicted = predict(posture_);
  try {
    LobeDiagram diagram = compute(predicted, cut_);
    if (predicted.outside)
      return {diagram, cell_file_ + ": dynamics.posture: " + outside_map_text(predicted) +
                           "; no prediction is used; tap the robot there"};
    return {diagram, slow_fit_warning()};
  } catch (const std::invalid_argument& error) {
    LobeDiagram modes_only;
    summarise_modes(predicted.posture.modes, modes_only);
    modes_only.valid = true;
    return {modes_only, cell_file_ + ": no stability lobes, chatter is judged by what is heard alone: " + error.what()};
  }
}

std::optional<LobeDiagram> Predictor::at(const RobotState& state) {
  if (!computed_for_ || !same_question(*computed_for_, state)) {
    Posture posture;
    posture.joints = state.joint_position;
    posture.position = state.tcp_position;
    Cut cut = cut_;
    cut.feed_direction = state.feed_direction;
    if (state.milling != Milling::unknown) cut.milling = state.milling;
    if (std::isfinite(state.radial_depth)) cut.radial_depth = state.radial_depth;
    try {
      last_ = compute(predict(posture), cut);
    } catch (const std::invalid_argument&) {
      return std::nullopt;  // an immersion or posture that cannot be; no diagram is better than a wrong one
    }
    computed_for_ = state;
  }
  last_.posture_stamp_ns = state.stamp_ns;
  last_.usable_from_ns = state.stamp_ns + kUsableAfter_ns;
  return last_;
}

PredictedPosture Predictor::predict(const Posture& posture) const {
  return with_few_modes(predict_posture(map_, posture, interpolation_));
}

// Between measured postures `frf` has the modes of all of them, and more than a few are fitted anew each time.
std::string Predictor::slow_fit_warning() const {
  std::size_t modes = 0;
  for (const Posture& posture : map_.postures) modes += posture.modes.size();
  if (interpolation_.kind != InterpolationKind::frf || modes <= kMostRefitModes) return {};
  return cell_file_ +
         ": dynamics.interpolation: \"frf\" fits the modes anew at every posture, often too late for an arm that "
         "moves; "
         "use \"modal\" or \"trend\"";
}

LobeDiagram Predictor::compute(const PredictedPosture& predicted, const Cut& cut) const {
  LobeDiagram diagram =
      compute_lobe_diagram(tool_, material_, cut, spindle_, predicted.posture.modes, {.points = kPoints});
  if (predicted.outside) diagram.valid = false;  // far from every tap test: say nothing rather than extrapolate
  return diagram;
}

}  // namespace stillcut
