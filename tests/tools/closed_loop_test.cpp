// The campaign in closed loop (tests/tools/closed_loop): that its cells are what their class says, that its figures
// come out right, and a few short runs of each class. The long runs are the program's: closed_loop_campaign.
#include <gtest/gtest.h>

#include <cmath>

#include "models/lobes.hpp"
#include "tests/drivers/files/temp_folder.hpp"
#include "tests/tools/closed_loop/summary.hpp"

namespace stillcut::campaign {
namespace {

constexpr double kShortRun = 7.0;  // s

LobeDiagram diagram_of(const RandomCell& cell) {
  return compute_lobe_diagram(cell.tool, cell.material, cell.cut, cell.spindle, cell.modes, {.points = 161});
}

// Truth of a cell that nobody corrects.
bool chatters(const RandomCell& cell, double speed) {
  const TempFolder folder;
  write_cell(cell, folder.path());
  const Cell milled = read_cell(folder.path() / "machine.toml", {.bus = false});
  Scenario scenario = read_scenario(folder.path() / "scenario.toml", milled);
  scenario.spindle_speed = {{0.0, speed}};
  VirtualMachine machine{milled, scenario, 0};
  while (!machine.ended()) machine.advance();
  return measure(cell, machine, {}).chattered;
}

TEST(RandomCells, AreTheSameFromTheSameSeedAndOthersFromAnother) {
  const RandomCell a = random_cell(CellClass::pocket, 3, 4, kShortRun), b = random_cell(CellClass::pocket, 3, 4, 60.0);
  EXPECT_EQ(a.cut.axial_depth, b.cut.axial_depth);  // nor does the run's length change the cell
  EXPECT_EQ(a.modes.back().stiffness, b.modes.back().stiffness);
  EXPECT_NE(a.cut.axial_depth, random_cell(CellClass::pocket, 3, 5, kShortRun).cut.axial_depth);
  EXPECT_NE(a.cut.axial_depth, random_cell(CellClass::pocket, 4, 4, kShortRun).cut.axial_depth);
}

TEST(RandomCells, HaveTheMarginsOfTheirClass) {
  for (std::uint64_t i = 0; i < 6; ++i) {
    const RandomCell pocket = random_cell(CellClass::pocket, 7, i, kShortRun);
    EXPECT_LT(margin_at(diagram_of(pocket), pocket.cut.spindle_speed, pocket.cut.axial_depth), -0.1) << i;
    EXPECT_GT(worst_limit(diagram_of(pocket), pocket.pocket_speed, 0.02) / pocket.cut.axial_depth - 1.0, 0.15) << i;
    const RandomCell none = random_cell(CellClass::none, 7, i, kShortRun);
    const LobeDiagram nowhere = diagram_of(none);
    for (int p = 0; p < nowhere.point_count; ++p)
      EXPECT_LT(margin_at(nowhere, nowhere.points[static_cast<std::size_t>(p)].speed, none.cut.axial_depth), -0.1) << i;
    const RandomCell stable = random_cell(CellClass::stable, 7, i, kShortRun);
    EXPECT_GT(worst_limit(diagram_of(stable), stable.cut.spindle_speed, 0.02) / stable.cut.axial_depth - 1.0, 0.3) << i;
  }
}

TEST(RandomCells, MillAsTheirLobesSay) {
  for (std::uint64_t i = 0; i < 4; ++i) {
    const RandomCell pocket = random_cell(CellClass::pocket, 11, i, 4.0);
    EXPECT_TRUE(chatters(pocket, pocket.cut.spindle_speed)) << i;
    EXPECT_FALSE(chatters(pocket, pocket.pocket_speed)) << i;
    const RandomCell none = random_cell(CellClass::none, 11, i, 4.0);
    const bool slow = none.chatter_hz < 80.0;  // of the robot: it may take longer than this run to grow
    EXPECT_TRUE(slow || chatters(none, none.cut.spindle_speed)) << i;
    EXPECT_TRUE(slow || chatters(none, none.spindle.max_speed)) << i;
    const RandomCell stable = random_cell(CellClass::stable, 11, i, 5.0);
    EXPECT_FALSE(chatters(stable, stable.cut.spindle_speed)) << i;
  }
}

TEST(RandomCells, GiveTheMonitorAMapThatErrsAsMuchAsAsked) {
  const RandomCell exact = random_cell(CellClass::pocket, 2, 0, kShortRun);
  const RandomCell off = random_cell(CellClass::pocket, 2, 0, kShortRun, {1.0});
  ASSERT_EQ(exact.modes.size(), off.map_modes.size());
  double largest = 0.0;
  for (std::size_t m = 0; m < exact.modes.size(); ++m) {
    EXPECT_EQ(exact.map_modes[m].stiffness, exact.modes[m].stiffness);
    const double error = std::abs(off.map_modes[m].stiffness / off.modes[m].stiffness - 1.0);
    largest = std::max(largest, error);
  }
  EXPECT_LT(largest, 0.5);  // two modes may have changed places
  EXPECT_GT(largest, 0.01);
}

TEST(ClosedLoopCampaign, HearsEveryPocketAndLeavesStableCutsAlone) {
  std::vector<CellRun> pockets, stable;
  for (int i = 0; i < 5; ++i) {
    const TempFolder a, b;
    const auto index = static_cast<std::uint64_t>(i);
    CellRun run{i, random_cell(CellClass::pocket, 1, index, kShortRun), {}, {}};
    run.metrics = run_cell(run.cell, a.path());
    pockets.push_back(run);
    EXPECT_FALSE(std::isnan(run.metrics.alarm)) << line_of(run);
    EXPECT_LT(run.metrics.in_pocket, 5e-6) << line_of(run);
    run.cell = random_cell(CellClass::stable, 1, index, kShortRun);
    run.metrics = run_cell(run.cell, b.path());
    stable.push_back(run);
    EXPECT_TRUE(run.metrics.asked.empty()) << line_of(run);
  }
  EXPECT_NE(summarise(pockets).text.find("5 cells of class pocket"), std::string::npos);
  EXPECT_TRUE(summarise(stable).met) << summarise(stable).text;
}

// The figures of a run that is told here: alarm at 2 s, targets A, B, A.
TEST(ClosedLoopMetrics, CountTargetsAndSeeThemReturn) {
  const RandomCell cell = random_cell(CellClass::pocket, 1, 0, 4.0);
  const TempFolder folder;
  write_cell(cell, folder.path());
  const Cell milled = read_cell(folder.path() / "machine.toml", {.bus = false});
  constexpr std::int64_t kOrigin = 1'700'000'000'000'000'000;
  VirtualMachine machine{milled, read_scenario(folder.path() / "scenario.toml", milled), kOrigin};
  while (!machine.ended()) machine.advance();
  Heard heard;
  heard.events = {{kOrigin + 2'000'000'000, EventType::chatter_onset}};
  const double rpm = rad_s_to_rpm(cell.cut.spindle_speed);
  for (int i = 0; i < 9; ++i) {  // three messages each
    Correction c;
    c.stamp_ns = kOrigin + 2'000'000'000 + 100'000'000LL * i;
    c.mode = RuntimeMode::active;
    c.kind = CorrectionKind::spindle_speed;
    c.spindle_speed_target_rpm = i / 3 == 1 ? 0.9 * rpm : 0.8 * rpm;
    heard.corrections.push_back(c);
  }
  const RunMetrics run = measure(cell, machine, heard);
  EXPECT_NEAR(run.alarm, 2.0, 1e-9);
  ASSERT_EQ(run.asked.size(), 3U);
  EXPECT_EQ(run.targets, 2);
  EXPECT_TRUE(run.limit_cycle);
  EXPECT_TRUE(run.chattered);
  EXPECT_FALSE(run.in_time());  // nobody moved the spindle
  EXPECT_NEAR(run.at_correction, run.at_alarm, 1e-12);
  // At the acceleration's limit the move would take its length over it; the jerk adds a little.
  const double shortest = 0.2 * cell.cut.spindle_speed / cell.spindle.acceleration;
  EXPECT_GT(run.allowed, shortest + 4.0 * cell.controller.spindle_time_constant + 0.1);
  EXPECT_LT(run.allowed, shortest + 4.0 * cell.controller.spindle_time_constant + 0.1 + 0.3);
}

}  // namespace
}  // namespace stillcut::campaign
