#include "models/cutter_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <stdexcept>

namespace stillcut {
namespace {

bool positive(double value) { return value > 0.0 && std::isfinite(value); }

void check_cut(const Cut& cut) {
  if (!positive(cut.feed_per_tooth)) throw std::invalid_argument("feed per tooth: must be a positive number");
  if (!positive(cut.spindle_speed)) throw std::invalid_argument("spindle speed: must be a positive number");
  if (!positive(cut.axial_depth))
    throw std::invalid_argument("axial depth: must be a positive number, the tool does not reach the part otherwise");
  if (cut.step_over < 0.0 || !positive(step_over_of(cut)))
    throw std::invalid_argument("step-over, or the radial depth in its place: must be a positive number");
  if (!std::isfinite(cut.tilt) || !std::isfinite(cut.lead) || !std::isfinite(cut.redundancy))
    throw std::invalid_argument("tilt, lead and redundancy: must be numbers");
}

}  // namespace

void check_teeth(const Tool& tool) {
  if (tool.teeth < 1 || tool.pitch.size() != static_cast<std::size_t>(tool.teeth) || !positive(tool.diameter))
    throw std::invalid_argument("a tool needs a diameter, at least one tooth and one pitch angle a tooth");
  if (!(tool.runout >= 0.0 && tool.runout < 0.5 * tool.diameter) || !std::isfinite(tool.axial_runout))
    throw std::invalid_argument("runout: must lie between 0 and the tool's radius");
}

std::vector<double> tooth_angles(const Tool& tool) {
  std::vector<double> angles;
  for (double angle = 0.0; const double pitch : tool.pitch) {
    angles.push_back(angle);
    angle += pitch;
  }
  return angles;
}

std::vector<double> axial_offsets(const Tool& tool) {
  std::vector<double> offsets = tooth_angles(tool);
  for (double& offset : offsets) offset = tool.axial_runout * std::cos(offset - tool.runout_angle);
  return offsets;
}

Displacement sampled_displacement(double first_time, double step, std::vector<Eigen::Vector3f> samples) {
  if (samples.empty() || !positive(step))
    throw std::invalid_argument("a sampled displacement needs samples and a positive step");
  Displacement result;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    result.reach = result.reach.cwiseMax(samples[i].cast<double>().cwiseAbs());
    if (i > 0) result.speed = std::max(result.speed, (samples[i] - samples[i - 1]).cast<double>().norm() / step);
  }
  // Shared by the copies of a motion, of which every sweep has one: they may be hundreds of megabytes.
  const auto shared = std::make_shared<const std::vector<Eigen::Vector3f>>(std::move(samples));
  result.at = [first_time, step, shared](double time) -> Eigen::Vector3d {
    const std::vector<Eigen::Vector3f>& at = *shared;
    const double position = std::clamp((time - first_time) / step, 0.0, static_cast<double>(at.size() - 1));
    const auto low = static_cast<std::size_t>(position);
    const std::size_t high = std::min(low + 1, at.size() - 1);
    const Eigen::Vector3d from = at[low].cast<double>();
    return from + (position - static_cast<double>(low)) * (at[high].cast<double>() - from);
  };
  return result;
}

EdgePoint ball_edge_point(const Tool& tool, double kappa) {
  const double radius = 0.5 * tool.diameter;
  return {radius * std::sin(kappa), -radius * std::cos(kappa), std::tan(tool.helix) * (1.0 - std::cos(kappa))};
}

EdgePoint bottom_edge_point(const Tool& /*tool*/, double radius) { return {radius, 0.0, 0.0}; }

EdgePoint wall_edge_point(const Tool& tool, double height) {
  return {0.5 * tool.diameter, height, std::tan(tool.helix) * height / (0.5 * tool.diameter)};
}

double CutterMotion::inclination() const { return std::acos(std::clamp(orientation(2, 2), -1.0, 1.0)); }

CutterMotion cutter_motion(const Tool& tool, const Cut& cut, Displacement displacement) {
  check_teeth(tool);
  check_cut(cut);
  using Eigen::AngleAxisd, Eigen::Vector3d;
  CutterMotion motion;
  motion.tool = tool;
  motion.spindle_speed = cut.spindle_speed;
  motion.feed_rate = cut.feed_per_tooth * tool.teeth * cut.spindle_speed / kTwoPi;
  motion.orientation = (AngleAxisd(cut.tilt, Vector3d::UnitX()) * AngleAxisd(cut.lead, Vector3d::UnitY()) *
                        AngleAxisd(cut.redundancy, Vector3d::UnitZ()))
                           .toRotationMatrix();
  motion.from_workpiece = AngleAxisd(-cut.feed_direction, Vector3d::UnitZ()).toRotationMatrix();
  // A ball touches the surface however it is inclined; an inclined end mill does so with one point of its corner.
  motion.height = 0.5 * tool.diameter * (tool.shape == ToolShape::ball ? 1.0 : std::sin(motion.inclination()));
  motion.tooth_angle = tooth_angles(tool);
  motion.axial_offset = axial_offsets(tool);
  motion.displacement = std::move(displacement);
  return motion;
}

Eigen::Vector3d displacement_at(const CutterMotion& motion, double time) {
  if (!motion.displacement.at) return Eigen::Vector3d::Zero();
  return motion.from_workpiece * motion.displacement.at(time);
}

Eigen::Vector3d runout_offset(const Tool& tool, double spindle_angle, double axial_offset) {
  const double angle = spindle_angle + tool.runout_angle;
  return {tool.runout * std::sin(angle), tool.runout * std::cos(angle), axial_offset};
}

Eigen::Vector3d edge_position(const CutterMotion& motion, const CutterPass& pass, std::size_t tooth,
                              const EdgePoint& point, double time) {
  const double spindle = pass.angle + motion.spindle_speed * time;
  // Eqs 1 and 4 would both turn the edge, in opposite senses: it turns once, clockwise, as the teeth do in
  // docs/conventions.md.
  const double phi = spindle + motion.tooth_angle[tooth] - point.lag;
  const Eigen::Vector3d in_spindle =
      Eigen::Vector3d(point.radius * std::sin(phi), point.radius * std::cos(phi), point.height) +
      runout_offset(motion.tool, spindle, motion.axial_offset[tooth]);
  const double travelled = (pass.reversed ? -1.0 : 1.0) * motion.feed_rate * time;
  // Eq. 25 would turn the vibration with the tool, as if it had been solved in axes that rotate. Ours is in workpiece
  // axes: it comes after the turning, and all that is left is the feed's direction.
  return Eigen::Vector3d(pass.begin + travelled, pass.across, motion.height) + motion.orientation * in_spindle +
         displacement_at(motion, pass.time + time);
}

std::vector<CutterPass> parallel_passes(const CutterMotion& motion, const Cut& cut, double begin, double length,
                                        double across, std::size_t count, double turn_time) {
  if (!positive(length) || !(turn_time >= 0.0))
    throw std::invalid_argument("passes: their length must be positive, the time between them not negative");
  const double period = length / motion.feed_rate + turn_time;
  std::vector<CutterPass> passes(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto index = static_cast<double>(i);
    CutterPass& pass = passes[i];
    pass.reversed = cut.path == PathKind::zigzag && i % 2 == 1;
    pass.begin = pass.reversed ? begin + length : begin;
    pass.length = length;
    pass.across = across + index * step_over_of(cut);
    pass.time = index * period;
    pass.angle = std::remainder(motion.spindle_speed * pass.time, kTwoPi);
  }
  return passes;
}

}  // namespace stillcut
