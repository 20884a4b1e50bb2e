// A robot that shakes, for tests of the dynamics map: rigid links with mass and inertia, a rotational spring and damper
// in each of six joints. At a posture its equation of motion is M(q) x'' + D x' + K x = J(q)^T F, x the joints' elastic
// angles and F the force at the tool point; its modes follow from K p = w^2 M p with p^T M p = 1. A mode moves the tool
// point along J p, so that its stiffness there is w^2/|J p|^2. Nothing here is known to the code under test.
//
// Figures: `staubli` has the lengths, masses and inertias of Huynh et al. 2017 (Table 1), its lumped forearm shared out
// to links 3 to 5, and the joint stiffness and damping that Huynh gives for a Staubli robot (section 5.3.3); `kuka` has
// the lengths of a KR 240-2 and the joint stiffness of Dumas et al. 2011 (KR 270-2: 3.8, 6.6, 3.9, 0.56, 0.66, 0.47
// MNm/rad) with the damping rule of Huynh et al. 2017 (eq. 9). The spindle at the flange is ours.
#pragma once

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/dynamics_map.hpp"

namespace stillcut::test {

struct RobotLink {
  Eigen::Vector3d joint;    // m, its joint in the frame of the link before it, all angles zero (arm stretched along x)
  Eigen::Vector3d axis;     // of the joint
  double mass;              // kg
  Eigen::Vector3d centre;   // m, of mass, from its joint
  Eigen::Vector3d inertia;  // kg m^2, about the centre of mass, along the link's axes
  double stiffness;         // N m/rad
  double damping;           // N m s/rad
};

struct ElasticRobot {
  std::array<RobotLink, 6> links;
  Eigen::Vector3d tool;  // m, tool point from joint 6
};

// Joint axes: z, y, y, x, y, x; the arm stretched along x at zero.
inline ElasticRobot staubli() {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  return {{{{{0, 0, 0}, z, 342, {0, 0, 0.325}, {18.0, 29.2, 30.0}, 2.3e6, 4.6e3},
            {{0.25, 0, 0.65}, y, 243, {0.475, 0, 0}, {4.05, 35.0, 37.5}, 8.6e6, 5.0e3},
            {{0.95, 0, 0}, y, 130, {0.10, 0, 0}, {2.9, 2.9, 2.9}, 2.8e6, 2.5e3},
            {{0.30, 0, 0}, x, 60, {0.25, 0, 0}, {0.6, 1.6, 1.6}, 3.0e6, 0.3e3},
            {{0.50, 0, 0}, y, 12, {0.05, 0, 0}, {0.05, 0.07, 0.07}, 0.2e6, 0.01e3},
            {{0.20, 0, 0}, x, 30, {0.10, 0, -0.08}, {0.30, 0.35, 0.20}, 0.9e6, 0.01e3}}},
          {0.12, 0, -0.25}};
}

inline ElasticRobot kuka() {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  ElasticRobot robot{{{{{0, 0, 0}, z, 400, {0.10, 0, 0.45}, {25, 35, 35}, 3.8e6, 0},
                       {{0.35, 0, 0.75}, y, 230, {0.60, 0, 0}, {4, 45, 45}, 6.6e6, 0},
                       {{1.25, 0, 0}, y, 190, {0.05, 0, 0.06}, {5, 9, 9}, 3.9e6, 0},
                       {{0.45, 0, -0.055}, x, 60, {0.30, 0, 0}, {0.7, 2.5, 2.5}, 0.56e6, 0},
                       {{0.65, 0, 0}, y, 30, {0.05, 0, 0}, {0.2, 0.3, 0.3}, 0.66e6, 0},
                       {{0.21, 0, 0}, x, 55, {0.12, 0, -0.10}, {0.6, 0.8, 0.5}, 0.47e6, 0}}},
                     {0.15, 0, -0.30}};
  for (RobotLink& link : robot.links) link.damping = 1057.2 * std::sqrt(link.stiffness / 3.8e6);
  return robot;
}

// The same robot with masses and lengths of others of its class: each mass, inertia, stiffness, damping off by up to
// the given share.
inline ElasticRobot varied(ElasticRobot robot, double share, std::mt19937_64& random) {
  const auto factor = [&] { return std::uniform_real_distribution<>(1.0 - share, 1.0 + share)(random); };
  for (RobotLink& link : robot.links) {
    link.mass *= factor();
    link.inertia *= factor();
    link.stiffness *= factor();
    link.damping *= factor();
    link.centre *= factor();
  }
  return robot;
}

using JointAngles = Eigen::Matrix<double, 6, 1>;

struct RobotFrames {
  std::array<Eigen::Vector3d, 6> joint, axis, centre;
  std::array<Eigen::Matrix3d, 6> turned;
  Eigen::Vector3d tool;
};

inline RobotFrames frames_at(const ElasticRobot& robot, const JointAngles& angles) {
  RobotFrames at;
  Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < 6; ++i) {
    const RobotLink& link = robot.links[i];
    origin += turned * link.joint;
    at.axis[i] = turned * link.axis;
    turned = turned * Eigen::AngleAxisd(angles[static_cast<Eigen::Index>(i)], link.axis).toRotationMatrix();
    at.joint[i] = origin;
    at.turned[i] = turned;
    at.centre[i] = origin + turned * link.centre;
  }
  at.tool = origin + turned * robot.tool;
  return at;
}

