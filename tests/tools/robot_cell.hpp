// A folder with the demo robot, for tests of what turns and moves it.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "drivers/files/dynamics_map_file.hpp"
#include "tests/tools/run_program.hpp"

namespace stillcut {

inline const std::string kTurningRobot = EXAMPLES "/demo-robot/robot.urdf";

// A folder with the demo robot, its cell and the map that holds it turned.
class RobotCell : public TempFolder {
 public:
  RobotCell() { std::filesystem::copy(EXAMPLES "/demo-robot", path(), std::filesystem::copy_options::recursive); }

  [[nodiscard]] Finished varied(std::vector<std::string> more, const std::string& cell = "turned.toml") const {
    more.insert(more.begin(), {"stillcut", "directions", cell, "--method", "zoa"});
    return run(more, path());
  }
  // The robot with every `from` replaced.
  [[nodiscard]] std::string robot_with(const std::string& from, const std::string& to) const {
    std::string text = content_of(kTurningRobot);
    const auto at = text.find(from);
    if (at == std::string::npos) throw std::runtime_error("robot.urdf has no '" + from + "'");
    (void)write("other.urdf", text.replace(at, from.size(), to));
    return "other.urdf";
  }
  // The demo robot's map by place alone: two postures 100 mm apart along X.
  void forget_joints() const {
    DynamicsMap map = read_dynamics_map(path() / "map");
    map.has_joints = false;
    map.postures.resize(2);
    map.postures[0].id = "a";
    map.postures[0].position = {0.0, 0.0, 0.0};
    map.postures[1].id = "b";
    map.postures[1].position = {0.1, 0.0, 0.0};
    write_dynamics_map(path() / "map", map);
    std::string text = content_of(path() / "cell.toml");
    const std::string home = "posture = \"home\"";
    (void)write("cell.toml", text.replace(text.find(home), home.size(), "posture = \"a\""));
  }
};

}  // namespace stillcut
