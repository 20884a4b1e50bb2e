// What the predictor says beyond the present posture and direction: along an announced path, over feed directions, and
// how sure it is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "drivers/files/dynamics_map_file.hpp"
#include "models/lobes.hpp"
#include "tests/simulated_cut.hpp"
#include "tools/predictor.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kHeard = 1'700'000'000'000'000'000;

// A robot between the first two postures of the demo cell's map.
class PredictorPath : public ::testing::Test {
 protected:
  RobotState robot_at(double share) const {
    RobotState state;
    state.stamp_ns = kHeard;
    for (std::size_t j = 0; j < 6; ++j)
      state.joint_position[j] = std::lerp(map_.postures[0].joints[j], map_.postures[1].joints[j], share);
    for (std::size_t i = 0; i < 3; ++i)
      state.tcp_position[i] = std::lerp(map_.postures[0].position[i], map_.postures[1].position[i], share);
    state.feed_direction = 0.5;
    state.spindle_speed_rpm = rad_s_to_rpm(cell_.cut->spindle_speed);
    state.axial_depth = state.radial_depth = kNaN;
    return state;
  }
  PathPoint point_at(double share, double after) const {
    const RobotState there = robot_at(share);
    PathPoint point;
    point.after = after;
    point.joint_position = there.joint_position;
    point.tcp_position = there.tcp_position;
    point.feed_direction = there.feed_direction;
    point.radial_depth = kNaN;
    return point;
  }
  RobotPath path_over(std::initializer_list<double> shares) const {
    RobotPath path;
    path.stamp_ns = kHeard;
    for (const double share : shares) {
      path.points[path.count] = point_at(share, 0.75 * static_cast<double>(path.count + 1));
      ++path.count;
    }
    return path;
  }

  Cell cell_ = demo_cell();
  DynamicsMap map_ = read_dynamics_map(cell_.dynamics->map);
};

TEST_F(PredictorPath, AlongAPathTheLeastLimitOfItsPointsCountsAtEverySpeed) {
  Predictor predictor{cell_};
  const std::initializer_list<double> shares{0.1, 0.5, 0.9};
  const LobeDiagram along = predictor.along(path_over(shares));
  ASSERT_TRUE(along.valid);
  std::vector<LobeDiagram> each;
  for (const double share : shares) each.push_back(predictor.at(robot_at(share)).value());
  int of_first = 0, of_last = 0;
  ASSERT_EQ(along.point_count, each[0].point_count);
  for (int i = 0; i < along.point_count; ++i) {
    const double speed = along.points[static_cast<std::size_t>(i)].speed;
    double least = kInfinity;
    for (const LobeDiagram& diagram : each) least = std::min(least, depth_limit_at(diagram, speed));
    EXPECT_EQ(depth_limit_at(along, speed), least) << i;
    of_first += depth_limit_at(each[0], speed) == least ? 1 : 0;
    of_last += depth_limit_at(each[2], speed) == least ? 1 : 0;
  }
  EXPECT_GT(of_first + of_last, 0);
  EXPECT_LT(std::max(of_first, of_last), along.point_count) << of_first << ' ' << of_last;  // no point alone decides
  for (const LobeDiagram& diagram : each) {
    EXPECT_GE(along.speed_scatter, diagram.speed_scatter);
    EXPECT_GE(along.depth_scatter, diagram.depth_scatter);
  }
}