// How a point fixed to link `link` moves with the joints up to it: 3 x 6.
inline Eigen::Matrix<double, 3, 6> jacobian(const RobotFrames& at, std::size_t link, const Eigen::Vector3d& point) {
  Eigen::Matrix<double, 3, 6> j = Eigen::Matrix<double, 3, 6>::Zero();
  for (std::size_t i = 0; i <= link; ++i)
    j.col(static_cast<Eigen::Index>(i)) = at.axis[i].cross(Eigen::Vector3d(point - at.joint[i]));
  return j;
}

inline Eigen::Matrix<double, 6, 6> mass_matrix(const ElasticRobot& robot, const RobotFrames& at) {
  Eigen::Matrix<double, 6, 6> mass = Eigen::Matrix<double, 6, 6>::Zero();
  for (std::size_t i = 0; i < 6; ++i) {
    const Eigen::Matrix<double, 3, 6> moving = jacobian(at, i, at.centre[i]);
    Eigen::Matrix<double, 3, 6> turning = Eigen::Matrix<double, 3, 6>::Zero();
    for (std::size_t k = 0; k <= i; ++k) turning.col(static_cast<Eigen::Index>(k)) = at.axis[k];
    const Eigen::Matrix3d inertia = at.turned[i] * robot.links[i].inertia.asDiagonal() * at.turned[i].transpose();
    mass += robot.links[i].mass * moving.transpose() * moving + turning.transpose() * inertia * turning;
  }
  return mass;
}

