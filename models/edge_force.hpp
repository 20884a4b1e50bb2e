// What a piece of a cutting edge feels: the one law of force of every milling simulation here, whatever it knows of the
// chip (a surface memory about the tool's axis in models/milling_simulation, the part itself in models/part_milling).
#pragma once

#include <Eigen/Core>

#include "models/edge_elements.hpp"
#include "models/machining.hpp"

namespace stillcut {

// How an edge moves against the part: velocity of the tool's vibration, m/s, workpiece axes, and the cutting speed,
// m/s, which only process damping asks for.
struct EdgeMotion {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  double cutting_speed = 1.0;
};

// Force on the tool, N, workpiece axes, z along its axis and away from the part. `outward`: from the axis to the edge,
// (sin phi, cos phi) with the angle clockwise from +y; `chip`: thickness along the edge's normal, m. Shear terms act on
// the chip's width, edge terms on the edge's length (Altintas and Lee 1996; eqs 10 and 11 of Huynh et al. 2017 with the
// signs of docs/conventions.md), process damping on the radial velocity.
[[nodiscard]] inline Eigen::Vector3d edge_force(const Material& material, const EdgeElement& edge,
                                                const Eigen::Vector2d& outward, double chip, const EdgeMotion& motion) {
  const double s = outward.x(), c = outward.y();
  const Eigen::Vector3d normal(s * edge.sin_kappa, c * edge.sin_kappa, -edge.cos_kappa);
  const Eigen::Vector3d along_profile(s * edge.cos_kappa, c * edge.cos_kappa, edge.sin_kappa);
  const double rubbing = material.process_damping * normal.dot(motion.velocity) / motion.cutting_speed;
  const double tangential = material.ktc * chip * edge.chip_width + material.kte * edge.edge_length;
  const double radial = (material.krc * chip + rubbing) * edge.chip_width + material.kre * edge.edge_length;
  const double axial = material.kac * chip * edge.chip_width + material.kae * edge.edge_length;
  return -(Eigen::Vector3d(tangential * c, -tangential * s, 0.0) + radial * normal + axial * along_profile);
}

}  // namespace stillcut