TEST_F(PredictorPath, AlongAPathItIsUsableFromSoonUntilThePathEnds) {
  const LobeDiagram along = Predictor{cell_}.along(path_over({0.2, 0.4}));
  EXPECT_TRUE(along.ahead);
  EXPECT_GT(along.usable_from_ns, kHeard);
  EXPECT_LT(along.usable_from_ns, kHeard + 1'000'000'000);
  EXPECT_EQ(along.usable_until_ns, kHeard + 1'500'000'000);
  EXPECT_FALSE(Predictor{cell_}.at(robot_at(0.2))->ahead);
}

TEST_F(PredictorPath, APathWithoutPointsTakesBackWhatWasAnnounced) {
  const LobeDiagram none = Predictor{cell_}.along(path_over({}));
  EXPECT_TRUE(none.ahead);
  EXPECT_FALSE(none.valid);
  EXPECT_GT(none.usable_from_ns, kHeard);
}

TEST_F(PredictorPath, APathWithAPointThatCannotBePredictedGivesNothing) {
  const Predictor predictor{cell_};
  RobotPath too_wide = path_over({0.2, 0.4, 0.6});
  too_wide.points[1].radial_depth = 3.0 * cell_.tool->diameter;
  EXPECT_FALSE(predictor.along(too_wide).valid);
  RobotPath far_away = path_over({0.2, 0.4, 0.6});
  for (double& joint : far_away.points[2].joint_position) joint += 2.0;
  for (double& coordinate : far_away.points[2].tcp_position) coordinate += 20.0;
  EXPECT_FALSE(predictor.along(far_away).valid);
  EXPECT_TRUE(predictor.along(far_away).ahead);  // takes back what was announced before
}

// The limits over direction are those that the lobes have where the feed goes there.
TEST_F(PredictorPath, LimitsOverDirectionAreThoseOfEachDirectionAtTheSpeedAskedFor) {
  EXPECT_EQ(Predictor{cell_}.at(robot_at(0.0))->direction_count, 0);  // the path leaves no freedom
  cell_.compensation.limits.free_turn = 0.5;
  Predictor predictor{cell_};
  const LobeDiagram diagram = predictor.at(robot_at(0.0)).value();
  ASSERT_GT(diagram.direction_count, 3);
  EXPECT_NEAR(diagram.direction_speed, cell_.cut->spindle_speed, 1e-9);
  const std::array<double, 1> speed{diagram.direction_speed};
  Cut cut = *cell_.cut;
  double lowest = kInfinity, highest = 0.0;
  for (int i = 0; i < diagram.direction_count; ++i) {
    const DirectionLimit& limit = diagram.directions[static_cast<std::size_t>(i)];
    EXPECT_NEAR(limit.direction, std::numbers::pi * i / diagram.direction_count, 1e-12);
    cut.feed_direction = limit.direction;
    const double wanted =
        depth_limits(*cell_.tool, *cell_.material, cut, map_.postures[0].modes, speed, {}).front().depth;
    if (std::isfinite(wanted)) {
      EXPECT_NEAR(limit.depth_limit, wanted, 1e-6 * wanted);
      lowest = std::min(lowest, wanted);
      highest = std::max(highest, wanted);
    }
    cut.feed_direction += std::numbers::pi;  // the other way round the same
    const double opposite =
        depth_limits(*cell_.tool, *cell_.material, cut, map_.postures[0].modes, speed, {}).front().depth;
    if (std::isfinite(opposite)) {
      EXPECT_NEAR(limit.depth_limit, opposite, 1e-3 * opposite);
    }
  }
  EXPECT_GT(highest, 1.01 * lowest);
}

TEST_F(PredictorPath, LimitsOverDirectionFollowTheProgrammedSpeedInsideTheSpindlesRange) {
  cell_.compensation.limits.free_turn = 0.5;
  Predictor predictor{cell_};
  RobotState state = robot_at(0.0);
  const double first = predictor.at(state)->direction_speed;
  state.spindle_speed_rpm *= 1.05;
  EXPECT_NEAR(predictor.at(state)->direction_speed, 1.05 * first, 1e-9 * first);
  for (const double outside : {0.0, 2.0 * rad_s_to_rpm(cell_.spindle->max_speed)}) {
    state.spindle_speed_rpm = outside;
    EXPECT_EQ(predictor.at(state)->direction_count, 0) << outside;
  }
}

TEST_F(PredictorPath, ScatterIsSmallAtAMeasuredPostureAndGrowsBetweenTwo) {
  Predictor predictor{cell_};
  const LobeDiagram measured = predictor.at(robot_at(0.0)).value();
  EXPECT_GT(measured.speed_scatter, 0.0);
  EXPECT_LE(measured.speed_scatter, 0.01);
  EXPECT_GT(measured.depth_scatter, 0.0);
  EXPECT_LE(measured.depth_scatter, 0.1);
  EXPECT_EQ(predictor.nominal().diagram.speed_scatter, measured.speed_scatter);
  EXPECT_EQ(predictor.nominal().diagram.depth_scatter, measured.depth_scatter);
  LobeDiagram before = measured;
  for (const double share : {0.1, 0.2, 0.3, 0.4, 0.5}) {
    const LobeDiagram between = predictor.at(robot_at(share)).value();
    EXPECT_GE(between.speed_scatter, before.speed_scatter) << share;
    EXPECT_GE(between.depth_scatter, before.depth_scatter) << share;
    EXPECT_LE(between.speed_scatter, 0.05);
    EXPECT_LE(between.depth_scatter, 0.4);
    before = between;
  }
  EXPECT_GT(before.speed_scatter + before.depth_scatter, measured.speed_scatter + measured.depth_scatter);
  const LobeDiagram other = predictor.at(robot_at(1.0)).value();
  EXPECT_NEAR(other.speed_scatter, measured.speed_scatter, 1e-9);
  EXPECT_NEAR(other.depth_scatter, measured.depth_scatter, 1e-9);
}

// The feed map's word for the place of the robot goes with the diagram, and only as far as its places reach.
TEST_F(PredictorPath, TheFeedMapSaysWhereToFeedNearItsPlaces) {
  EXPECT_TRUE(std::isnan(Predictor{cell_}.at(robot_at(0.0))->planned_direction));
  const RobotState first = robot_at(0.0), second = robot_at(1.0);
  const std::filesystem::path file = std::filesystem::path{testing::TempDir()} / "feed_map.csv";
  std::ofstream{file} << "x_mm,y_mm,feed_direction_deg\n"
                      << 1e3 * first.tcp_position[0] << ',' << 1e3 * first.tcp_position[1] << ",35\n"
                      << 1e3 * second.tcp_position[0] << ',' << 1e3 * second.tcp_position[1] << ",120\n";
  cell_.compensation.limits.free_turn = 0.5;
  cell_.compensation.feed_map = file;
  Predictor predictor{cell_};
  EXPECT_NEAR(rad_to_deg(predictor.at(robot_at(0.1))->planned_direction), 35.0, 1e-9);
  EXPECT_NEAR(rad_to_deg(predictor.at(robot_at(0.9))->planned_direction), 120.0, 1e-9);
  RobotState beside = first;
  const double apart =
      std::hypot(second.tcp_position[0] - first.tcp_position[0], second.tcp_position[1] - first.tcp_position[1]);
  beside.tcp_position[0] -= 1.01 * std::copysign(apart, second.tcp_position[0] - first.tcp_position[0]);
  EXPECT_TRUE(std::isnan(predictor.at(beside)->planned_direction));
}

}  // namespace
}  // namespace stillcut
