// The shipped maps of the case study against what Tunc and Stoddart (2017) print, and the tools that made them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "drivers/files/dynamics_map_file.hpp"
#include "tests/case_study/coarse_lobes.hpp"
#include "tests/case_study/cut_verdicts.hpp"
#include "tests/case_study/differential_evolution.hpp"
#include "tests/case_study/plate.hpp"
#include "tests/case_study/plate_study.hpp"
#include "tests/case_study/pocket_map.hpp"
#include "tests/case_study/slender_map.hpp"
#include "tests/case_study/slender_study.hpp"
#include "tools/cell_posture.hpp"

namespace stillcut::case_study {
namespace {

using ::testing::AllOf, ::testing::Ge, ::testing::Le;

const std::string kPocketCell = EXAMPLES "/hexapod-pocket/cell.toml",
                  kSlenderCell = EXAMPLES "/hexapod-slender/cell.toml";

std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  EXPECT_TRUE(in) << file;
  return {std::istreambuf_iterator<char>(in), {}};
}

// Fails where a parameter, its equation or the CSV is changed without the other.
TEST(CaseStudyMap, IsWhatTheFitProgramWritesForItsStoredParameters) {
  const auto folder = std::filesystem::temp_directory_path() / ("case-study-" + std::to_string(getpid()));
  write_dynamics_map(folder / "hexapod-pocket/map", pocket_map(kFittedPocket));
  write_dynamics_map(folder / "hexapod-slender/map", slender_map());
  for (const std::string name : {"hexapod-pocket/map/", "hexapod-slender/map/"}) {
    EXPECT_EQ(content_of(folder / name / "modes.csv"), content_of(EXAMPLES "/" + name + "modes.csv"));
    EXPECT_EQ(content_of(folder / name / "postures.csv"), content_of(EXAMPLES "/" + name + "postures.csv"));
  }
  std::filesystem::remove_all(folder);
}

// Fails with a 13th number, a number out of its range, or modes outside of what the paper prints.
TEST(CaseStudyMap, HasTwelveNumbersAtMostAndThePrintedModes) {
  constexpr int kByHand = 1;  // the tool's mean frequency
  static_assert(kPocketParameters + kByHand <= 12);
  for (std::size_t i = 0; i < kPocketParameters; ++i)
    EXPECT_THAT(kFittedPocket[i], AllOf(Ge(kPocketRanges[i].low), Le(kPocketRanges[i].high))) << kPocketRanges[i].name;
  const DynamicsMap map = read_cell_dynamics(read_cell(kPocketCell)).map;
  ASSERT_EQ(map.postures.size(), 49U);
  for (const Posture& posture : map.postures) {
    ASSERT_EQ(posture.modes.size(), 4U);
    const auto hz = [&](std::size_t mode) { return posture.modes[mode].natural_frequency / kTwoPi; };
    EXPECT_THAT(hz(0), AllOf(Ge(50.0 - 1e-9), Le(60.0 + 1e-9)));
    EXPECT_THAT(hz(1), AllOf(Ge(120.0 - 1e-9), Le(130.0 + 1e-9)));
    EXPECT_THAT(hz(2), AllOf(Ge(450.0), Le(520.0)));
    EXPECT_THAT(hz(3), AllOf(Ge(450.0), Le(520.0)));
    EXPECT_EQ(posture.modes[0].direction[0], 1.0);
    EXPECT_EQ(posture.modes[1].direction[1], 1.0);
  }
}

// Fails where the map, the projection, zeroth order or the index moves a figure by more than a tenth.
TEST(CaseStudyTable1, ComesOutByThePapersProjection) {
  const Cell cell = read_cell(kPocketCell);
  const DynamicsMap map = read_cell_dynamics(cell).map;
  const std::vector<double> directions{0, 15, 30, 35, 40, 45, 50, 55, 60, 75, 90};
  const PlateFigures ours =
      plate_figures(plate_limits(cell, map, DirectionMethod::paper, directions, 51, 2, [](double) {}));
  for (std::size_t i = 0; i < kPatterns; ++i) {
    EXPECT_NEAR(ours.table[i].min_mm, kTable1[i].min_mm, 0.1 * kTable1[i].min_mm) << kPatternNames[i];
    EXPECT_NEAR(ours.table[i].max_mm, kTable1[i].max_mm, 0.1 * kTable1[i].max_mm) << kPatternNames[i];
    EXPECT_NEAR(ours.table[i].asi_percent, kTable1[i].asi_percent, 0.1 * kTable1[i].asi_percent) << kPatternNames[i];
  }
  // Equal only where the paper's are.
  constexpr int kRanking[] = {0, 1, 3, 2};
  for (std::size_t rank = 0; rank + 1 < 4; ++rank) {
    const PatternFigures &better = ours.table[static_cast<std::size_t>(kRanking[rank])],
                         &worse = ours.table[static_cast<std::size_t>(kRanking[rank + 1])];
    EXPECT_GT(better.asi_percent, worse.asi_percent) << rank;
    EXPECT_GT(better.min_mm, worse.min_mm) << rank;
    if (rank == 1) {
      EXPECT_GE(better.max_mm, worse.max_mm) << rank;
    } else {
      EXPECT_GT(better.max_mm, worse.max_mm) << rank;
    }
  }
  EXPECT_THAT(ours.best_zig_deg, AllOf(Ge(kBestZigLow_deg), Le(kBestZigHigh_deg)));
  // "About 50 %": Table 1 itself has 0.147/0.105 = 1.40. "About 100 %": the cuts it rests on have steps of that size.
  EXPECT_THAT(ours.absolute_gain, AllOf(Ge(1.3), Le(1.7)));
  EXPECT_THAT(ours.pocket_gain, AllOf(Ge(1.7), Le(2.4)));
}

// Fails where the search's quick lobes leave those that judge its result.
TEST(CaseStudySearch, ItsQuickLobesAreThoseOfTheModels) {
  const Cell cell = read_cell(kPocketCell);
  DynamicsMap map = read_cell_dynamics(cell).map;
  map.postures = {map.postures[0], map.postures[kCentre], map.postures[46]};
  const std::vector<double> directions{0, 45, 90};
  const PlateLimits exact = plate_limits(cell, map, DirectionMethod::paper, directions, 41, 1, [](double) {});
  const LinearCut cut = linear_cut(*cell.tool, *cell.material, *cell.cut);
  for (std::size_t p = 0; p < map.postures.size(); ++p) {
    const DirectReceptance receptance = direct_receptance(map.postures[p].modes);
    for (std::size_t d = 0; d < directions.size(); ++d) {
      const double wanted = absolute_limit(exact.points[p][d]);
      const double got = absolute_limit(coarse_paper_limits(cut, receptance, deg_to_rad(directions[d]), exact.speeds));
      EXPECT_NEAR(got, wanted, 0.03 * wanted) << p << ' ' << directions[d];
    }
  }
}

// Fails where the search stalls, or where threads change what it finds.
TEST(CaseStudySearch, FindsAValleyAndTheSameOnAnyNumberOfThreads) {
  Search search;
  search.bounds = {{-2.0, 2.0}, {-1.0, 3.0}};
  search.population = 24;
  search.generations = 120;
  const auto valley = [](std::span<const double> x) {
    return 100.0 * std::pow(x[1] - x[0] * x[0], 2) + std::pow(1.0 - x[0], 2);
  };
  const auto ignore = [](int, const Found&) {};
  const Found one = minimum(search, valley, ignore);
  EXPECT_NEAR(one.at[0], 1.0, 1e-3);
  EXPECT_NEAR(one.at[1], 1.0, 1e-3);
  search.jobs = 3;
  EXPECT_EQ(minimum(search, valley, ignore).at, one.at);
  search.seed = 2;
  EXPECT_NE(minimum(search, valley, ignore).at, one.at);
}

// Fails where a diagonal goes to another side, or the numbering runs along Y.
TEST(CaseStudyPlate, FeedsAlongTheNearestSide) {
  const std::vector<PlatePoint> points = plate_points();
  ASSERT_EQ(points.size(), 49U);
  EXPECT_EQ(std::count_if(points.begin(), points.end(), [](const PlatePoint& p) { return p.periphery_deg == 0.0; }),
            25);
  EXPECT_EQ(points[1].x, 0.05);
  EXPECT_EQ(points[1].y, 0.0);
  EXPECT_EQ(points[0].periphery_deg, 0.0);    // the bottom begins here
  EXPECT_EQ(points[6].periphery_deg, 90.0);   // and the right side here
  EXPECT_EQ(points[48].periphery_deg, 0.0);   // the top
  EXPECT_EQ(points[42].periphery_deg, 90.0);  // the left side
  EXPECT_EQ(points[kCentre - 1].periphery_deg, 90.0);
  EXPECT_EQ(points[kCentre - 7].periphery_deg, 0.0);
}

// Fails where milling in time and Floquet, which share no solver, part company on the middle of the plate; so also
// where the limits, the feed direction or the verdict in time are wrong.
TEST(CaseStudyTable2, FloquetAndMillingInTimeSayTheSameAwayFromTheLimit) {
  const Cell cell = read_cell(kPocketCell);
  const std::vector<Mode> modes = read_cell_dynamics(cell).map.postures[kCentre].modes;
  int compared = 0;
  for (const CutOfTable2& cut : kTable2) {
    const CutVerdict floquet = judge_cut(cell, modes, cut, Judge::floquet);
    if (floquet.marginal) continue;
    const CutVerdict time = judge_cut(cell, modes, cut, Judge::time);
    EXPECT_EQ(floquet.chatters, time.chatters) << cut.feed_direction_deg << ' ' << cut.depth_mm << ' ' << cut.speed_rpm;
    EXPECT_EQ(time.chatters, std::isfinite(time.chatter_hz));
    ++compared;
  }
  EXPECT_GE(compared, 3);
}

TEST(CaseStudyTable2, AMarginalCutIsMetOnlyNearTheLimit) {
  const CutVerdict deep{true, false, 500.0}, near{true, true, 500.0}, sound{false, false, 0.0};
  EXPECT_TRUE(agrees(Verdict::unstable, deep));
  EXPECT_TRUE(agrees(Verdict::unstable, near));
  EXPECT_FALSE(agrees(Verdict::unstable, sound));
  EXPECT_TRUE(agrees(Verdict::stable, sound));
  EXPECT_FALSE(agrees(Verdict::stable, near));
  EXPECT_TRUE(agrees(Verdict::near_limit, near));
  EXPECT_FALSE(agrees(Verdict::near_limit, deep));
}

// Fails where the map's peaks, the projection or the limits move away from the figures' words.
TEST(CaseStudySlenderTool, HasTheRatiosAndDirectionsOfTheFigures) {
  const Cell cell = read_cell(kSlenderCell);
  const DynamicsMap map = read_cell_dynamics(cell).map;
  ASSERT_EQ(map.postures.size(), 30U);
  const auto at = [&](int position) { return map.postures[static_cast<std::size_t>(position - 1)].modes; };
  EXPECT_NEAR(peak_ratio(at(1)), 2.0, 0.05);
  EXPECT_NEAR(peak_ratio(at(21)), 3.0, 0.05);
  EXPECT_EQ(least_peak_deg(at(25)), 40.0);
  EXPECT_EQ(least_peak_deg(at(1)), 90.0);  // not 0 as printed: there |G_f| is |G_xx|, twice |G_yy|
  const CommonLobes lobes = common_lobes(cell, at(1), 201);
  EXPECT_NEAR(lobes.speed_rpm, 5000.0, 150.0);
  EXPECT_GT(lobes.depth_mm, 2.0 * lobes.absolute_mm);
}

// Fails where posture or radial depth no longer move the optimum.
TEST(CaseStudySlenderTool, ItsBestDirectionMovesWithPositionAndRadialDepth) {
  const Cell cell = read_cell(kSlenderCell);
  DynamicsMap map = read_cell_dynamics(cell).map;
  map.postures = {map.postures[0], map.postures[20], map.postures[24]};
  std::vector<SlenderFigures> figures;
  for (const double share : kRadialShares) figures.push_back(slender_figures(cell, map, share, 61, 1, [](double) {}));
  EXPECT_EQ(figures[1].best_deg[0], 90.0);  // position 1 at half immersion
  EXPECT_NEAR(figures[1].best_mm[0], 0.6, 0.06);
  EXPECT_NE(figures[1].best_deg[0], figures[1].best_deg[1]);
  EXPECT_NE(figures[1].best_deg[0], figures[1].best_deg[2]);
  EXPECT_NE(figures[0].best_deg[2], figures[1].best_deg[2]);
  EXPECT_NE(figures[1].best_deg[2], figures[2].best_deg[2]);
}

}  // namespace
}  // namespace stillcut::case_study
