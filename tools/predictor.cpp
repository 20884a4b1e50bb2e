#include "tools/predictor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "models/interpolation.hpp"
#include "models/leave_one_out.hpp"
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

// Relative, at a measured posture: what repeated tap tests and slot tests leave open.
constexpr ModalScatter kMeasuredScatter{0.005, 0.05, 0.05};
constexpr double kCoefficientScatter = 0.05;
constexpr double kMostSpeedScatter = 0.05, kMostDepthScatter = 0.4;
constexpr int kDirections = 12;               // over half a turn
constexpr double kSameDirectionSpeed = 0.01;  // relative, of the speed that the limits over direction are for

bool same_question(const RobotState& a, const RobotState& b, bool speed_counts) {
  bool same = a.milling == b.milling && std::abs(a.feed_direction - b.feed_direction) < kSameAngle;
  if (speed_counts) {
    const double change = std::abs(a.spindle_speed_rpm - b.spindle_speed_rpm);
    same = same && change <= kSameDirectionSpeed * b.spindle_speed_rpm;
  }
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
  directions_asked_ = cell.compensation.limits.free_turn > 0.0;
  if (!cell.compensation.feed_map.empty()) feed_map_ = read_feed_map(cell.compensation.feed_map);
  // Superposed responses would have to be fitted at every posture first, which takes too long at start.
  if (interpolation_.kind != InterpolationKind::frf)
    map_scatter_ = left_out_scatter(map_, interpolation_).value_or(ModalScatter{});
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
  if (!computed_for_ || !same_question(*computed_for_, state, directions_asked_)) {
    const auto diagram = again(state);
    if (!diagram) return std::nullopt;
    last_ = *diagram;
    computed_for_ = state;
  }
  last_.posture_stamp_ns = state.stamp_ns;
  last_.usable_from_ns = state.stamp_ns + kUsableAfter_ns;
  return last_;
}

std::optional<LobeDiagram> Predictor::again(const RobotState& state) const {
  Posture posture;
  posture.joints = state.joint_position;
  posture.position = state.tcp_position;
  return at_place(posture, state.feed_direction, state.milling, state.radial_depth,
                  rpm_to_rad_s(state.spindle_speed_rpm));
}

LobeDiagram Predictor::along(const RobotPath& path) const {
  // A path without points, or one that cannot be predicted, takes back what was announced before.
  LobeDiagram taken_back;
  taken_back.ahead = true;
  taken_back.usable_from_ns = path.stamp_ns + kUsableAfter_ns;
  std::optional<LobeDiagram> least;
  for (const PathPoint& point : std::span{path.points}.first(path.count)) {
    Posture posture;
    posture.joints = point.joint_position;
    posture.position = point.tcp_position;
    const auto diagram = at_place(posture, point.feed_direction, point.milling, point.radial_depth, 0.0);
    if (!diagram || !diagram->valid) return taken_back;
    if (!least) least = diagram;
    least->speed_scatter = std::max(least->speed_scatter, diagram->speed_scatter);
    least->depth_scatter = std::max(least->depth_scatter, diagram->depth_scatter);
    for (std::size_t i = 0; i < static_cast<std::size_t>(diagram->point_count); ++i) {
      const LobePoint &a = least->points[i], &b = diagram->points[i];
      if (std::isnan(b.depth_limit) || b.depth_limit < a.depth_limit) least->points[i] = b;
    }
  }
  if (!least) return taken_back;
  least->ahead = true;
  least->posture_stamp_ns = path.stamp_ns;
  least->usable_from_ns = path.stamp_ns + static_cast<std::int64_t>(path.count + 1) * kUsableAfter_ns;
  least->usable_until_ns = path.stamp_ns + static_cast<std::int64_t>(path.points[path.count - 1].after * 1e9);
  return *least;
}

// A diagram for an immersion or posture that cannot be is none: no diagram is better than a wrong one.
std::optional<LobeDiagram> Predictor::at_place(const Posture& posture, double feed_direction, Milling milling,
                                               double radial_depth, double directions_at_speed) const {
  Cut cut = cut_;
  cut.feed_direction = feed_direction;
  if (milling != Milling::unknown) cut.milling = milling;
  if (std::isfinite(radial_depth)) cut.radial_depth = radial_depth;
  try {
    const PredictedPosture predicted = predict(posture);
    LobeDiagram diagram = compute(predicted, cut);
    const bool in_range = directions_at_speed >= spindle_.min_speed && directions_at_speed <= spindle_.max_speed;
    if (directions_asked_ && in_range) add_directions(predicted.posture.modes, cut, directions_at_speed, diagram);
    diagram.planned_direction = planned_direction(feed_map_, posture.position[0], posture.position[1]);
    return diagram;
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
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
  add_scatter(predicted, diagram);
  if (predicted.outside) diagram.valid = false;  // far from every tap test: say nothing rather than extrapolate
  return diagram;
}

// Limits at this one speed in every direction; a feed and its opposite meet the same structure.
void Predictor::add_directions(const std::vector<Mode>& modes, Cut cut, double speed, LobeDiagram& diagram) const {
  diagram.direction_speed = speed;
  diagram.direction_count = kDirections;
  for (int i = 0; i < kDirections; ++i) {
    cut.feed_direction = std::numbers::pi * i / kDirections;
    const std::array<double, 1> at{speed};
    const DepthLimit limit = depth_limits(tool_, material_, cut, modes, at, {}).front();
    diagram.directions[static_cast<std::size_t>(i)] = {cut.feed_direction, limit.depth};
  }
}

// Between two measured postures the scatter grows from that of a measurement to that of the map. A limit is as
// uncertain as stiffness, damping and cutting coefficients together, the lobes' speeds as the frequencies.
void Predictor::add_scatter(const PredictedPosture& predicted, LobeDiagram& diagram) const {
  const double share = predicted.map_spacing > 0.0
                           ? std::clamp(2.0 * predicted.nearest_distance / predicted.map_spacing, 0.0, 1.0)
                           : 0.0;
  const auto between = [&](double measured, double map) { return std::lerp(measured, std::max(measured, map), share); };
  const double damping = between(kMeasuredScatter.damping, map_scatter_.damping);
  const double stiffness = between(kMeasuredScatter.stiffness, map_scatter_.stiffness);
  diagram.speed_scatter = std::min(kMostSpeedScatter, between(kMeasuredScatter.frequency, map_scatter_.frequency));
  diagram.depth_scatter = std::min(kMostDepthScatter, std::hypot(damping, stiffness, kCoefficientScatter));
}

}  // namespace stillcut
