// Milling in time on a workpiece that is there: the end mill is a pile of discs, each in a slice of the part of its own
// (models/part_slice); an edge's chip is what of the slice still stands inside it, and what the edge sweeps is cut
// away. Where a tooth enters and leaves, what an earlier pass left, the end of the part: all follow from the part's
// shape, and the machined wall can be measured afterwards (models/wall_profile). This is the multibody paper's model
// (Huynh et al. 2017, sections 2.2 and 2.3), for any structure. models/milling_simulation, which keeps the surface
// about the tool's axis instead, is many times faster and agrees with it where immersion is constant.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "models/edge_elements.hpp"
#include "models/milling_simulation.hpp"
#include "models/part_slice.hpp"

namespace stillcut {

struct PartMillingSetup {
  Tool tool;  // an end mill, its axis along z
  Material material;
  std::vector<Contour> part;   // m, workpiece axes; the same from the table to the surface before anything is cut
  double axial_depth = 0.0;    // m, how deep the tool stands in it
  double spindle_speed = 0.0;  // rad/s
  double start_angle = 0.0;    // rad, of tooth 0's tip at the start, clockwise from workpiece +y
  std::function<Eigen::Vector2d(double time)> path;                  // commanded tool axis, m, at a time in s
  std::function<std::unique_ptr<Structure>(double step)> structure;  // for a step in s
  double steps_per_turn = 100.0;                                     // the paper's; need not be whole
  int discs = 0;       // 0: as finely as the helix asks (edge_element_count)
  int chords = 1;      // straight segments that an edge's way in a step is made of; the paper's contours have one
  double tile = 1e-3;  // m, of the slices
};

class PartMilling {
 public:
  // Throws std::invalid_argument, in words for the user, for what cannot be simulated.
  explicit PartMilling(PartMillingSetup setup);

  // Moves on by one step, a turn's `steps_per_turn`-th. As in the paper (Fig. 6): where the tool will be at the end of
  // the step is predicted, the chip there gives the force, the force moves the structure, and what the edges swept on
  // their real way is cut away. The force is that at the end of the step and goes there in a straight line.
  // Displacements along z are kept but do not change the depth: the paper's 2 1/2 dimensions. Throws
  // std::runtime_error, with the time and the reason, where the motion cannot be continued.
  const MillingState& advance();

  [[nodiscard]] const MillingState& state() const { return state_; }
  [[nodiscard]] double step() const { return step_; }                             // s
  [[nodiscard]] Eigen::Vector2d tool_axis() const { return axis_; }               // m, where it really is
  [[nodiscard]] const std::vector<PartSlice>& slices() const { return slices_; }  // from the tool's tip upward
  [[nodiscard]] Structure& structure() { return *structure_; }

 private:
  [[nodiscard]] Eigen::Vector2d outward(double spindle_angle, std::size_t tooth, std::size_t disc) const;
  void load_at(const Eigen::Vector2d& axis, double spindle_angle, const Eigen::Vector3d& velocity);
  void cut_away(const Eigen::Vector2d& to_axis, double from_angle, double to_angle);

  PartMillingSetup setup_;
  double step_ = 0.0;
  std::int64_t steps_ = 0;
  std::unique_ptr<Structure> structure_;
  std::vector<double> tooth_angle_, tooth_radius_;
  std::vector<EdgeElement> discs_;
  std::vector<PartSlice> slices_;
  Eigen::Vector2d axis_ = Eigen::Vector2d::Zero();
  std::vector<Eigen::Vector2d> swept_;
  MillingState state_;
};

}  // namespace stillcut
