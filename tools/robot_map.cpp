#include "tools/robot_map.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "drivers/files/csv.hpp"
#include "drivers/files/input_error.hpp"
#include "models/arm_dynamics.hpp"
#include "models/arm_reach.hpp"
#include "models/machining.hpp"
#include "models/posture.hpp"
#include "models/serial_arm.hpp"

namespace stillcut {
namespace {

constexpr int kMapJoints = 6;
const std::array<std::string, kMapJoints> kAngleColumns{"j1_deg", "j2_deg", "j3_deg", "j4_deg", "j5_deg", "j6_deg"};

JointVector angles_of(const Arm& arm, const Posture& posture) {
  JointVector angles(arm.size());
  for (int i = 0; i < arm.size(); ++i) angles[i] = posture.joints[static_cast<std::size_t>(i)];
  return angles;
}

Posture posture_at(const Arm& arm, const std::string& id, const JointVector& angles) {
  Posture posture;
  posture.id = id;
  for (int i = 0; i < arm.size(); ++i) posture.joints[static_cast<std::size_t>(i)] = angles[i];
  const Eigen::Vector3d tool = arm_pose(arm, angles).tool;
  posture.position = {tool.x(), tool.y(), tool.z()};
  return posture;
}

// The angles that a row gives, or that bring the tool where it says.
JointVector row_angles(const Arm& arm, const CsvTable& table, const CsvRow& row, bool joints,
                       std::size_t first_column) {
  if (joints) {
    JointVector angles(arm.size());
    for (int i = 0; i < arm.size(); ++i)
      angles[i] = deg_to_rad(table.number(row, table.require_column(kAngleColumns[static_cast<std::size_t>(i)])));
    const std::string beyond = beyond_limits(arm, angles);
    if (!beyond.empty()) table.fail(row, first_column, beyond);
    return angles;
  }
  const auto mm = [&](const char* name) { return 1e-3 * table.number(row, table.require_column(name)); };
  const Eigen::Vector3d place{mm("x_mm"), mm("y_mm"), mm("z_mm")};
  ToolPose pose{place, tool_pose(arm, home_angles(arm)).turned};
  if (const auto turn = table.find_column("redundancy_deg")) {
    if (arm.size() < kMapJoints) table.fail(row, *turn, "to turn about the tool's axis takes six joints; leave it out");
    const double angle = deg_to_rad(table.number(row, *turn));
    pose.turned = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * pose.turned;
  }
  try {
    return reach(arm, pose, home_angles(arm));
  } catch (const std::invalid_argument& error) {
    table.fail(row, first_column, error.what());
  }
}

void print_line(std::ostream& out, const char* format, auto... values) {
  std::array<char, 200> line{};
  std::snprintf(line.data(), line.size(), format, values...);
  out << line.data();
}

}  // namespace

DynamicsMap robot_postures(const Arm& arm, const std::string& robot_file, const std::string& postures_file) {
  if (arm.size() > kMapJoints)
    throw InputError(robot_file, 0, "the arm has " + std::to_string(arm.size()) + " joints; a dynamics map holds six");
  DynamicsMap map;
  map.has_joints = true;
  if (postures_file.empty()) {
    map.postures.push_back(posture_at(arm, "home", home_angles(arm)));
    return map;
  }
  const CsvTable table = read_csv(postures_file);
  std::vector<std::string> known{"posture", "x_mm", "y_mm", "z_mm", "redundancy_deg"};
  known.insert(known.end(), kAngleColumns.begin(), kAngleColumns.begin() + arm.size());
  check_column_names(table, known);
  const std::size_t id_column = table.require_column("posture");
  const bool joints = table.find_column("j1_deg").has_value();
  if (const auto turn = table.find_column("redundancy_deg"); joints && turn)
    throw InputError(postures_file, 1, "redundancy_deg goes with x_mm,y_mm,z_mm; joint angles tell it already");
  for (const CsvRow& row : table.rows()) {
    const std::string id = table.text(row, id_column);
    if (id.empty()) table.fail(row, id_column, "is empty; give the posture an id");
    const Posture posture = posture_at(arm, id, row_angles(arm, table, row, joints, id_column));
    for (const Posture& other : map.postures) {
      if (other.id == id) table.fail(row, id_column, id + " stands twice; give each its own id");
      if (posture_distance(other, posture, true) <= 1e-9)
        table.fail(row, id_column, id + " is the same posture as " + other.id + "; remove one of them");
    }
    map.postures.push_back(posture);
  }
  if (map.postures.empty()) throw InputError(postures_file, 0, "holds no posture; add a row for each");
  return map;
}

RobotModes robot_modes(const Arm& arm, const std::string& robot_file) {
  const auto serial = std::make_shared<SerialArm>(arm);
  return [serial, robot_file](const Posture& posture) {
    std::vector<Mode> modes;
    try {
      modes = tool_modes(serial->linearised(angles_of(serial->description(), posture)));
    } catch (const std::invalid_argument& error) {
      throw InputError(robot_file, 0, "posture " + posture.id + ": " + error.what());
    }
    for (const Mode& mode : modes) {
      if (!(mode.damping_ratio > 0.0))
        throw InputError(
            robot_file, 0,
            "posture " + posture.id + ": a mode has no damping; add <dynamics damping=\"...\"/> to the joints");
    }
    return modes;
  };
}

void print_robot_map(const DynamicsMap& map, const std::vector<ModeMatch>& matches, std::ostream& out) {
  out << "posture      mode   frequency  damping    stiffness   direction\n";
  for (const Posture& posture : map.postures) {
    for (std::size_t i = 0; i < posture.modes.size(); ++i) {
      const Mode& mode = posture.modes[i];
      print_line(out, "%-12s %4zu %8.2f Hz %7.2f %% %7.3g N/um   % .2f % .2f % .2f\n", i == 0 ? posture.id.c_str() : "",
                 i + 1, mode.natural_frequency / kTwoPi, 100.0 * mode.damping_ratio, 1e-6 * mode.stiffness,
                 mode.direction[0], mode.direction[1], mode.direction[2]);
    }
  }
  for (std::size_t r = 0; r < matches.size(); ++r) {
    if (matches[r].found == 0) {
      print_line(out, "robot mode %zu was found in no measurement and stays as described\n", r + 1);
    } else {
      print_line(out, "robot mode %zu was found at %d measured postures, at %.3g to %.3g times its frequency\n", r + 1,
                 matches[r].found, matches[r].lowest_frequency_ratio, matches[r].highest_frequency_ratio);
    }
  }
}

nlohmann::ordered_json robot_map_to_json(const DynamicsMap& map, const std::vector<ModeMatch>& matches) {
  nlohmann::ordered_json json{{"postures", nlohmann::ordered_json::array()}};
  for (const Posture& posture : map.postures) {
    nlohmann::ordered_json entry{{"posture", posture.id}};
    for (const double joint : posture.joints) entry["joints_deg"].push_back(rad_to_deg(joint));
    for (const double x : posture.position) entry["position_mm"].push_back(1e3 * x);
    for (const Mode& mode : posture.modes)
      entry["modes"].push_back({{"frequency_hz", mode.natural_frequency / kTwoPi},
                                {"damping_ratio", mode.damping_ratio},
                                {"stiffness_n_per_m", mode.stiffness},
                                {"direction", mode.direction}});
    json["postures"].push_back(entry);
  }
  if (matches.empty()) return json;
  json["matches"] = nlohmann::ordered_json::array();
  for (const ModeMatch& match : matches)
    json["matches"].push_back({{"found", match.found},
                               {"lowest_frequency_ratio", match.lowest_frequency_ratio},
                               {"highest_frequency_ratio", match.highest_frequency_ratio}});
  return json;
}

}  // namespace stillcut
