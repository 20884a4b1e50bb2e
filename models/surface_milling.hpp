// Ball-end milling in time on a height map (Liu et al. 2024, section 2.2): an edge's chip is what of the part still
// stands above it, the force moves the structure, and what the edge then sweeps is cut away. Where an inclined ball
// enters and leaves, what the teeth and the passes before have left, waves included, follow from the map; no immersion
// angles and no delay are given. models/milling_simulation, which keeps the surface about the tool's axis instead, is
// for tools that stand upright in a cut of constant immersion.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "models/cutter_motion.hpp"
#include "models/edge_elements.hpp"
#include "models/edge_rows.hpp"
#include "models/milled_stock.hpp"
#include "models/structure.hpp"
#include "models/swept_patches.hpp"

namespace stillcut {

struct SurfaceMillingSetup {
  CutterMotion motion;  // of a ball end; its own displacement is left out
  Material material;
  double axial_depth = 0.0;  // m, of the deepest stock over the surface
  double step = 0.0;         // s; longest_step() at most
  double force_noise = 0.0;  // rms of the chip formation's own variation, relative to the force
  std::uint64_t seed = 1;    // of that noise
};

// The longest step in which a tooth turns by a degree, at most, and a mode of this frequency (Hz) is resolved, s.
[[nodiscard]] double longest_step(const CutterMotion& motion, double highest_mode_hz);

class SurfaceMilling {
 public:
  // `stock` is cut, `structure` moves in steps of `setup.step`, in workpiece axes; both must outlive this. Throws
  // std::invalid_argument for a tool that is no ball end.
  SurfaceMilling(SurfaceMillingSetup setup, Stock& stock, Structure& structure);

  // From now on the tool goes along this pass; the structure goes on as it moves.
  void begin(const CutterPass& pass);

  // One step along the pass. Throws std::runtime_error where the motion cannot be continued.
  void advance();

  [[nodiscard]] double time() const { return time_; }                                  // s since the pass began
  [[nodiscard]] const Eigen::Vector3d& force() const { return force_; }                // N, on the tool, workpiece axes
  [[nodiscard]] const Eigen::Vector3d& displacement() const { return displacement_; }  // m, workpiece axes
  [[nodiscard]] double chip() const { return chip_; }                                  // m, thickest just now
  [[nodiscard]] double removed() const { return removed_; }                            // m^3 of chips since the start

 private:
  struct Cutting {
    int begin = 0, end = 0;  // elements
    int steps_left = 0;      // until the edge, which follows its chip, is through
  };
  void place(const EdgeRows& points, double time, const Eigen::Vector3d& displacement, std::size_t tooth,
             EdgeRow& row) const;
  void add_load(std::size_t tooth, double time, const Eigen::Vector3d& displacement);
  [[nodiscard]] double stock_above(double x, double y, double z) const;

  SurfaceMillingSetup setup_;
  Stock& stock_;
  Structure& structure_;
  PatchCanvas canvas_;
  Eigen::Vector3d to_points_;          // of the stock, from m
  EdgeRows nodes_;                     // of the edge, from the tip upward
  std::vector<EdgeElement> elements_;  // between them
  EdgeRows ahead_;                     // where each element's chip is measured
  std::vector<double> ahead_angle_;    // rad, so much before the element
  int steps_ahead_ = 0;
  CutterPass pass_;
  double time_ = 0.0, chip_ = 0.0, removed_ = 0.0, force_variation_ = 0.0;
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero(), displacement_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d load_ = Eigen::Vector3d::Zero();  // N, tool axes
  std::vector<EdgeRow> before_, after_;             // of each tooth
  EdgeRow probe_;
  std::vector<Cutting> cutting_;  // of each tooth
  std::mt19937_64 random_;
};

}  // namespace stillcut
