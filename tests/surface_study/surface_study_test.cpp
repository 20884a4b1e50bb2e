// The fitted map and what it says of areas that it has not, beside Table 3 of Liu et al. 2024. The whole table takes
// minutes: it is held to its targets by a test of its own, surface_study.areas (tools/check --long).
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "drivers/files/dynamics_map_file.hpp"
#include "tests/surface_study/area_fit.hpp"

namespace stillcut::surface_study {
namespace {

constexpr std::array<std::uint64_t, 3> kSeeds{101, 102, 103};
constexpr int kJobs = 2;

std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  EXPECT_TRUE(in) << file;
  return {std::istreambuf_iterator<char>(in), {}};
}

// Fails where a stiffness or the CSV is changed without the other.
TEST(SurfaceStudyMap, IsWhatTheFitProgramWritesForItsStoredStiffnesses) {
  const auto folder = std::filesystem::temp_directory_path() / ("surface-study-" + std::to_string(getpid()));
  write_dynamics_map(folder, area_map(StudySettings{}.modes, kFittedStiffness));
  for (const std::string name : {"modes.csv", "postures.csv"})
    EXPECT_EQ(content_of(folder / name), content_of(EXAMPLES "/surface-cell/map/" + name));
  std::filesystem::remove_all(folder);
}

// An area that is left out gets weights of the others: fails with one that looks at its own.
TEST(SurfaceStudyMap, DoesNotKnowTheAreaThatIsLeftOut) {
  auto other = kFittedStiffness;
  other[2] *= 3.0;
  const auto stiffness = [](const std::array<double, kAreas>& all) {
    return predicted_modes(area_map(StudySettings{}.modes, all, 2), 2).front().stiffness;
  };
  EXPECT_EQ(stiffness(other), stiffness(kFittedStiffness));
  other[1] *= 3.0;
  EXPECT_GT(stiffness(other), stiffness(kFittedStiffness));
}

// The parabola gives back what it was made of.
TEST(SurfaceStudyFit, FindsTheStiffnessOfAKnownLaw) {
  const PublishedArea& area = kPublished[0];
  std::vector<FitPoint> points;
  for (const double stiffness : {0.8e6, 1.0e6, 1.3e6, 1.7e6}) {
    FitPoint point{stiffness, {}};
    const double falls = std::pow(stiffness / 1.17e6, -1.3);
    point.figures.ra = 1e-6 * area.ra_measured * falls * 1.1;
    point.figures.rq = 1e-6 * area.rq_measured * falls / 1.1;
    points.push_back(point);
  }
  EXPECT_NEAR(fitted_stiffness(points, area), 1.17e6, 1e-3 * 1.17e6);
  points.resize(2);
  EXPECT_THROW((void)fitted_stiffness(points, area), std::invalid_argument);
}

// One area of case 7, whose own roughness is not in the map: nearer to the measurement than a tool that does not
// vibrate, by far, and coarser along the feed.
TEST(SurfaceStudy, AnAreaLeftOutIsRoughAsMeasuredAndNotAsTheStillTool) {
  constexpr std::size_t kF = 5;
  const std::array<std::uint64_t, 1> seed{101};
  const AreaFigures ours = left_out_figures(kF, kFittedStiffness, {}, seed, kJobs);
  const AreaFigures still = area_surface(cut_of_case(7), {}, 0.0, 1, kJobs).figures;
  const double measured = 1e-6 * kPublished[kF].ra_measured;
  EXPECT_LT(still.ra, 0.2 * measured);
  EXPECT_NEAR(ours.ra, measured, 0.35 * measured);
  EXPECT_GT(ours.width_along, 2.0 * still.width_along);
}

// The targets over the whole table.
TEST(WholeTable, AreasLeftOutAreWithinTenPercentInTheMedian) {
  std::vector<double> ours, others, still;
  for (std::size_t area = 0; area < kAreas; ++area) {
    const double measured = 1e-6 * kPublished.at(area).ra_measured;
    double mean = 0.0;
    for (std::size_t other = 0; other < kAreas; ++other)
      if (other != area) mean += 1e-6 * kPublished.at(other).ra_measured / (kAreas - 1);
    ours.push_back(std::abs(left_out_figures(area, kFittedStiffness, {}, kSeeds, kJobs).ra / measured - 1.0));
    others.push_back(std::abs(mean / measured - 1.0));
    still.push_back(std::abs(
        area_surface(cut_of_case(kPublished.at(area).of_case), {}, 0.0, 1, kJobs).figures.ra / measured - 1.0));
  }
  const auto median = [](std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return 0.5 * (values[2] + values[3]);
  };
  EXPECT_LE(median(ours), 0.10);
  EXPECT_LT(median(ours), median(others));
  EXPECT_LT(median(ours), median(still));
}

}  // namespace
}  // namespace stillcut::surface_study
