#include "models/part_milling.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "models/edge_force.hpp"

namespace stillcut {
namespace {

constexpr double kFewestPartSteps = 30.0;  // a turn: the paper's own limit for the part's shape
constexpr double kMostPartSteps = 1e5;     // a turn
constexpr double kFurthestOff = 0.5;       // m off the path: no machine is there any more

void check_part_milling(const PartMillingSetup& setup) {
  const Tool& tool = setup.tool;
  if (tool.teeth < 1 || tool.pitch.size() != static_cast<std::size_t>(tool.teeth) || !(tool.diameter > 0.0))
    throw std::invalid_argument("a tool needs a diameter, at least one tooth and one pitch angle a tooth");
  if (tool.shape != ToolShape::end) throw std::invalid_argument("milling in a part of slices needs an end mill");
  if (!(setup.axial_depth > 0.0 && std::isfinite(setup.axial_depth)))
    throw std::invalid_argument("axial depth: must be a positive number");
  if (!(setup.spindle_speed > 0.0 && std::isfinite(setup.spindle_speed)))
    throw std::invalid_argument("spindle speed: must be a positive number");
  if (!(setup.steps_per_turn >= kFewestPartSteps && setup.steps_per_turn <= kMostPartSteps))
    throw std::invalid_argument("steps a turn: between 30, which the part's shape needs, and 100000");
  if (setup.chords < 1 || setup.discs < 0) throw std::invalid_argument("chords a step and discs: must be positive");
  if (!setup.path || !setup.structure) throw std::invalid_argument("milling needs a path and a structure");
}

}  // namespace

PartMilling::PartMilling(PartMillingSetup setup) : setup_{std::move(setup)} {
  check_part_milling(setup_);
  const Tool& tool = setup_.tool;
  step_ = kTwoPi / (setup_.spindle_speed * setup_.steps_per_turn);
  structure_ = setup_.structure(step_);
  for (double angle = 0.0; const double pitch : tool.pitch) {
    tooth_angle_.push_back(angle);
    tooth_radius_.push_back(0.5 * tool.diameter + tool.runout * std::cos(angle - tool.runout_angle));
    angle += pitch;
  }
  const int count = setup_.discs > 0 ? setup_.discs : edge_element_count(tool, setup_.axial_depth);
  discs_ = edge_elements(tool, setup_.axial_depth, count);
  slices_.assign(discs_.size(), PartSlice(setup_.part, setup_.tile));
  state_.spindle_speed = setup_.spindle_speed;
  state_.spindle_angle = setup_.start_angle;
  state_.axial_depth = setup_.axial_depth;
  state_.displacement = structure_->displacement();
  axis_ = setup_.path(0.0) + state_.displacement.head<2>();
}

Eigen::Vector2d PartMilling::outward(double spindle_angle, std::size_t tooth, std::size_t disc) const {
  const double phi = spindle_angle + tooth_angle_[tooth] - discs_[disc].lag;
  return {std::sin(phi), std::cos(phi)};
}

void PartMilling::load_at(const Eigen::Vector2d& axis, double spindle_angle, const Eigen::Vector3d& velocity) {
  const EdgeMotion motion{velocity, setup_.spindle_speed * 0.5 * setup_.tool.diameter};
  state_.force.setZero();
  state_.chip = 0.0;
  for (std::size_t disc = 0; disc < discs_.size(); ++disc)
    for (std::size_t tooth = 0; tooth < tooth_angle_.size(); ++tooth) {
      const Eigen::Vector2d way = outward(spindle_angle, tooth, disc);
      const double chip = slices_[disc].material_along(axis, axis + tooth_radius_[tooth] * way);
      if (!(chip > 0.0)) continue;
      state_.force += edge_force(setup_.material, discs_[disc], way, chip, motion);
      state_.chip = std::max(state_.chip, chip);
    }
}

// The sector between the axis and the edge's way, which is made of chords: what lies within is gone, an island too.
void PartMilling::cut_away(const Eigen::Vector2d& to_axis, double from_angle, double to_angle) {
  for (std::size_t disc = 0; disc < discs_.size(); ++disc)
    for (std::size_t tooth = 0; tooth < tooth_angle_.size(); ++tooth) {
      swept_.assign(1, axis_);
      for (int i = 0; i <= setup_.chords; ++i) {
        const double part = static_cast<double>(i) / setup_.chords;
        swept_.push_back(axis_ + part * (to_axis - axis_) +
                         tooth_radius_[tooth] * outward(std::lerp(from_angle, to_angle, part), tooth, disc));
      }
      swept_.push_back(to_axis);
      slices_[disc].erase(swept_);
    }
}

const MillingState& PartMilling::advance() {
  const double time = static_cast<double>(steps_ + 1) * step_;
  const double angle = setup_.start_angle + kTwoPi * static_cast<double>(steps_ + 1) / setup_.steps_per_turn;
  const Eigen::Vector2d commanded = setup_.path(time);
  const Eigen::Vector3d last_force = state_.force;
  const Eigen::Vector3d predicted = structure_->displacement_after(last_force, last_force);
  load_at(commanded + predicted.head<2>(), angle, (predicted - state_.displacement) / step_);
  structure_->advance(last_force, state_.force);
  state_.displacement = structure_->displacement();
  if (!(state_.displacement.norm() < kFurthestOff))
    throw std::runtime_error("at " + std::to_string(time) +
                             " s the tool point is more than 0.5 m off its path: the "
                             "motion grows without bound");
  const Eigen::Vector2d to_axis = commanded + state_.displacement.head<2>();
  cut_away(to_axis, state_.spindle_angle, angle);
  axis_ = to_axis;
  state_.time = time;
  state_.spindle_angle = angle;
  state_.velocity = structure_->velocity();
  state_.acceleration = structure_->acceleration();
  ++steps_;
  return state_;
}

}  // namespace stillcut
