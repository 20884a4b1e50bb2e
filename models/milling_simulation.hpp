// Milling in time: an end mill cuts the surface that its earlier teeth really left, the force moves the structure, the
// motion writes the next surface. Regeneration, loss of contact and runout follow from the geometry; nothing is
// linearised. Conventions (angles, signs, frames) are those of docs/conventions.md.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

#include "models/immersion.hpp"
#include "models/machining.hpp"
#include "models/modal_structure.hpp"
#include "models/schedule.hpp"

namespace stillcut {

struct MillingSetup {
  Tool tool;  // shape end; axial runout and tilted tools are not modelled
  Material material;
  Cut cut;
  std::vector<Mode> modes;
  Schedule axial_depth;      // m; empty: the cut's own. 0: the tool is out of the part
  Schedule spindle_speed;    // rad/s; empty: the cut's own. Feed per tooth is kept
  double force_noise = 0.0;  // rms of the chip formation's own variation, relative to the force
  std::uint64_t seed = 1;    // of that noise
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();  // hammer blow at time 0, N s, workpiece axes
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
  double axial_depth = 0.0;                                // m
};

// The lowest rate at which a simulation of these modes may be sampled: 20 samples a period of the highest one, Hz.
[[nodiscard]] double lowest_sample_rate_hz(const std::vector<Mode>& modes);

class MillingSimulation {
 public:
  // Samples are spaced 1/sample_rate_hz; within a sample the integrator takes as many steps as accuracy needs. Throws
  // std::invalid_argument for what cannot be simulated, in words for the user.
  MillingSimulation(MillingSetup setup, double sample_rate_hz);

  [[nodiscard]] const MillingState& state() const { return state_; }

  // Moves on to the next sample.
  const MillingState& advance();

 private:
  struct Edge {  // a tooth at one height: where it went through the surface last
    double angle = 0.0;
    double radius = 0.0;
  };
  struct Geometry {  // what is the same for both force evaluations of a step
    double angle, swept, depth, speed, travel;
  };
  struct Load {
    Eigen::Vector3d force;
    double chip;
  };

  [[nodiscard]] Load load_at(const Geometry& at, const Eigen::Vector3d& displacement,
                             const Eigen::Vector3d& velocity) const;
  [[nodiscard]] double edge_angle(const Geometry& at, int slice, int tooth) const;
  [[nodiscard]] double edge_radius(double angle, int tooth, double travel, const Eigen::Vector3d& displacement) const;
  [[nodiscard]] double surface_at(int slice, double angle) const;
  void cut_surface(const Geometry& at, const Eigen::Vector3d& displacement);
  void step();

  MillingSetup setup_;
  Immersion immersion_;
  double sample_step_, step_;
  int steps_per_sample_ = 1;
  std::int64_t step_count_ = 0;
  ModalStructure structure_;
  Eigen::Vector3d feed_, cross_feed_;  // unit vectors of the feed frame in workpiece axes
  std::vector<double> tooth_angle_, tooth_runout_;
  int slices_ = 1;
  std::size_t bins_ = 0;
  std::vector<double> surface_;  // [slice][bin] radius of the part about the path of the ideal tool centre, m
  std::vector<Edge> edges_;      // [slice][tooth]
  double spindle_angle_ = 0.0, speed_ = 0.0, force_variation_ = 0.0;
  std::mt19937_64 random_;
  MillingState state_;
};

}  // namespace stillcut
