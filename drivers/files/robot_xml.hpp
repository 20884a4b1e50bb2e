// The pieces of a URDF file, read and checked one by one; drivers/files/robot_file makes an arm of them.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace stillcut {

struct UrdfPlace {                                       // of one frame in another
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();      // m
  Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();  // from rpy, rad: about the fixed x, then y, then z axis
};

struct UrdfLink {
  std::string name;
  int line = 0;
  double mass = 0.0;                                  // kg; 0: no <inertial>
  UrdfPlace place;                                    // of the centre of mass and the inertia's axes
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // kg m^2
};

struct UrdfJoint {
  std::string name, parent, child;
  int line = 0;
  bool moves = false;
  UrdfPlace place;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  // unit
  std::optional<double> lower, upper, home;         // rad
  double damping = 0.0;                             // N m s/rad
  std::optional<double> stiffness;                  // N m/rad
};

struct UrdfRobot {
  std::string name;
  int line = 0;
  std::string tool_link;  // empty: not named
  int tool_line = 0;
  std::vector<UrdfLink> links;
  std::vector<UrdfJoint> joints;
};

// Throws InputError; see read_robot.
UrdfRobot read_urdf(const std::filesystem::path& file);

}  // namespace stillcut
