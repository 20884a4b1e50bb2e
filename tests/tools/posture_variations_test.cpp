// Postures turned about the tool's axis and moved, and the values that an option lists.
#include "tools/posture_variations.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "drivers/files/dynamics_map_file.hpp"
#include "drivers/files/robot_file.hpp"
#include "models/arm_reach.hpp"
#include "models/machining.hpp"
#include "tests/tools/robot_cell.hpp"

namespace stillcut {
namespace {

// Fails where the axis is the workpiece's Z although the cell tilts the tool.
TEST(PostureMover, TurnsAboutTheTiltedToolWithItsPointAtRest) {
  const RobotCell folder;
  std::string text = content_of(folder.path() / "turned.toml");
  const std::string key = "feed_direction_deg = 0.0";
  (void)folder.write("tilted.toml",
                     text.replace(text.find(key), key.size(), "feed_direction_deg = 90.0\nlead_deg = 30.0"));
  const Cell cell = read_cell(folder.path() / "tilted.toml", {.dbc = false, .bus = false});
  const DynamicsMap map = read_dynamics_map(folder.path() / "turned-map");
  const Arm arm = read_robot(kTurningRobot);
  const VariationsAsked asked{std::vector<double>{0.3}, {}, {}, kTurningRobot};
  const PostureMover mover(cell, map, asked);
  const auto pose_of = [&](const Posture& posture) {
    JointVector angles(6);
    for (int i = 0; i < 6; ++i) angles[i] = posture.joints[static_cast<std::size_t>(i)];
    return tool_pose(arm, angles);
  };
  const ToolPose before = pose_of(map.postures[12]), after = pose_of(mover.moved(map.postures[12], {0.3, 0.01, -0.02}));
  EXPECT_LT((after.place - before.place - Eigen::Vector3d(0.01, -0.02, 0.0)).norm(), 1e-9);
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(after.turned * before.turned.transpose()));
  EXPECT_NEAR(turn.angle(), 0.3, 1e-8);
  const double lead = deg_to_rad(30.0);  // along the feed, which is the workpiece's Y
  EXPECT_LT((turn.axis() - Eigen::Vector3d(0.0, std::sin(lead), std::cos(lead))).norm(), 1e-7);
}

TEST(EquallySpacedValues, HoldTheEndsAndAnExactZero) {
  EXPECT_EQ(equally_spaced_values("-0.3:0.3:7"), (std::vector<double>{-0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3}));
  EXPECT_EQ(equally_spaced_values("5:5:1"), std::vector<double>{5.0});
  for (const char* wrong : {"", "1", "1:2", "1:2:3:4", "a:2:3", "1:2:2.5", "1:2:0", "1:1:2", "2:1:2", "1:inf:2"})
    EXPECT_THROW(equally_spaced_values(wrong), std::invalid_argument) << wrong;
}

}  // namespace
}  // namespace stillcut
