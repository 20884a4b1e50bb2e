// A robot from its URDF file, the robotics world's XML description of links and joints, with what milling needs
// besides: the stiffness of each joint, and the posture to begin with. URDF has no place for them; they stand in an
// element that other readers skip (docs/robot.md):
//   <joint name="joint_2" ...> ... <stillcut stiffness_n_m_per_rad="6.6e6" home_deg="10"/> </joint>
// Gazebo's <gazebo reference="joint_2"><springStiffness>6.6e6</springStiffness></gazebo> is read too.
//
// The XML is read with tinyxml2. kdl_parser would do the same for KDL, but Debian's package of it brings all of roscpp,
// and it would drop the damping, the stiffness and every line number.
#pragma once

#include <filesystem>

#include "models/arm.hpp"

namespace stillcut {

// Links without a moving joint between them become one body. The root link's frame is the workpiece frame; the tool
// point is the origin of the link that <stillcut tool_link="..."/> in <robot> names, or of that called tool, tcp or
// tool0. Damping is <dynamics damping="..."/>, N m s/rad, 0 where absent; home is 0 where absent, or the limit next to
// it.
//
// Throws InputError "FILE:LINE: what is wrong and what to do" for: no XML; no <robot>; a link or joint unnamed, named
// twice, or not there; a number that is none; a moving link without mass; a joint without stiffness, or not above 0;
// sliding, floating, planar or mimicking joints; no joint that moves, or more than kMostJoints; an arm that branches or
// closes a loop; a tool link that is missing or does not hang on the last joint; an inertia that no body has.
Arm read_robot(const std::filesystem::path& file);

}  // namespace stillcut
