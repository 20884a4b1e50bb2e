// Scenario files: what is read from them, and that contradictions are refused with file, line and key.
#include "drivers/files/scenario.hpp"

#include <gtest/gtest.h>

#include "tests/drivers/files/example_cell.hpp"

namespace stillcut {
namespace {

const std::string kExampleScenario = R"toml(cell = "cell.toml"
title = "All of it"
duration_s = 5
seed = 7
chatter = "expected"

[program]
milling = "up"
posture = "12"
axial_depth_mm = [[0, 0], [0.5, 0], [0.5, 1.5]]
radial_depth_mm = [[0, 12.5]]
spindle_speed_rpm = [[0, 3000], [2, 3600]]
feed_direction_deg = [[0, 0], [4, 90]]

[[posture_move]]
start_s = 1
end_s = 2
to = "13"

[[posture_move]]
start_s = 3
end_s = 4
to = "12"

[[interrupted]]
start_s = 1
end_s = 2
in_cut_s = 0.2
in_air_s = 0.1

[[knock]]
time_s = 2.5
impulse_n_s = [0.1, 0, 0]

[[outside_force]]
start_s = 1
end_s = 4.5
frequency_hz = 120
force_n = [5, 0, 0]

[[sensor_fault]]
start_s = 1
end_s = 1.5
kind = "offset"
axis = "y"
offset_m_per_s2 = 30

[[sensor_fault]]
start_s = 2
kind = "silent"

[[lost_frames]]
start_s = 0
end_s = 5
rate = 0.01

[controller]
cycle_ms = 4
lag_ms = 20
spindle_time_constant_s = 0.2
turn_rate_deg_per_s = 30
accepts = ["spindle_speed", "stop"]
[[controller.fault]]
start_s = 1
end_s = 2
kind = "refuses"
)toml";

std::filesystem::path write_example_scenario(const TempFolder& folder, const std::string& text) {
  (void)write_example_cell(folder);
  (void)folder.write("map/postures.csv",
                     "posture,j1_deg,j2_deg,j3_deg,j4_deg,j5_deg,j6_deg,x_mm,y_mm,z_mm\n"
                     "12,0,0,0,0,0,0,0,0,0\n13,10,0,0,0,0,0,100,0,0\n");
  (void)folder.write("map/modes.csv",
                     "posture,mode,frequency_hz,damping_ratio,stiffness_n_per_m,ux,uy,uz\n"
                     "12,1,50,0.03,1e6,1,0,0\n13,1,48,0.03,1e6,1,0,0\n");
  return folder.write("run.toml", text);
}

TEST(ScenarioFile, IsReadInSiUnits) {
  const TempFolder folder;
  const Scenario scenario = read_scenario(write_example_scenario(folder, kExampleScenario));
  EXPECT_EQ(scenario.title, "All of it");
  EXPECT_EQ(scenario.cell, folder.path() / "cell.toml");
  EXPECT_EQ(scenario.seed, 7U);
  EXPECT_EQ(scenario.chatter, true);
  EXPECT_EQ(scenario.milling, Milling::up);
  EXPECT_EQ(scenario.posture, "12");
  ASSERT_EQ(scenario.axial_depth.size(), 3U);
  EXPECT_DOUBLE_EQ(value_at(scenario.axial_depth, 0.6), 1.5e-3);
  EXPECT_DOUBLE_EQ(value_at(scenario.spindle_speed, 1.0), rpm_to_rad_s(3300));
  EXPECT_DOUBLE_EQ(value_at(scenario.feed_direction, 4.0), deg_to_rad(90));
  ASSERT_EQ(scenario.moves.size(), 2U);
  EXPECT_EQ(scenario.moves[0].to, "13");
  ASSERT_EQ(scenario.sensor_faults.size(), 2U);
  EXPECT_EQ(scenario.sensor_faults[0].axis, 1);
  EXPECT_DOUBLE_EQ(scenario.sensor_faults[0].offset, 30.0);
  EXPECT_DOUBLE_EQ(scenario.sensor_faults[1].span.end, 5.0);  // an open end is the scenario's
  EXPECT_DOUBLE_EQ(scenario.controller.cycle, 0.004);
  EXPECT_DOUBLE_EQ(scenario.controller.turn_rate, deg_to_rad(30));
  EXPECT_EQ(scenario.controller.accepts, (std::vector{CorrectionKind::spindle_speed, CorrectionKind::stop_request}));
  ASSERT_EQ(scenario.controller.faults.size(), 1U);
  EXPECT_EQ(scenario.controller.faults[0].kind, ControllerFaultKind::refuses);
}

TEST(ScenarioFile, LeavesToTheCellWhatItDoesNotSay) {
  const TempFolder folder;
  const Scenario scenario = read_scenario(write_example_scenario(folder, "cell = \"cell.toml\"\nduration_s = 2\n"));
  EXPECT_EQ(scenario.title, "run");
  EXPECT_TRUE(scenario.axial_depth.empty());
  EXPECT_FALSE(scenario.milling.has_value());
  EXPECT_FALSE(scenario.chatter.has_value());
  EXPECT_EQ(scenario.controller.accepts.size(), 5U);
}

// `from` in the example becomes `to`; the error names the line where `at` then stands, the key, and says `words`.
struct ScenarioMistake {
  std::string from, to, at, key, words;
};

const std::vector<ScenarioMistake> kScenarioMistakes{
    {"[2, 3600]", "[2, 3600], [1, 3500]", "spindle_speed", "program.spindle_speed_rpm", "goes back in time"},
    {"[0.5, 1.5]", "[6, 1.5]", "axial_depth", "program.axial_depth_mm", "6 s lies after the end"},
    {"[0.5, 1.5]", "[0.5, 1.5], [0.5, 2]", "axial_depth", "program.axial_depth_mm", "more than two values at 0.5 s"},
    {"[0.5, 1.5]", "[0.5, -1.5]", "axial_depth", "program.axial_depth_mm", "-1.5 is out of range"},
    {"[0.5, 1.5]", "[0.5]", "axial_depth", "program.axial_depth_mm", "not a pair"},
    {"[0.5, 1.5]", "[0.5, nan]", "axial_depth", "program.axial_depth_mm", "out of range"},
    {"[[0, 12.5]]", "[]", "radial_depth", "program.radial_depth_mm", "give a list of pairs"},
    {"[[0, 12.5]]", "[[0, 26]]", "radial_depth", "program.radial_depth_mm", "up to the tool's diameter"},
    {"[2, 3600]", "[2, 3900]", "spindle_speed", "program.spindle_speed_rpm", "3900 is outside the spindle"},
    {"[0, 3000]", "[0, 2700]", "spindle_speed", "program.spindle_speed_rpm", "give speeds from 2800 to 3800"},
    {"milling = \"up\"", "milling = \"sideways\"", "milling", "program.milling", "is not known"},
    {"posture = \"12\"", "posture = \"99\"", "posture = \"99\"", "program.posture", "99"},
    {"to = \"13\"", "to = \"14\"", "to = \"14\"", "posture_move.to", "14"},
    {"start_s = 3\nend_s = 4\nto", "start_s = 1.5\nend_s = 4\nto", "start_s = 1.5", "posture_move.start_s",
     "one move at a time"},
    {"start_s = 1\nend_s = 2\nto", "start_s = 2\nend_s = 1\nto", "end_s = 1\nto", "posture_move.end_s",
     "is not after start_s"},
    {"time_s = 2.5", "time_s = 5.5", "time_s = 5.5", "knock.time_s", "after the end"},
    {"time_s = 2.5", "time_s = -1", "time_s = -1", "knock.time_s", "out of range"},
    {"impulse_n_s = [0.1, 0, 0]", "impulse_n_s = [0.1, 0]", "impulse", "knock.impulse_n_s", "three numbers"},
    {"end_s = 4.5", "end_s = 7", "end_s = 7", "outside_force.end_s", "after the end"},
    {"kind = \"offset\"", "kind = \"stuck\"", "offset_m", "sensor_fault.offset_m_per_s2", "\"offset\" only"},
    {"offset_m_per_s2 = 30\n", "", "[[sensor_fault]]", "sensor_fault.offset_m_per_s2", "is missing"},
    {"kind = \"silent\"", "kind = \"silent\"\naxis = \"x\"", "axis = \"x\"", "sensor_fault.axis", "all are silent"},
    {"start_s = 2\nkind", "start_s = 1.2\nkind", "start_s = 1.2", "sensor_fault.start_s", "already has a fault"},
    {"rate = 0.01", "rate = 1.5", "rate", "lost_frames.rate", "out of range"},
    {"cycle_ms = 4", "cycle_ms = 40", "cycle_ms", "controller.cycle_ms", "from 4 to 12"},
    {"lag_ms = 20", "lag_ms = 1", "lag_ms", "controller.lag_ms", "from 10 to 20"},
    {"turn_rate_deg_per_s = 30", "turn_rate_deg_per_s = 0", "turn_rate", "controller.turn_rate_deg_per_s", "above 0"},
    {"\"stop\"", "\"halt\"", "accepts", "controller.accepts", "\"halt\" is not known; give a list of any of"},
    {"[\"spindle_speed\", \"stop\"]", "\"stop\"", "accepts", "controller.accepts", "give a list of any of"},
    {"\"stop\"", "3", "accepts", "controller.accepts", "give a list of any of"},
    {"kind = \"refuses\"", "kind = \"sulks\"", "kind = \"sulks\"", "controller.fault.kind", "is not known"},
    {"in_air_s = 0.1", "in_air_s = 0", "in_air_s", "interrupted.in_air_s", "above 0"},
    {"seed = 7", "sead = 7", "sead", "sead", "did you mean seed?"},
    {"[[knock]]", "[[knok]]", "[[knok]]", "knok", "unknown key; did you mean knock?"},
    {"milling =", "miling =", "miling", "program.miling", "did you mean milling?"},
    {"duration_s = 5", "", "", "duration_s", "is missing"},
    {"duration_s = 5", "duration_s = 0", "duration_s", "duration_s", "above 0"},
    {"cell = \"cell.toml\"", "cell = \"none.toml\"", "cell = ", "cell", "no file"},
    {"cell = \"cell.toml\"", "", "", "cell", "is missing"},
    {"seed = 7", "seed = = 7", "seed", "seed", "mend this line"},
};

class ScenarioMistakes : public testing::TestWithParam<ScenarioMistake> {};

TEST_P(ScenarioMistakes, AreRefusedWithLineAndKey) {
  const auto& [from, to, at, key, words] = GetParam();
  const std::string text = replaced(kExampleScenario, from, to);
  const TempFolder folder;
  const auto file = write_example_scenario(folder, text);
  const std::string message = message_of<InputError>([&] { (void)read_scenario(file); });
  const std::string place = file.string() + (at.empty() ? "" : ":" + std::to_string(line_of(text, at)));
  EXPECT_TRUE(message.starts_with(place + ": " + key + ": ")) << message << "\nexpected at " << place;
  EXPECT_NE(message.find(words), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(All, ScenarioMistakes, testing::ValuesIn(kScenarioMistakes));

}  // namespace
}  // namespace stillcut
