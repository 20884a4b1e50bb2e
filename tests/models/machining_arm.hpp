// The six-joint machining robot of examples/demo-robot, for tests that read no file.
#pragma once

#include <Eigen/Core>
#include <numbers>
#include <string>

#include "models/arm.hpp"

namespace stillcut::test {

// Joint axes z, y, y, x, y, x; with all angles zero the upper arm stands upright and the forearm points along x.
inline Arm machining_arm() {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  struct Row {
    Eigen::Vector3d origin, axis;
    double mass;
    Eigen::Vector3d centre, inertia;
    double stiffness, damping, home_deg;
  };
  const Row rows[] = {{{0, 0, 0.35}, z, 420, {0.12, 0.02, 0.25}, {28, 32, 30}, 3.8e6, 2600, 0},
                      {{0.35, 0, 0.40}, y, 260, {0.0, -0.05, 0.55}, {38, 40, 5}, 6.6e6, 3900, 10},
                      {{0, 0, 1.10}, y, 210, {0.12, 0.03, 0.06}, {6, 12, 11}, 3.9e6, 2300, 10},
                      {{0.45, 0, 0.06}, x, 65, {0.30, 0.0, 0.0}, {0.8, 3.0, 3.0}, 1.6e6, 330, 0},
                      {{0.75, 0, 0}, y, 32, {0.05, 0.0, 0.0}, {0.25, 0.35, 0.35}, 1.3e6, 200, 70},
                      {{0.20, 0, 0}, x, 48, {0.15, 0.01, -0.06}, {0.5, 0.9, 0.8}, 1.0e6, 110, 0}};
  Arm arm;
  arm.name = "machining arm";
  int number = 0;
  for (const Row& row : rows) {
    ArmJoint joint;
    joint.name = "joint_" + std::to_string(++number);
    joint.origin = row.origin;
    joint.axis = row.axis;
    joint.mass = row.mass;
    joint.centre = row.centre;
    joint.inertia = row.inertia.asDiagonal();
    joint.stiffness = row.stiffness;
    joint.damping = row.damping;
    joint.home = row.home_deg * std::numbers::pi / 180.0;
    joint.lower = -3.1;
    joint.upper = 3.1;
    arm.joints.push_back(joint);
  }
  arm.tool = {0.35, 0.0, -0.12};
  return arm;
}

}  // namespace stillcut::test
