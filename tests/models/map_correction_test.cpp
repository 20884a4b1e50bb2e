// A robot's modes mended by measured ones.
#include "models/map_correction.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "models/arm_modes.hpp"
#include "tests/models/machining_arm.hpp"

namespace stillcut {
namespace {

JointVector posture_angles(const Posture& posture) {
  return Eigen::Map<const Eigen::Matrix<double, 6, 1>>(posture.joints.data());
}

Posture posture_near_home(const std::string& id, double turn) {
  Posture posture;
  posture.id = id;
  const JointVector home = home_angles(test::machining_arm());
  for (int i = 0; i < 6; ++i) posture.joints[static_cast<std::size_t>(i)] = home[i];
  posture.joints[1] += turn;
  return posture;
}

DynamicsMap map_of(const RobotModes& robot, std::initializer_list<std::pair<const char*, double>> postures) {
  DynamicsMap map;
  map.has_joints = true;
  for (const auto& [id, turn] : postures) {
    map.postures.push_back(posture_near_home(id, turn));
    map.postures.back().modes = robot(map.postures.back());
  }
  return map;
}

std::vector<Mode> described(const Posture& posture) {
  return tool_modes(linear_arm(test::machining_arm(), posture_angles(posture)));
}

// The real robot's joints are softer than its description says.
std::vector<Mode> real(const Posture& posture) {
  Arm arm = test::machining_arm();
  for (ArmJoint& joint : arm.joints) joint.stiffness *= 0.8;
  std::vector<Mode> modes = tool_modes(linear_arm(arm, posture_angles(posture)));
  modes.push_back({6000.0, 0.02, 1e7, {1, 0, 0}});  // the tool in its holder
  return modes;
}

TEST(CorrectedMap, PredictsTheRealRobotBetweenItsTaps) {
  const DynamicsMap measured = map_of(real, {{"1", -0.2}, {"2", 0.2}});
  const DynamicsMap predicted = map_of(described, {{"a", -0.2}, {"b", 0.0}, {"2", 0.1}});
  const CorrectedMap result = corrected_map(measured, predicted, described);
  ASSERT_EQ(result.map.postures.size(), 4U);  // "a" is measured already
  EXPECT_EQ(result.map.postures[0].modes.size(), measured.postures[0].modes.size());
  EXPECT_EQ(result.map.postures[0].modes[0].stiffness, measured.postures[0].modes[0].stiffness);
  EXPECT_EQ(result.map.postures[2].id, "b");
  EXPECT_EQ(result.map.postures[3].id, "2-robot");
  for (std::size_t p = 2; p < 4; ++p) {
    const std::vector<Mode> truth = real(result.map.postures[p]);
    ASSERT_EQ(result.map.postures[p].modes.size(), truth.size());
    for (std::size_t i = 0; i < 5; ++i) {
      const Mode& mode = result.map.postures[p].modes[i];
      EXPECT_NEAR(mode.natural_frequency, truth[i].natural_frequency, 2e-3 * truth[i].natural_frequency);
      EXPECT_NEAR(mode.stiffness, truth[i].stiffness, 2e-2 * truth[i].stiffness);
      EXPECT_NEAR(mode.damping_ratio, truth[i].damping_ratio, 2e-2 * truth[i].damping_ratio);
    }
    EXPECT_EQ(result.map.postures[p].modes.back().natural_frequency, 6000.0);  // the tool goes with the robot
  }
  for (std::size_t r = 0; r < 5; ++r) EXPECT_EQ(result.matches[r].found, 2);
  EXPECT_NEAR(result.matches[0].lowest_frequency_ratio, std::sqrt(0.8), 2e-3);
}

TEST(CorrectedMap, LeavesAModeThatNobodyMeasured) {
  const auto one = [](const Posture& posture) { return std::vector<Mode>{described(posture)[1]}; };
  const DynamicsMap measured = map_of(one, {{"1", 0.0}}), predicted = map_of(described, {{"a", 0.1}});
  const CorrectedMap result = corrected_map(measured, predicted, described);
  EXPECT_EQ(result.matches[0].found, 0);
  EXPECT_EQ(result.matches[1].found, 1);
  const Mode &kept = result.map.postures[1].modes[0], &was = predicted.postures[0].modes[0];
  EXPECT_EQ(kept.natural_frequency, was.natural_frequency);
  EXPECT_EQ(kept.stiffness, was.stiffness);
}

TEST(CorrectedMap, NeedsJointAngles) {
  DynamicsMap measured = map_of(real, {{"1", 0.0}});
  measured.has_joints = false;
  EXPECT_THROW(corrected_map(measured, map_of(described, {{"a", 0.1}}), described), std::invalid_argument);
  EXPECT_THROW(corrected_map({}, map_of(described, {{"a", 0.1}}), described), std::invalid_argument);
}

}  // namespace
}  // namespace stillcut
