// URDF files: what is read, and what is said about those that cannot be a milling robot.
#include "drivers/files/robot_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "drivers/files/input_error.hpp"
#include "models/arm_dynamics.hpp"
#include "tests/drivers/files/temp_folder.hpp"
#include "tests/models/machining_arm.hpp"

namespace stillcut {
namespace {

using std::numbers::pi;

// Two joints; the second link is of two parts, the tool's mass hanging on it by a fixed joint.
const std::string kUrdf = R"(<?xml version="1.0"?>
<robot name="small">
  <link name="base"/>
  <joint name="a" type="revolute">
    <parent link="base"/> <child link="one"/>
    <origin xyz="0 0 0.5" rpy="0 0 0"/> <axis xyz="0 0 2"/>
    <limit lower="-1.5" upper="1.5"/> <dynamics damping="100"/>
    <stillcut stiffness_n_m_per_rad="1e6" home_deg="30"/>
  </joint>
  <link name="one">
    <inertial><origin xyz="0.1 0 0" rpy="0 0 1.5707963267948966"/><mass value="50"/>
      <inertia ixx="1" iyy="2" izz="2.5" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="b" type="continuous">
    <parent link="one"/> <child link="two"/>
    <origin xyz="0.4 0 0" rpy="-1.5707963267948966 0 0"/> <axis xyz="0 0 1"/>
  </joint>
  <link name="two">
    <inertial><mass value="10"/><inertia ixx="0.2" iyy="0.2" izz="0.2"/></inertial>
  </link>
  <joint name="mount" type="fixed"><parent link="two"/><child link="tool"/><origin xyz="0.2 0 0"/></joint>
  <link name="tool">
    <inertial><origin xyz="0.1 0 0"/><mass value="5"/><inertia ixx="0.01" iyy="0.02" izz="0.02"/></inertial>
  </link>
  <gazebo reference="b"><springStiffness>5e5</springStiffness></gazebo>
</robot>
)";

std::string with(std::string_view from, std::string_view to) {
  std::string text = kUrdf;
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::runtime_error("no " + std::string(from));
  return text.replace(at, from.size(), to);
}

Arm read_text(const std::string& text) {
  const TempFolder folder;
  return read_robot(folder.write("r.urdf", text));
}

std::string error_in(const std::string& text) {
  const std::string message = message_of<InputError>([&] { (void)read_text(text); });
  return message.substr(message.rfind("r.urdf") == std::string::npos ? 0 : message.rfind("r.urdf"));
}

TEST(RobotFile, ReadsJointsAndMergesWhatIsFixed) {
  const Arm arm = read_text(kUrdf);
  ASSERT_EQ(arm.size(), 2);
  EXPECT_EQ(arm.name, "small");
  const ArmJoint& a = arm.joints[0];
  const ArmJoint& b = arm.joints[1];
  EXPECT_EQ(a.axis, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(a.stiffness, 1e6);
  EXPECT_EQ(a.damping, 100.0);
  EXPECT_NEAR(a.home, pi / 6, 1e-15);
  EXPECT_EQ(a.lower, -1.5);
  EXPECT_NEAR(a.inertia(0, 0), 2.0, 1e-12);  // its axes are turned by 90 degrees
  EXPECT_NEAR(a.inertia(1, 1), 1.0, 1e-12);
  EXPECT_EQ(b.stiffness, 5e5);  // Gazebo's
  EXPECT_EQ(b.damping, 0.0);
  EXPECT_TRUE(std::isinf(b.upper));
  EXPECT_EQ(b.mass, 15.0);
  EXPECT_NEAR(b.centre.x(), 5.0 * 0.3 / 15.0, 1e-15);
  EXPECT_NEAR(b.inertia(0, 0), 0.21, 1e-12);
  EXPECT_NEAR(b.inertia(1, 1), 0.22 + 10.0 * 5.0 / 15.0 * 0.3 * 0.3, 1e-12);  // two masses 0.3 m apart
  EXPECT_NEAR(arm.tool.x(), 0.2, 1e-15);
  // The second axis is turned to point along y, so that at home the tool lies straight out.
  const ArmPose pose = arm_pose(arm, home_angles(arm));
  EXPECT_LT((pose.tool - Eigen::Vector3d(0.6 * std::cos(pi / 6), 0.3, 0.5)).norm(), 1e-14);
}

TEST(RobotFile, SpringInTheJointComesBeforeGazebos) {
  const Arm arm = read_text(
      with("reference=\"b\"", "reference=\"a\"")
          .replace(kUrdf.find("0 0 1\"/>\n  </joint>"), 8, "0 0 1\"/><stillcut stiffness_n_m_per_rad=\"7e5\"/>"));
  EXPECT_EQ(arm.joints[0].stiffness, 1e6);
  EXPECT_EQ(arm.joints[1].stiffness, 7e5);
}

TEST(RobotFile, ToolLinkIsTheOneThatIsNamed) {
  const Arm arm = read_text(with("<link name=\"base\"/>", "<link name=\"base\"/><stillcut tool_link=\"two\"/>"));
  EXPECT_EQ(arm.tool, Eigen::Vector3d::Zero());
}

struct RobotFileCase {
  const char *from, *to, *says;
};

TEST(RobotFile, RefusesWithFileLineAndWhatToDo) {
  const RobotFileCase cases[] = {
      {"</robot>", "", "r.urdf:2: is not XML"},
      {"<robot name=\"small\">", "<robt>", "r.urdf:"},
      {"<mass value=\"50\"/>", "<mass value=\"0\"/>", "r.urdf:10: link one has no <inertial> with a mass"},
      {"<mass value=\"50\"/>", "", "r.urdf:11: <inertial> has no <mass>"},
      {"<mass value=\"50\"/>", "<mass value=\"5O\"/>", "r.urdf:11: <mass>: value is not a number"},
      {"<mass value=\"50\"/>", "<mass value=\"nan\"/>", "value is not a number"},
      {"<mass value=\"50\"/>", "<mass value=\"-50\"/>", "is negative"},
      {"ixx=\"1\"", "ixx=\"9\"", "r.urdf:4: joint a: no body has the inertia of its link"},
      {"<stillcut stiffness_n_m_per_rad=\"1e6\" home_deg=\"30\"/>", "",
       "r.urdf:4: joint a has no stiffness; add <stillcut"},
      {"\"1e6\"", "\"0\"", "r.urdf:8: the stiffness of joint a must be above 0"},
      {"\"1e6\"", "\"soft\"", "r.urdf:8: <stillcut>: stiffness_n_m_per_rad is not a number"},
      {"stiffness_n_m_per_rad", "stiffnes_n_m_per_rad", "did you mean stiffness_n_m_per_rad?"},
      {">5e5<", ">-1<", "r.urdf:25: the stiffness of joint b must be above 0"},
      {"reference=\"b\"", "reference=\"c\"", "\"c\", which is no joint"},
      {"home_deg=\"30\"", "home_deg=\"100\"", "r.urdf:4: joint a: its home angle is beyond its limits"},
      {"lower=\"-1.5\"", "lower=\"2\"", "lower is above upper"},
      {"damping=\"100\"", "damping=\"-1\"", "damping of joint a is negative"},
      {"\"0 0 2\"", "\"0 0 0\"", "the axis of joint a has no length"},
      {"\"0 0 2\"", "\"0 2\"", "xyz is not 3 numbers"},
      {"type=\"continuous\"", "type=\"prismatic\"", "r.urdf:14: joint b is prismatic; only revolute"},
      {"<axis xyz=\"0 0 2\"/>", "<mimic joint=\"b\"/>", "r.urdf:4: joint a mimics another"},
      {"<child link=\"two\"/>", "<child link=\"too\"/>", "r.urdf:14: there is no link \"too\""},
      {"<parent link=\"one\"/>", "<parent link=\"base\"/>", "r.urdf:14: the arm branches: a and b hang on one body"},
      {"<parent link=\"two\"/><child link=\"tool\"/>", "<parent link=\"two\"/><child link=\"one\"/>",
       "link one hangs on two joints"},
      {"<parent link=\"two\"/>", "<parent link=\"base\"/>", "the tool link tool does not hang on the last joint, b"},
      {"<parent link=\"base\"/> <child link=\"one\"/>", "<parent link=\"tool\"/> <child link=\"one\"/>", "loop"},
      {"<link name=\"tool\">", "<link name=\"cutter\">", "there is no link \"tool\""},
      {"<link name=\"base\"/>", "<link name=\"base\"/><stillcut tool_link=\"cutter\"/>",
       "r.urdf:3: there is no link \"cutter\""},
      {"<link name=\"base\"/>", "<link name=\"base\"/><link name=\"base\"/>", "link base stands twice"},
      {"<link name=\"base\"/>", "<link name=\"base\"/><link name=\"alone\"/>", "link alone hangs on no joint"},
      {"<link name=\"base\"/>", "<xacro:arm/><link name=\"base\"/>", "expand it first"},
      {"<joint name=\"a\"", "<joint name=\"\"", "r.urdf:4: <joint name=\"\"> has no name"},
  };
  for (const RobotFileCase& c : cases) {
    const std::string message = error_in(with(c.from, c.to));
    EXPECT_NE(message.find(c.says), std::string::npos) << c.from << " -> " << c.to << ": '" << message << "'";
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

TEST(RobotFile, RefusesAnArmThatCannotMoveOrHasNoTool) {
  EXPECT_NE(error_in("<robot name=\"r\"><link name=\"base\"/></robot>").find("no joint that moves"), std::string::npos);
  EXPECT_NE(error_in("<robot name=\"r\"/>").find("no link"), std::string::npos);
  EXPECT_NE(error_in("<sdf/>").find("has no <robot>"), std::string::npos);
  EXPECT_NE(error_in("").find("not XML"), std::string::npos);
  EXPECT_NE(error_in("joints = 6").find("not XML"), std::string::npos);
  std::string text = with("<link name=\"tool\">", "<link name=\"cutter\">");
  text.replace(text.find("<child link=\"tool\"/>"), 20, "<child link=\"cutter\"/>");
  EXPECT_NE(error_in(text).find("r.urdf:2: names no tool link; add <stillcut tool_link"), std::string::npos);
  EXPECT_NE(message_of<InputError>([] { (void)read_robot("/nowhere.urdf"); }).find("no such file"), std::string::npos);
}

TEST(RobotFile, RefusesMoreJointsThanAreSupported) {
  std::string text = "<robot name=\"r\">\n<link name=\"l0\"/>\n";
  for (int i = 1; i <= 9; ++i) {
    const std::string n = std::to_string(i), before = std::to_string(i - 1);
    text.append("<joint name=\"j").append(n).append("\" type=\"continuous\"><parent link=\"l").append(before);
    text.append("\"/><child link=\"l")
        .append(n)
        .append("\"/><stillcut stiffness_n_m_per_rad=\"1\"/></joint>\n<link name=\"l");
    text.append(n).append(
        "\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial></link>\n");
  }
  EXPECT_NE(error_in(text + "</robot>").find("more than 8 joints"), std::string::npos);
}

TEST(RobotFile, DemoRobotIsTheMachiningArm) {
  const Arm arm = read_robot(TEST_DATA "/../../examples/demo-robot/robot.urdf"), same = test::machining_arm();
  ASSERT_EQ(arm.size(), same.size());
  EXPECT_LT((arm.tool - same.tool).norm(), 1e-15);
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    EXPECT_LT((arm.joints[i].origin - same.joints[i].origin).norm(), 1e-15) << i;
    EXPECT_LT((arm.joints[i].axis - same.joints[i].axis).norm(), 1e-15) << i;
    EXPECT_LT((arm.joints[i].centre - same.joints[i].centre).norm(), 1e-12) << i;
    EXPECT_LT((arm.joints[i].inertia - same.joints[i].inertia).norm(), 1e-12 * 60) << i;
    EXPECT_EQ(arm.joints[i].mass, same.joints[i].mass) << i;
    EXPECT_EQ(arm.joints[i].stiffness, same.joints[i].stiffness) << i;
    EXPECT_EQ(arm.joints[i].damping, same.joints[i].damping) << i;
    EXPECT_NEAR(arm.joints[i].home, same.joints[i].home, 1e-15) << i;
  }
}

}  // namespace
}  // namespace stillcut
