#include "tools/predictor.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "drivers/files/dynamics_map_file.hpp"
#include "models/lobes.hpp"
#include "tests/simulated_cut.hpp"
#include "tests/tools/run_program.hpp"
#include "tools/pipeline.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000, kNow = 1'700'000'000 * kSecond;

// A robot at the posture that the demo cell names.
RobotState at_home(const Cell& cell) {
  RobotState state;
  state.stamp_ns = kNow;
  const DynamicsMap map = read_dynamics_map(cell.dynamics->map);
  const Posture home = find_posture(map, cell.dynamics->posture);
  state.joint_position = home.joints;
  state.tcp_position = home.position;
  state.feed_direction = cell.cut->feed_direction;
  state.axial_depth = state.radial_depth = std::nan("");
  return state;
}

TEST(Predictor, NominalDiagramSpansTheSpindleAndIsUsableAtOnce) {
  const Cell cell = demo_cell();
  const LobeDiagram diagram = Predictor{cell}.nominal().diagram;
  ASSERT_TRUE(diagram.valid);
  EXPECT_EQ(diagram.usable_from_ns, 0);
  EXPECT_EQ(diagram.posture_stamp_ns, 0);
  EXPECT_NEAR(diagram.points[0].speed, cell.spindle->min_speed, 1e-9);
  EXPECT_NEAR(diagram.points[diagram.point_count - 1].speed, cell.spindle->max_speed, 1e-9);
  EXPECT_GT(diagram.mode_count, 0);
}

TEST(Predictor, ACutThatLobesCannotDescribeLeavesTheModesAndAWarning) {
  Cell cell = demo_cell();
  cell.spindle->min_speed = 1e-3;  // hours to a turn
  const NominalPrediction prediction = Predictor{cell}.nominal();
  EXPECT_NE(prediction.warning.find("no stability lobes"), std::string::npos);
  EXPECT_TRUE(prediction.diagram.valid);
  EXPECT_EQ(prediction.diagram.point_count, 0);
  EXPECT_GT(prediction.diagram.mode_count, 0);
  EXPECT_TRUE(std::isnan(margin_at(prediction.diagram, cell.cut->spindle_speed, 1e-3)));
}

TEST(Predictor, ARobotAtTheNominalPostureGetsTheNominalLobesDated) {
  const Cell cell = demo_cell();
  Predictor predictor{cell};
  const LobeDiagram nominal = predictor.nominal().diagram;
  const auto diagram = predictor.at(at_home(cell));
  ASSERT_TRUE(diagram.has_value());
  EXPECT_EQ(diagram->posture_stamp_ns, kNow);
  EXPECT_GT(diagram->usable_from_ns, kNow);
  ASSERT_EQ(diagram->point_count, nominal.point_count);
  for (int i = 0; i < nominal.point_count; ++i)
    EXPECT_EQ(diagram->points[i].depth_limit, nominal.points[i].depth_limit);
}

TEST(Predictor, WhatTheRobotTellsOfItsCutCounts) {
  const Cell cell = demo_cell();
  Predictor predictor{cell};
  const LobeDiagram nominal = predictor.nominal().diagram;
  RobotState slot = at_home(cell);
  slot.milling = Milling::slot;
  slot.radial_depth = cell.tool->diameter;
  const auto diagram = predictor.at(slot);
  ASSERT_TRUE(diagram.has_value());
  int different = 0;
  for (int i = 0; i < nominal.point_count; ++i) {
    different += diagram->points[i].depth_limit != nominal.points[i].depth_limit ? 1 : 0;
  }
  EXPECT_GT(different, nominal.point_count / 2);
}

TEST(Predictor, AnImmersionThatCannotBeGivesNoDiagram) {
  const Cell cell = demo_cell();
  Predictor predictor{cell};
  RobotState wide = at_home(cell);
  wide.radial_depth = 3.0 * cell.tool->diameter;
  EXPECT_FALSE(predictor.at(wide).has_value());
}

