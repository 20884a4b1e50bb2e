// Every scenario that ships, in closed loop in data time, with corrections followed and not followed. What is asserted
// of the monitor is what holds today for clear cases; the table of docs/scenarios.md tells the rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "tools/closed_loop.hpp"
#include "tools/hil_score.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kScenarioOrigin = 1'700'000'000'000'000'000;

struct ClosedRun {
  HilScore score;
  Heard heard;
  int refused = 0;
  std::int64_t frames_lost = 0;
  double final_rpm = 0.0, largest_change_rpm = 0.0;  // of the spindle; from the program
};

ClosedRun run_closed(const std::string& name, RuntimeMode mode) {
  const Scenario scenario = read_scenario(EXAMPLES "/scenarios/" + name + ".toml");
  Cell cell = read_cell(scenario.cell, {.bus = false});
  cell.mode = mode;
  VirtualMachine machine{cell, scenario, kScenarioOrigin};
  ClosedRun run;
  run.heard = run_in_data_time(cell, machine);
  run.score = score_run(machine, run.heard.events);
  run.refused = machine.controller().refused();
  run.frames_lost = machine.frames_lost();
  run.final_rpm = rad_s_to_rpm(machine.state().spindle_speed);
  for (const MachineMoment& moment : machine.moments())
    run.largest_change_rpm =
        std::max(run.largest_change_rpm, std::abs(rad_s_to_rpm(moment.spindle_speed - moment.programmed_speed)));
  return run;
}

std::vector<std::string> shipped_scenarios() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(EXAMPLES "/scenarios"))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string test_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

bool has_fault(const Heard& heard, double from, double to) {
  return std::any_of(heard.events.begin(), heard.events.end(), [&](const Event& event) {
    const double time = static_cast<double>(event.stamp_ns - kScenarioOrigin) * 1e-9;
    return event.type == EventType::fault && time >= from && time <= to;
  });
}

class ShippedScenario : public testing::TestWithParam<std::string> {};

