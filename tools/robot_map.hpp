// `stillcut map --robot`: a dynamics map from a robot's description, alone or mended by a measured map, and what the
// command says about it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "models/arm.hpp"
#include "models/dynamics_map.hpp"
#include "models/map_correction.hpp"

namespace stillcut {

// Where the map is wanted: a file with the columns posture,j1_deg,...,jn_deg or posture,x_mm,y_mm,z_mm (solved by
// inverse kinematics, models/arm_reach, the tool turned as at home or, with a column redundancy_deg, by so much from it
// about the workpiece's Z); an empty name: the home posture. Modes are not filled in. Throws InputError:
// a posture twice, beyond the joints' limits, out of reach or singular, an arm of more than six joints.
DynamicsMap robot_postures(const Arm& arm, const std::string& robot_file, const std::string& postures_file);

// The modes of the description at a posture, from SerialArm. Throws InputError, naming file and posture, where they are
// none (models/arm_modes) or undamped.
RobotModes robot_modes(const Arm& arm, const std::string& robot_file);

// Every posture's modes, a table for people; with a correction, what it rests on.
void print_robot_map(const DynamicsMap& map, const std::vector<ModeMatch>& matches, std::ostream& out);
nlohmann::ordered_json robot_map_to_json(const DynamicsMap& map, const std::vector<ModeMatch>& matches);

}  // namespace stillcut