TEST(PredictionPace, TakesTwentyFiveStatesASecond) {
  PredictionPace pace;
  int taken = 0;
  for (int i = 0; i < 1000; ++i) {  // four seconds at 250 Hz, beginning within a period
    RobotState state;
    state.stamp_ns = kNow + PredictionPace::kPeriodNs / 2 + i * kSecond / 250;
    taken += pace.due(state) ? 1 : 0;
  }
  EXPECT_EQ(taken, 101);
}

// A robot that moves through the map, one state every 40 ms: what the loop reads is the diagram of where the robot was
// a quarter of a second before, and none once the robot has moved on without one.
TEST(Predictor, TheLoopReadsTheLobesOfTheRobotsOwnPostureWhileItMoves) {
  const Cell cell = demo_cell();
  const DynamicsMap map = read_dynamics_map(cell.dynamics->map);
  ASSERT_GT(map.postures.size(), 1U);
  Predictor predictor{cell}, apart{cell};
  Pipeline pipeline{cell};
  Core& core = pipeline.core();
  RobotState state = at_home(cell);
  const auto place = [&](double share) {
    for (std::size_t j = 0; j < 6; ++j) {
      state.joint_position[j] = (1 - share) * map.postures[0].joints[j] + share * map.postures[1].joints[j];
    }
    for (std::size_t i = 0; i < 3; ++i) {
      state.tcp_position[i] = (1 - share) * map.postures[0].position[i] + share * map.postures[1].position[i];
    }
    state.feed_direction = share;
  };
  constexpr int kSteps = 25;
  constexpr std::int64_t kPeriod = PredictionPace::kPeriodNs, kLate = 250'000'000;
  int compared = 0;
  for (int i = 0; i < kSteps; ++i) {
    const std::int64_t now = kNow + i * kPeriod;
    place(static_cast<double>(i) / kSteps);
    state.stamp_ns = now;
    ASSERT_TRUE(core.accept_frame(now));
    core.add_robot_state(state);
    const auto diagram = predictor.at(state);
    ASSERT_TRUE(diagram.has_value());
    core.add_lobes(*diagram);
    core.advance(now);
    const LobeDiagram* read = core.lobes();
    if (i * kPeriod < kLate) continue;
    ASSERT_NE(read, nullptr) << i;
    const std::int64_t of_step = (read->posture_stamp_ns - kNow) / kPeriod;
    EXPECT_EQ(of_step, (i * kPeriod - kLate) / kPeriod);
    place(static_cast<double>(of_step) / kSteps);
    const auto expected = apart.at(state);
    ASSERT_TRUE(expected.has_value());
    for (int k = 0; k < read->point_count; ++k) {
      const double limit = expected->points[static_cast<std::size_t>(k)].depth_limit;
      const double got = read->points[static_cast<std::size_t>(k)].depth_limit;
      if (std::isfinite(limit)) {
        EXPECT_NEAR(got, limit, 1e-9);
      }
    }
    ++compared;
  }
  EXPECT_GT(compared, 15);
  // States go on, diagrams do not come: after a second and a half there is none.
  state.stamp_ns = kNow + kSteps * kPeriod + 2 * kSecond;
  ASSERT_TRUE(core.accept_frame(state.stamp_ns));
  core.add_robot_state(state);
  core.advance(state.stamp_ns);
  EXPECT_EQ(core.lobes(), nullptr);
}

TEST(Pipeline, AccelerometersAreCheckedBeforeTheMonitorIsBuilt) {
  const DemoCell folder;
  folder.change("sample_rate_hz = 25600", "sample_rate_hz = 499.9");
  const Cell cell = read_cell(folder.path() / "cell.toml", {.bus = false});
  EXPECT_THROW(Pipeline{cell}, InputError);
  Cell none = demo_cell();
  none.can->accelerometers.clear();
  EXPECT_THROW(core_settings(none), InputError);
}

}  // namespace
}  // namespace stillcut
