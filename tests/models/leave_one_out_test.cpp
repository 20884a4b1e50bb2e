#include "models/leave_one_out.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "models/machining.hpp"

namespace stillcut {
namespace {

// Postures in a row along the first joint, 0.1 rad apart; two modes, the first rising by `slope` from one to the next.
DynamicsMap row(int count, double slope = 0.02) {
  DynamicsMap map;
  map.has_joints = true;
  for (int i = 0; i < count; ++i) {
    Posture posture;
    posture.id = std::to_string(i + 1);
    posture.joints[0] = 0.1 * i;
    posture.modes = {{kTwoPi * 18.0 * std::exp(slope * i), 0.03, 2e6, {1, 0, 0}},
                     {kTwoPi * 60.0, 0.02, 8e6, {0, 1, 0}}};
    map.postures.push_back(posture);
  }
  return map;
}

TEST(LeaveOneOut, MeanAndModalAreWhatTheirDefinitionSays) {
  const DynamicsMap map = row(3);
  const LeaveOneOut report = leave_one_out(map);
  ASSERT_EQ(report.postures.size(), 3U);
  const auto frequency = [&](std::size_t i) { return map.postures[i].modes[0].natural_frequency; };
  const ModePrediction& mean = report.postures[0].by(MapMethod::mean).modes[0];
  EXPECT_NEAR(mean.frequency_error, 0.5 * (frequency(1) + frequency(2)) / frequency(0) - 1.0, 1e-12);
  // Distances 0.1 and 0.2: weights 2/3 and 1/3.
  const ModePrediction& modal = report.postures[0].by(MapMethod::modal).modes[0];
  EXPECT_NEAR(modal.frequency_error, (2.0 * frequency(1) + frequency(2)) / 3.0 / frequency(0) - 1.0, 1e-12);
  EXPECT_NEAR(report.postures[0].nearest_distance, 0.1, 1e-12);
  EXPECT_EQ(report.postures[0].nearest, "2");
  EXPECT_TRUE(report.in_joints);
  EXPECT_NEAR(report.of(MapMethod::modal).first_frequency.worst, std::abs(modal.frequency_error), 1e-12);
}

TEST(LeaveOneOut, FindsTheSlopeThatTheTrendFollows) {
  const LeaveOneOut report = leave_one_out(row(9));
  EXPECT_LT(report.of(MapMethod::trend).frequency.worst, 1e-6);
  EXPECT_EQ(report.best, MapMethod::trend);
  EXPECT_TRUE(report.beats_mean);
}

TEST(LeaveOneOut, PrefersThePlainerWayWhereAllAreExact) {
  const LeaveOneOut report = leave_one_out(row(6, 0.0));
  for (const MapMethod method : kMapMethods) {
    EXPECT_LT(report.of(method).frequency.worst, 1e-9) << name_of(method);
    EXPECT_LT(report.of(method).peak.worst, 1e-6) << name_of(method);
    EXPECT_EQ(report.of(method).spurious_peaks, 0) << name_of(method);
  }
  EXPECT_EQ(report.best, MapMethod::modal);
}

TEST(LeaveOneOut, CountsThePeaksThatWeightingResponsesSplits) {
  const LeaveOneOut report = leave_one_out(row(3, 0.15));  // 15 % apart, half-widths of 3 %
  EXPECT_EQ(report.postures[1].by(MapMethod::frf).spurious_peaks, 1);
  EXPECT_EQ(report.postures[1].by(MapMethod::modal).spurious_peaks, 0);
  EXPECT_GE(report.of(MapMethod::frf).spurious_peaks, 1);
}

TEST(LeaveOneOut, TwoPosturesPredictEachOtherAlikeByEveryWay) {
  const LeaveOneOut report = leave_one_out(row(2));
  for (const MapMethod method : kMapMethods) {
    EXPECT_NEAR(report.postures[0].by(method).modes[0].frequency_error, std::exp(0.02) - 1.0, 1e-9);
  }
  EXPECT_FALSE(report.beats_mean);
}

TEST(LeaveOneOut, RefusesMapsThatHaveNothingToLeaveOut) {
  EXPECT_THROW(leave_one_out({}), std::invalid_argument);
  EXPECT_THROW(leave_one_out(row(1)), std::invalid_argument);
  DynamicsMap map = row(3);
  map.postures[2].modes[0].stiffness = -1.0;
  EXPECT_THROW(leave_one_out(map), std::invalid_argument);
}

TEST(LeaveOneOut, AModeThatOnlyOnePostureHasIsMissingThere) {
  DynamicsMap map = row(5);
  map.postures[2].modes.push_back({kTwoPi * 240.0, 0.02, 5e7, {0, 0, 1}});
  const LeaveOneOut report = leave_one_out(map);
  const auto& modes = report.postures[2].by(MapMethod::modal).modes;
  ASSERT_EQ(modes.size(), 3U);
  EXPECT_FALSE(modes[2].predicted.has_value());
  EXPECT_TRUE(std::isnan(modes[2].frequency_error));
  EXPECT_EQ(report.of(MapMethod::modal).missing_modes, 1);
  EXPECT_EQ(report.postures[2].by(MapMethod::modal).missing_peaks, 1);
  EXPECT_EQ(report.postures[1].by(MapMethod::modal).modes.size(), 2U);
}

TEST(LeaveOneOut, PosturesWithNoModeInCommonAreMissingNotFatal) {
  DynamicsMap map = row(4, 0.0);
  for (int i = 0; i < 4; ++i) {
    map.postures[static_cast<std::size_t>(i)].modes = {
        {kTwoPi * 20.0 * std::pow(3.0, i), 0.02, 1e6, {i % 2 == 0 ? 1.0 : 0.0, i % 2 == 0 ? 0.0 : 1.0, 0}}};
  }
  EXPECT_NO_THROW({
    const LeaveOneOut report = leave_one_out(map);
    EXPECT_EQ(report.of(MapMethod::modal).missing_modes, 4);
  });
}

TEST(LeaveOneOut, TellsItsProgress) {
  double last = -1.0;
  leave_one_out(row(4), {}, [&](double share) {
    EXPECT_GT(share, last);
    EXPECT_LT(share, 1.0);
    last = share;
  });
  EXPECT_EQ(last, 0.75);
}

TEST(LeaveOneOut, WithoutTheWeightedResponsesTellsTheSameOfTheOthers) {
  const DynamicsMap map = row(6);
  const LeaveOneOut all = leave_one_out(map), some = leave_one_out(map, {}, {}, false);
  EXPECT_EQ(some.methods, (std::vector<MapMethod>{MapMethod::mean, MapMethod::modal, MapMethod::trend}));
  EXPECT_EQ(all.methods.size(), kMapMethods.size());
  for (const MapMethod method : some.methods) EXPECT_EQ(some.of(method).score, all.of(method).score) << name_of(method);
  EXPECT_EQ(some.best, all.best);
  EXPECT_TRUE(some.postures[0].by(MapMethod::frf).modes.empty());
}

TEST(LeftOutScatter, IsTheRootMeanSquareOfWhatTheReportSays) {
  std::mt19937_64 random(4);
  DynamicsMap map = row(7);
  for (Posture& posture : map.postures) {
    for (Mode& mode : posture.modes) {
      mode.natural_frequency *= std::uniform_real_distribution<>(0.97, 1.03)(random);
      mode.damping_ratio *= std::uniform_real_distribution<>(0.8, 1.2)(random);
      mode.stiffness *= std::uniform_real_distribution<>(0.9, 1.1)(random);
    }
  }
  const LeaveOneOut report = leave_one_out(map);
  const Interpolation ways[] = {{.kind = InterpolationKind::frf}, {}, {.kind = InterpolationKind::trend}};
  const MapMethod methods[] = {MapMethod::frf, MapMethod::modal, MapMethod::trend};
  for (std::size_t way = 0; way < 3; ++way) {
    const auto scatter = left_out_scatter(map, ways[way]);
    ASSERT_TRUE(scatter);
    EXPECT_NEAR(scatter->frequency, report.of(methods[way]).frequency.rms, 1e-12);
    EXPECT_NEAR(scatter->damping, report.of(methods[way]).damping.rms, 1e-12);
  }
  double squares = 0.0;
  for (const LeftOutPosture& posture : report.postures) {
    for (const ModePrediction& mode : posture.by(MapMethod::modal).modes) {
      squares += std::pow(mode.predicted->stiffness / mode.measured.stiffness - 1.0, 2);
    }
  }
  EXPECT_NEAR(left_out_scatter(map, {})->stiffness, std::sqrt(squares / 14), 1e-12);
}

TEST(LeftOutScatter, IsUnknownToAMapThatIsTooSmall) {
  EXPECT_FALSE(left_out_scatter(row(1), {}));
  DynamicsMap two = row(2);
  for (Posture& posture : two.postures) posture.modes.pop_back();
  EXPECT_FALSE(left_out_scatter(two, {}));
  EXPECT_TRUE(left_out_scatter(row(3), {}));
}

}  // namespace
}  // namespace stillcut