TEST_P(ShippedScenario, RunsWithAndWithoutCorrectionAndIsScored) {
  const Scenario scenario = read_scenario(EXAMPLES "/scenarios/" + GetParam() + ".toml");
  const ClosedRun shadow = run_closed(GetParam(), RuntimeMode::shadow);
  ASSERT_TRUE(scenario.chatter.has_value()) << "say what the physics is to do";
  EXPECT_EQ(!shadow.score.spells.empty(), *scenario.chatter);
  EXPECT_EQ(shadow.score.detected.has_value(), *scenario.chatter);
  EXPECT_EQ(shadow.refused, 0);

  const ClosedRun active = run_closed(GetParam(), RuntimeMode::active);
  if (!active.score.spells.empty() && !shadow.score.spells.empty()) {  // the same until something was corrected
    EXPECT_NEAR(active.score.spells[0].start, shadow.score.spells[0].start, 0.05);
  }
  for (const ClosedRun& run : {shadow, active}) {
    EXPECT_TRUE(std::isfinite(run.score.peak_displacement_um));
    EXPECT_LT(run.score.peak_displacement_um, 2000.0);
    EXPECT_EQ(run.score.suppressed.has_value(), run.score.detected.has_value());
    EXPECT_GT(run.score.detection_ms.value_or(0.0), -300.0);
    if (*scenario.chatter) continue;
    EXPECT_EQ(run.score.corrections, 0);
    if (GetParam() == "forced-vibration") continue;
    EXPECT_EQ(run.score.false_alarms, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(All, ShippedScenario, testing::ValuesIn(shipped_scenarios()), test_name);

TEST(ShippedScenarios, AreAtLeastADozen) { EXPECT_GE(shipped_scenarios().size(), 12U); }

// Once the spindle turns at the target one of its orders stands where the chatter was; that line is forced and asks for
// nothing more.
TEST(ShippedScenarios, ACorrectionThatEndsTheChatterIsTheOnlyOne) {
  for (const std::string name : {"depth-step", "depth-ramp", "pocket-above", "slow-spindle"}) {
    const ClosedRun run = run_closed(name, RuntimeMode::active);
    EXPECT_EQ(run.score.corrections, 1) << name;
    EXPECT_EQ(run.score.spells.size(), 1U) << name;
    EXPECT_LT(run.score.suppression_ms.value_or(1e9), 1000.0) << name;
  }
}

class RepeatableScenario : public testing::TestWithParam<std::string> {};

TEST_P(RepeatableScenario, RepeatsToTheBit) {
  const ClosedRun a = run_closed(GetParam(), RuntimeMode::active), b = run_closed(GetParam(), RuntimeMode::active);
  ASSERT_EQ(a.heard.events.size(), b.heard.events.size());
  for (std::size_t i = 0; i < a.heard.events.size(); ++i)
    EXPECT_EQ(0, std::memcmp(&a.heard.events[i].stamp_ns, &b.heard.events[i].stamp_ns, sizeof(std::int64_t)));
  ASSERT_EQ(a.heard.trace.size(), b.heard.trace.size());
  for (std::size_t i = 0; i < a.heard.trace.size(); ++i)
    EXPECT_EQ(0, std::memcmp(&a.heard.trace[i].indicator, &b.heard.trace[i].indicator, sizeof(double))) << i;
  EXPECT_EQ(a.score.peak_displacement_um, b.score.peak_displacement_um);
  EXPECT_EQ(a.score.roughness.value_or(ProfileRoughness{}).ra, b.score.roughness.value_or(ProfileRoughness{}).ra);
  EXPECT_EQ(a.final_rpm, b.final_rpm);
}

INSTANTIATE_TEST_SUITE_P(Some, RepeatableScenario, testing::Values("depth-step", "lost-frames", "posture-move"),
                         test_name);

TEST(ShippedScenarios, ADeepStepIsHeardAndCorrectedAndLeftAloneInShadow) {
  const ClosedRun shadow = run_closed("depth-step", RuntimeMode::shadow);
  ASSERT_EQ(shadow.score.spells.size(), 1U);
  EXPECT_NEAR(shadow.score.spells[0].start, 1.5, 0.02);
  EXPECT_NEAR(shadow.score.spells[0].frequency_hz, 757.0, 3.0);
  EXPECT_EQ(shadow.score.detected, true);
  EXPECT_LT(shadow.score.detection_ms.value_or(1e9), 200.0);
  EXPECT_EQ(shadow.score.suppressed, false);
  EXPECT_LT(shadow.largest_change_rpm, 1e-6);  // a shadow moves nothing

  const ClosedRun active = run_closed("depth-step", RuntimeMode::active);
  EXPECT_EQ(active.score.detected, true);
  ASSERT_FALSE(active.score.spells.empty());
  EXPECT_TRUE(active.score.spells[0].died_down);
  EXPECT_LT(active.score.spells[0].end, 2.6);
  EXPECT_GT(active.largest_change_rpm, 500.0);
}

TEST(ShippedScenarios, WhatIsRefusedChangesNothing) {
  const ClosedRun run = run_closed("refusing-controller", RuntimeMode::active);
  EXPECT_GT(run.refused, 0);
  EXPECT_EQ(run.score.detected, true);
  EXPECT_LT(run.largest_change_rpm, 1e-6);
}

TEST(ShippedScenarios, NothingIsAskedOfASilentController) {
  const ClosedRun run = run_closed("silent-controller", RuntimeMode::active);
  EXPECT_EQ(run.score.corrections, 0);
  EXPECT_EQ(run.score.detected, true);
  EXPECT_LT(run.largest_change_rpm, 1e-6);
}

TEST(ShippedScenarios, FaultsOfTheSensorAreTold) {
  EXPECT_TRUE(has_fault(run_closed("sensor-stuck", RuntimeMode::shadow).heard, 2.2, 2.5));
  EXPECT_TRUE(has_fault(run_closed("sensor-saturated", RuntimeMode::shadow).heard, 1.6, 1.8));
  EXPECT_TRUE(has_fault(run_closed("sensor-silent", RuntimeMode::shadow).heard, 2.4, 2.7));
}

}  // namespace
}  // namespace stillcut
