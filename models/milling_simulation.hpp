// Milling in time: the tool cuts the surface that its earlier teeth really left, the force moves the structure, the
// motion writes the next surface. Regeneration over several passes, loss of contact and runout follow from the
// geometry; nothing is linearised. Conventions (angles, signs, frames) are those of docs/conventions.md.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "models/edge_elements.hpp"
#include "models/immersion.hpp"
#include "models/machining.hpp"
#include "models/modal_structure.hpp"

namespace stillcut {

// What may change while the tool mills.
struct MillingConditions {
  Milling milling = Milling::down;
  double radial_depth = 0.0;    // m
  double axial_depth = 0.0;     // m; 0: the tool is out of the part
  double feed_per_tooth = 0.0;  // m
  double spindle_speed = 0.0;   // rad/s
  double feed_direction = 0.0;  // rad
};

[[nodiscard]] MillingConditions milling_conditions(const Cut& cut);

struct MillingSetup {
  Tool tool;  // its axis is normal to the surface: tilted tools are not modelled
  Material material;
  Cut cut;                              // conditions at the start; its tilt and lead are left out
  double deepest = 0.0;                 // m, of all depths to come; the cut's own where that is more
  double slowest = 0.0, fastest = 0.0;  // rad/s, of all speeds to come; 0: the cut's own
  // The structure is made of these modes, or by `structure` for the integrator's step in s; then the modes only say how
  // fine the steps must be.
  std::vector<Mode> modes;
  std::function<std::unique_ptr<Structure>(double)> structure;
  double force_noise = 0.0;  // rms of the chip formation's own variation, relative to the force
  std::uint64_t seed = 1;    // of that noise
};

// What happens at one moment, in workpiece axes; forces act on the tool.
struct MillingState {
  double time = 0.0;                                       // s
  Eigen::Vector3d force = Eigen::Vector3d::Zero();         // N
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  // m, tool point
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      // m/s
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  // m/s^2
  double chip = 0.0;                                       // m, thickest chip of any tooth just now; 0: no tooth cuts
  double spindle_speed = 0.0;                              // rad/s
  double spindle_angle = 0.0;  // rad since the start; tooth 0's tip then stood on the cross-feed axis
  double axial_depth = 0.0;    // m
};

// The lowest rate at which a simulation of these modes may be sampled: 20 samples a period of the highest one, Hz.
[[nodiscard]] double lowest_sample_rate_hz(const std::vector<Mode>& modes);

class MillingSimulation {
 public:
  // Samples are spaced 1/sample_rate_hz; within a sample the integrator takes as many steps as accuracy needs. Throws
  // std::invalid_argument for what cannot be simulated, in words for the user.
  MillingSimulation(MillingSetup setup, double sample_rate_hz);

  [[nodiscard]] const MillingState& state() const { return state_; }
  [[nodiscard]] const MillingConditions& conditions() const { return conditions_; }

  // What the tool is fastened to; to be struck, or given other modes as the posture changes, between two samples.
  [[nodiscard]] Structure& structure() { return *structure_; }

  // Moves on to the next sample, where these conditions hold: depths, speed, feed and feed direction go there in a
  // straight line, the milling kind at once. Throws std::invalid_argument, before anything moves, for conditions
  // outside the setup's range, std::runtime_error with time and reason where the motion cannot be continued.
  const MillingState& advance(const MillingConditions& conditions);
  const MillingState& advance() { return advance(conditions_); }

 private:
  struct Step {  // one step of the integrator; `swept` is the angle that the spindle turns in it
    double begin_angle, swept, feed_direction, cutting_speed;
    Eigen::Vector3d begin, end;  // tool point, with its travel along the path
    Eigen::Vector3d velocity;    // of the vibration, mean over the step
  };
  struct Load {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    double chip = 0.0;
  };

  void check(const MillingConditions& conditions) const;
  [[nodiscard]] double engaged_share(std::size_t element) const;
  [[nodiscard]] Load load_in(const Step& step) const;
  void add_load(const Step& step, std::size_t tooth, std::size_t element, Load& load) const;
  void cut_surface(const Step& step);
  void step(const MillingConditions& conditions);

  MillingSetup setup_;
  MillingConditions conditions_;
  Immersion immersion_;
  double sample_step_, step_;
  int steps_per_sample_ = 1;
  std::int64_t sample_count_ = 0;
  std::unique_ptr<Structure> structure_;
  std::vector<double> tooth_angle_, tooth_runout_, tooth_axial_runout_;
  std::vector<EdgeElement> elements_;
  std::vector<Eigen::Vector2d> bin_normal_;    // outward, of each direction about the axis, workpiece axes
  std::vector<double> surface_;                // [element][bin] how far the part is cut away along the normal there, m
  std::vector<std::int64_t> last_bin_;         // [element][tooth] that the edge has passed
  double piece_length_ = 0.0, engaged_ = 0.0;  // m along the edge's profile: of an element, and what is in the part
  double spindle_angle_ = 0.0, force_variation_ = 0.0;
  Eigen::Vector3d travel_ = Eigen::Vector3d::Zero();  // m along the path
  std::mt19937_64 random_;
  MillingState state_;
};

}  // namespace stillcut