// The modes at the tool point, in rising frequency. A mode that moves the tool point less than a thousandth of what
// the most compliant one does, statically, would not be found by a hammer and is left out.
inline std::vector<Mode> modes_at(const ElasticRobot& robot, const JointAngles& angles) {
  const RobotFrames at = frames_at(robot, angles);
  JointAngles stiffness, damping;
  for (std::size_t i = 0; i < 6; ++i) {
    stiffness[static_cast<Eigen::Index>(i)] = robot.links[i].stiffness;
    damping[static_cast<Eigen::Index>(i)] = robot.links[i].damping;
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(stiffness.asDiagonal(),
                                                                                     mass_matrix(robot, at));
  const Eigen::Matrix<double, 3, 6> tool = jacobian(at, 5, at.tool);
  std::vector<Mode> modes;
  double softest = 0.0;
  for (Eigen::Index r = 0; r < 6; ++r) {
    const JointAngles shape = solver.eigenvectors().col(r);
    const Eigen::Vector3d moves = tool * shape;
    const double frequency = std::sqrt(solver.eigenvalues()[r]);
    Mode mode;
    mode.natural_frequency = frequency;
    mode.damping_ratio = shape.dot(damping.cwiseProduct(shape)) / (2.0 * frequency);
    mode.stiffness = frequency * frequency / moves.squaredNorm();
    Eigen::Map<Eigen::Vector3d>(mode.direction.data()) = moves.normalized();
    softest = std::max(softest, 1.0 / mode.stiffness);
    modes.push_back(mode);
  }
  std::erase_if(modes, [&](const Mode& mode) { return 1.0 / mode.stiffness < 1e-3 * softest; });
  return modes;
}

// Joint angles that bring the tool point to `place` with the flange turned as at `start`. Newton steps from there.
inline JointAngles reach(const ElasticRobot& robot, const Eigen::Vector3d& place, const JointAngles& start) {
  const Eigen::Matrix3d turned = frames_at(robot, start).turned[5];
  JointAngles angles = start;
  for (int step = 0; step < 100; ++step) {
    const RobotFrames at = frames_at(robot, angles);
    const Eigen::AngleAxisd rest(turned * at.turned[5].transpose());
    Eigen::Matrix<double, 6, 1> miss;
    miss << place - at.tool, rest.angle() * rest.axis();
    if (miss.norm() < 1e-12) return angles;
    Eigen::Matrix<double, 6, 6> j;
    j.topRows<3>() = jacobian(at, 5, at.tool);
    for (std::size_t i = 0; i < 6; ++i) j.block<3, 1>(3, static_cast<Eigen::Index>(i)) = at.axis[i];
    const JointAngles move = j.fullPivLu().solve(miss);
    angles += move * std::min(1.0, 0.3 / move.norm());
  }
  throw std::runtime_error("elastic_joint_robot: the tool does not reach there");
}

struct MachiningPlane {
  int rows = 3, columns = 5;              // along x (away from the robot) and y
  double near = 1.30, depth = 0.14;       // m, x of the nearest row; from there to the farthest
  double width = 0.6, height = 0.5;       // m
  double first_mode = 2.0 * M_PI * 18.0;  // rad/s, the mean over the plane; 0: as the springs are
};

// The map that a hammer would give on a grid in a horizontal plane, the tool upright everywhere. One factor on all
// springs (its root on the dampers) puts the first mode where the plane says; it scales all frequencies alike and so
// changes no relative error.
inline DynamicsMap plane_map(ElasticRobot robot, const MachiningPlane& plane = {}) {
  JointAngles start;
  start << 0.0, -1.2, 1.5, 0.05, -0.3, 0.0;  // elbow up, flange level
  const auto measure = [&] {
    DynamicsMap map;
    map.has_joints = true;
    for (int row = 0; row < plane.rows; ++row) {
      for (int column = 0; column < plane.columns; ++column) {
        Posture posture;
        posture.id = std::to_string(map.postures.size() + 1);
        const double x = plane.near + plane.depth * row / std::max(1, plane.rows - 1);
        const double y = plane.width * (static_cast<double>(column) / std::max(1, plane.columns - 1) - 0.5);
        posture.position = {x, y, plane.height};
        const JointAngles angles = reach(robot, {x, y, plane.height}, start);
        Eigen::Map<JointAngles>(posture.joints.data()) = angles;
        posture.modes = modes_at(robot, angles);
        map.postures.push_back(posture);
      }
    }
    return map;
  };
  DynamicsMap map = measure();
  if (plane.first_mode <= 0.0) return map;
  double mean = 0.0;
  for (const Posture& posture : map.postures)
    mean += posture.modes.front().natural_frequency / static_cast<double>(map.postures.size());
  const double factor = plane.first_mode / mean;
  for (RobotLink& link : robot.links) {
    link.stiffness *= factor * factor;
    link.damping *= factor;
  }
  return measure();
}

}  // namespace stillcut::test
