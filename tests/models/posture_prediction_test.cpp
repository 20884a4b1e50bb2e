// How well the map predicts postures that nobody measured, on robots that the interpolation does not know: elastic
// joints, 15 postures on a plane as in the surface paper (section 3.1), first mode 17-19 Hz. What the paper claims:
// within 5 %. What issue 3 asks beyond: a third of what the mean of the others gives.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <random>

#include "elastic_joint_robot.hpp"
#include "models/leave_one_out.hpp"
#include "models/machining.hpp"
#include "tests/sanitized.hpp"

namespace stillcut {
namespace {

// Robots of two makes as published (seed 0), or with every mass, spring and damper off by up to a quarter, drawn from
// the seed and used as they come.
DynamicsMap map_of(const std::string& make, unsigned seed) {
  const test::ElasticRobot robot = make == "kuka" ? test::kuka() : test::staubli();
  std::mt19937_64 random(seed);
  return test::plane_map(seed == 0 ? robot : test::varied(robot, 0.25, random));
}

void print(const std::string& name, const LeaveOneOut& report) {
  for (const MapMethod method : kMapMethods) {
    const MethodErrors& e = report.of(method);
    std::printf(
        "%-10s %-6s first mode %5.2f / %5.2f %%, all modes %5.2f / %5.2f %%, damping %6.1f / %5.1f %%, "
        "peak %5.1f / %5.1f %%, spurious %2d, missing %d+%d, score %5.2f\n",
        name.c_str(), name_of(method), 100 * e.first_frequency.worst, 100 * e.first_frequency.rms,
        100 * e.frequency.worst, 100 * e.frequency.rms, 100 * e.damping.worst, 100 * e.damping.rms, 100 * e.peak.worst,
        100 * e.peak.rms, e.spurious_peaks, e.missing_peaks, e.missing_modes, e.score);
  }
}

TEST(PosturePrediction, ReportSetsFourWaysSideBySide) {
  std::printf("worst / rms, relative\n");
  for (const std::string make : {"staubli", "kuka"}) {
    if (test::kSanitized && make == "kuka") continue;
    const LeaveOneOut report = leave_one_out(map_of(make, 0));
    print(make, report);
    const MethodErrors &trend = report.of(MapMethod::trend), &mean = report.of(MapMethod::mean);
    EXPECT_LT(trend.first_frequency.worst, 0.05);
    EXPECT_LT(trend.frequency.worst, 0.05);
    EXPECT_LT(trend.first_frequency.rms, mean.first_frequency.rms / 3.0);
    EXPECT_LT(trend.frequency.rms, mean.frequency.rms / 3.0);
    EXPECT_LT(trend.peak.worst, 0.05);
    EXPECT_EQ(trend.spurious_peaks + trend.missing_peaks + trend.missing_modes, 0);
    EXPECT_EQ(report.best, MapMethod::trend);
    EXPECT_TRUE(report.beats_mean);
    // The paper's own weights lean so far toward the mean on a grid this even that they hardly beat it.
    EXPECT_LT(report.of(MapMethod::modal).first_frequency.rms, mean.first_frequency.rms);
    EXPECT_GT(report.of(MapMethod::modal).first_frequency.rms, mean.first_frequency.rms / 3.0);
  }
}

// The same without the report's own arithmetic, on 40 robots: the modes in the order of their frequencies, which on
// these planes do not cross.
TEST(PosturePrediction, FortyRobotsWithinFivePerCentAndAThirdOfTheMean) {
  double worst = 0.0, largest_share_first = 0.0, largest_share_all = 0.0;
  for (const std::string make : {"staubli", "kuka"}) {
    for (unsigned seed = 0; seed < 20; ++seed) {
      const DynamicsMap map = map_of(make, seed);
      const auto count = static_cast<double>(map.postures.size());
      ASSERT_EQ(count, 15);
      double first = 0.0, first_of_mean = 0.0, all = 0.0, all_of_mean = 0.0;
      for (std::size_t left = 0; left < map.postures.size(); ++left) {
        const Posture& truth = map.postures[left];
        EXPECT_GT(truth.modes.front().natural_frequency, kTwoPi * 16.9) << make << seed;
        EXPECT_LT(truth.modes.front().natural_frequency, kTwoPi * 19.1) << make << seed;
        DynamicsMap others = map;
        others.postures.erase(others.postures.begin() + static_cast<std::ptrdiff_t>(left));
        const auto modes = predict_posture(others, truth, {.kind = InterpolationKind::trend}).posture.modes;
        ASSERT_EQ(modes.size(), truth.modes.size()) << make << seed;
        for (std::size_t m = 0; m < modes.size(); ++m) {
          double mean = 0.0;
          for (const Posture& other : others.postures) mean += other.modes[m].natural_frequency / (count - 1.0);
          const double measured = truth.modes[m].natural_frequency;
          const double error = modes[m].natural_frequency / measured - 1.0, of_mean = mean / measured - 1.0;
          worst = std::max(worst, std::abs(error));
          all += error * error, all_of_mean += of_mean * of_mean;
          if (m == 0) first += error * error, first_of_mean += of_mean * of_mean;
        }
      }
      EXPECT_LT(std::sqrt(first / first_of_mean), 1.0 / 3.0) << make << seed;
      EXPECT_LT(std::sqrt(all / all_of_mean), 1.0 / 3.0) << make << seed;
      largest_share_first = std::max(largest_share_first, std::sqrt(first / first_of_mean));
      largest_share_all = std::max(largest_share_all, std::sqrt(all / all_of_mean));
    }
  }
  EXPECT_LT(worst, 0.05);
  std::printf(
      "worst error %.2f %%; rms beside the mean's, in the worst of 40 robots: first mode %.3f, all modes %.3f\n",
      100 * worst, largest_share_first, largest_share_all);
}

}  // namespace
}  // namespace stillcut
