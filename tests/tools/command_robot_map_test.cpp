// stillcut map --robot, as a user runs it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "drivers/files/dynamics_map_file.hpp"
#include "models/machining.hpp"
#include "tests/tools/run_program.hpp"

namespace stillcut {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string kRobot = EXAMPLES "/demo-robot/robot.urdf";

Finished robot_map(const TempFolder& folder, std::initializer_list<std::string> arguments) {
  std::vector<std::string> all{"stillcut", "map"};
  all.insert(all.end(), arguments);
  return run(all, folder.path());
}

TEST(RobotMapCommand, HomePostureAloneGivesModesAndLobes) {
  const TempFolder folder;
  const Finished done = robot_map(folder, {"--robot", kRobot, "--out", "map"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("home"));
  const DynamicsMap map = read_dynamics_map(folder.path() / "map");
  ASSERT_EQ(map.postures.size(), 1U);
  EXPECT_TRUE(map.has_joints);
  const double first = map.postures[0].modes.front().natural_frequency / kTwoPi;
  EXPECT_GT(first, 8.0);
  EXPECT_LT(first, 20.0);
  std::filesystem::copy(EXAMPLES "/demo-robot/cell.toml", folder.path() / "cell.toml");
  const Finished lobes =
      run({"stillcut", "lobes", "cell.toml", "--method", "zoa", "--speed", "6000:9000:5"}, folder.path());
  EXPECT_EQ(lobes.exit_code, 0) << lobes.err;
}

TEST(RobotMapCommand, ShippedMapIsWhatTheCommandWrites) {
  const TempFolder folder;
  const Finished done = robot_map(
      folder, {"--robot", kRobot, "--postures", EXAMPLES "/demo-robot/postures.csv", "--out", "map", "--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const DynamicsMap ours = read_dynamics_map(folder.path() / "map"),
                    shipped = read_dynamics_map(EXAMPLES "/demo-robot/map");
  ASSERT_EQ(ours.postures.size(), shipped.postures.size());
  for (std::size_t p = 0; p < ours.postures.size(); ++p) {
    const auto &a = ours.postures[p].modes, &b = shipped.postures[p].modes;
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_NEAR(a[i].natural_frequency, b[i].natural_frequency, 1e-6 * b[i].natural_frequency);
      EXPECT_NEAR(a[i].stiffness, b[i].stiffness, 1e-5 * b[i].stiffness);
    }
  }
  const auto json = nlohmann::json::parse(done.out);
  EXPECT_EQ(json["postures"].size(), ours.postures.size());
}

TEST(RobotMapCommand, PosturesAreAnglesOrPlaces) {
  const TempFolder folder;
  (void)folder.write("angles.csv", "posture,j1_deg,j2_deg,j3_deg,j4_deg,j5_deg,j6_deg\na,20,15,5,0,70,0\n");
  ASSERT_EQ(robot_map(folder, {"--robot", kRobot, "--postures", "angles.csv", "--out", "one"}).exit_code, 0);
  const Posture angles = read_dynamics_map(folder.path() / "one").postures[0];
  EXPECT_NEAR(angles.joints[0], deg_to_rad(20), 1e-12);
  (void)folder.write("places.csv", "posture,x_mm,y_mm,z_mm\na,1500,200,900\n");
  ASSERT_EQ(robot_map(folder, {"--robot", kRobot, "--postures", "places.csv", "--out", "two"}).exit_code, 0);
  const Posture place = read_dynamics_map(folder.path() / "two").postures[0];
  EXPECT_NEAR(place.position[0], 1.5, 1e-8);
  EXPECT_NEAR(place.position[1], 0.2, 1e-8);
}

TEST(RobotMapCommand, TapTestsReplaceAndCorrect) {
  const TempFolder folder;
  std::filesystem::copy(EXAMPLES "/demo-robot", folder.path(), std::filesystem::copy_options::recursive);
  DynamicsMap measured = read_dynamics_map(folder.path() / "map");
  measured.postures.erase(measured.postures.begin() + 2, measured.postures.end());
  for (Posture& posture : measured.postures) {
    for (Mode& mode : posture.modes) mode.natural_frequency *= 0.9;
  }
  write_dynamics_map(folder.path() / "map", measured);
  const Finished done =
      robot_map(folder, {"cell.toml", "--robot", "robot.urdf", "--postures", "postures.csv", "--out", "mended"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("robot mode 1 was found at 2 measured postures, at 0.9 to 0.9 times"));
  const DynamicsMap mended = read_dynamics_map(folder.path() / "mended"),
                    described = read_dynamics_map(EXAMPLES "/demo-robot/map");
  ASSERT_EQ(mended.postures.size(), described.postures.size());
  for (std::size_t p = 0; p < mended.postures.size(); ++p) {
    const double was = described.postures[p].modes[0].natural_frequency;
    EXPECT_NEAR(mended.postures[p].modes[0].natural_frequency, 0.9 * was, 1e-6 * was) << p;
  }
}

struct RobotRefusal {
  std::vector<std::string> arguments;
  int exit_code;
  std::string says;
};

TEST(RobotMapCommand, RefusesWithOneLine) {
  const TempFolder folder;
  (void)folder.write("far.csv", "posture,x_mm,y_mm,z_mm\nok,1500,0,900\nout,9000,0,0\n");
  (void)folder.write("beyond.csv", "posture,j1_deg,j2_deg,j3_deg,j4_deg,j5_deg,j6_deg\na,200,10,10,0,70,0\n");
  (void)folder.write("twice.csv", "posture,x_mm,y_mm,z_mm\na,1500,0,900\na,1600,0,900\n");
  const std::string urdf = content_of(kRobot);
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = urdf;
    for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
    return text;
  };
  (void)folder.write("undamped.urdf", replaced("<dynamics", "<dynamic"));
  (void)folder.write("massless.urdf", replaced("inertial>", "visual>"));
  (void)folder.write("stiff.urdf", replaced("<stillcut stiffness", "<spring stiffness"));
  const RobotRefusal refusals[] = {
      {{"--robot", kRobot}, 2, "--out"},
      {{"--out", "map"}, 2, "--robot"},
      {{}, 2, "CELL"},
      {{"--robot", kRobot, "--out", "map", "--csv", "-"}, 2, "--csv"},
      {{"--robot", "none.urdf", "--out", "map"}, 3, "none.urdf: no such file"},
      {{"--robot", kRobot, "--postures", "far.csv", "--out", "map"}, 3, "far.csv:3: "},
      {{"--robot", kRobot, "--postures", "far.csv", "--out", "map"}, 3, "does not reach there"},
      {{"--robot", kRobot, "--postures", "beyond.csv", "--out", "map"}, 3, "joint_1 at 200.0 deg is beyond its limits"},
      {{"--robot", kRobot, "--postures", "twice.csv", "--out", "map"}, 3, "stands twice"},
      {{"--robot", "undamped.urdf", "--out", "map"}, 3, "undamped.urdf: posture home: a mode has no damping"},
      {{"--robot", "massless.urdf", "--out", "map"}, 3, "massless.urdf:14: link shoulder has no <inertial>"},
      {{"--robot", "stiff.urdf", "--out", "map"}, 3, "joint joint_1 has no stiffness"},
  };
  for (const RobotRefusal& refusal : refusals) {
    std::vector<std::string> all{"stillcut", "map"};
    all.insert(all.end(), refusal.arguments.begin(), refusal.arguments.end());
    const Finished done = run(all, folder.path());
    EXPECT_EQ(done.exit_code, refusal.exit_code) << refusal.says << "\n" << done.err;
    EXPECT_THAT(done.err, HasSubstr(refusal.says));
    EXPECT_THAT(done.err, StartsWith("stillcut: "));
    EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
  }
}

}  // namespace
}  // namespace stillcut
