#include "models/confidence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "dsp/numbers.hpp"
#include "stability_cases.hpp"
#include "tests/sanitized.hpp"

namespace stillcut {
namespace {

struct BandCell : test::RobotCell {
  std::vector<Mode> modes = test::robot_modes();
  std::vector<double> speeds = equally_spaced_speeds(spindle.min_speed, spindle.max_speed, test::kSanitized ? 2 : 7);
  // The zeroth order is fast and, like every linear theory, knows depth only as depth times force coefficient.
  LobeSettings settings{.method = LobeMethod::zeroth_order, .max_depth = 1.0};

  std::vector<DepthLimit> nominal() const { return depth_limits(tool, material, cut, modes, speeds, settings); }
  std::vector<DepthBand> bands(const Tolerance& tolerance, const Confidence& confidence) const {
    return depth_bands(tool, material, cut, modes, speeds, settings, tolerance, confidence);
  }
};

const Tolerance kExact{{0.0, 0.0, 0.0}, 0.0};

// Points of the standard normal distribution, from tables.
struct NormalPoint {
  double probability, z;
};
constexpr NormalPoint kNormal[] = {
    {0.5, 0.0}, {0.8, 0.8416212335729143}, {0.9, 1.2815515655446004}, {0.95, 1.6448536269514722}};

TEST(Confidence, UncertainMaterialAloneFollowsTheClosedForm) {
  // The limit is inversely proportional to the coefficients, so it is lognormal: a exp(-+ sigma z).
  const BandCell cell;
  const auto nominal = cell.nominal();
  for (const double deviation : {0.02, 0.3}) {
    Tolerance tolerance = kExact;
    tolerance.ktc = deviation;
    const double sigma = std::sqrt(std::log(1.0 + deviation * deviation));
    for (const auto& [probability, z] : kNormal) {
      const auto bands = cell.bands(tolerance, {.probability = probability, .samples = 100});
      for (std::size_t i = 0; i < bands.size(); ++i) {
        EXPECT_NEAR(bands[i].low, nominal[i].depth * std::exp(-sigma * z), 3e-3 * nominal[i].depth);
        EXPECT_NEAR(bands[i].high, nominal[i].depth * std::exp(sigma * z), 3e-3 * nominal[i].depth);
      }
    }
  }
}

TEST(Confidence, TheFloquetSolutionHasTheSameBand) {
  BandCell cell;
  cell.speeds = {rpm_to_rad_s(3200)};
  cell.settings = {.method = LobeMethod::floquet, .max_depth = 0.02};
  Tolerance tolerance = kExact;
  tolerance.ktc = 0.1;
  const auto bands = cell.bands(tolerance, {.probability = 0.9, .samples = 21});
  const double expected = cell.nominal()[0].depth * std::exp(-kNormal[2].z * std::sqrt(std::log(1.01)));
  EXPECT_NEAR(bands[0].low, expected, 2e-3 * expected);
}

TEST(Confidence, BandShrinksToTheLimitAsEverythingGetsKnown) {
  const BandCell cell;
  const auto nominal = cell.nominal();
  std::vector<double> widths;
  for (const double scale : {1.0, 0.1, 0.01, 0.0}) {
    const Tolerance tolerance{{0.03 * scale, 0.2 * scale, 0.1 * scale}, 0.1 * scale};
    const auto bands = cell.bands(tolerance, {.samples = 60});
    double width = 0.0, distance = 0.0;
    for (std::size_t i = 0; i < bands.size(); ++i) {
      width += bands[i].high / bands[i].low - 1.0;
      distance = std::max({distance, std::abs(bands[i].low / nominal[i].depth - 1.0),
                           std::abs(bands[i].high / nominal[i].depth - 1.0)});
    }
    if (!widths.empty()) {
      EXPECT_LT(width, widths.back());
    }
    widths.push_back(width);
    if (scale <= 0.01) {
      EXPECT_LT(distance, 10.0 * scale + 1e-12);
    }
  }
}

TEST(Confidence, MoreConfidenceAsksForLessDepth) {
  const BandCell cell;
  std::vector<DepthBand> last;
  for (const double probability : {0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99}) {
    const auto bands = cell.bands({}, {.probability = probability, .samples = 60});
    for (std::size_t i = 0; i < bands.size(); ++i) {
      EXPECT_LE(bands[i].low, bands[i].high);
      if (last.empty()) continue;
      EXPECT_LE(bands[i].low, last[i].low);
      EXPECT_GE(bands[i].high, last[i].high);
    }
    last = bands;
  }
}

TEST(Confidence, EachFigureHasItsDeviationAndItsMedian) {
  const BandCell cell;
  const Tolerance tolerance{{0.03, 0.2, 0.1}, 0.15};
  const auto cells = sample_cells(cell.material, cell.modes, tolerance, 2000, 7);
  ASSERT_EQ(cells.size(), 2000u);
  const auto check = [&](double nominal, double deviation, auto&& figure) {
    std::vector<double> values;
    for (const UncertainCell& sample : cells) values.push_back(figure(sample) / nominal);
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / 2000.0;
    double square = 0.0;
    for (const double value : values) square += (value - mean) * (value - mean) / 2000.0;
    EXPECT_NEAR(std::sqrt(square) / mean, deviation, 0.02 * deviation);
    std::sort(values.begin(), values.end());
    EXPECT_NEAR(values[1000], 1.0, 1e-3);
  };
  check(cell.material.ktc, 0.15, [](const UncertainCell& sample) { return sample.material.ktc; });
  for (std::size_t m = 0; m < cell.modes.size(); ++m) {
    check(cell.modes[m].natural_frequency, 0.03, [m](const auto& sample) { return sample.modes[m].natural_frequency; });
    check(cell.modes[m].damping_ratio, 0.2, [m](const auto& sample) { return sample.modes[m].damping_ratio; });
    check(cell.modes[m].stiffness, 0.1, [m](const auto& sample) { return sample.modes[m].stiffness; });
  }
  for (const UncertainCell& sample : cells) {
    EXPECT_NEAR(sample.material.krc / sample.material.ktc, 3.0 / 8.0, 1e-12);
    for (std::size_t m = 0; m < cell.modes.size(); ++m) {
      EXPECT_EQ(sample.modes[m].direction, cell.modes[m].direction);
      EXPECT_LT(sample.modes[m].damping_ratio, 1.0);
    }
  }
}

TEST(Confidence, TheSameQuestionHasTheSameAnswer) {
  const BandCell cell;
  const auto first = cell.bands({}, {.samples = 40}), second = cell.bands({}, {.samples = 40});
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].low, second[i].low);
    EXPECT_EQ(first[i].high, second[i].high);
  }
}

TEST(DepthQuantile, HoldsForSpeedsWithoutALimit) {
  EXPECT_EQ(depth_quantile({kInfinity, kInfinity, kInfinity}, 0.05), kInfinity);
  EXPECT_EQ(depth_quantile({kNaN, kNaN, kNaN}, 0.95), 0.0);
  EXPECT_EQ(depth_quantile({1e-3, kInfinity}, 0.5), 1e-3);  // in doubt the smaller
  EXPECT_EQ(depth_quantile({kNaN, 1e-3}, 0.5), 0.0);
  EXPECT_NEAR(depth_quantile({1e-3, 4e-3}, 0.5), 2e-3, 1e-15);
  EXPECT_EQ(depth_quantile({3e-3, 1e-3, 2e-3}, 0.0), 1e-3);
  EXPECT_EQ(depth_quantile({3e-3, 1e-3, 2e-3}, 1.0), 3e-3);
}

TEST(Confidence, RefusesWhatItCannotAnswer) {
  const BandCell cell;
  EXPECT_THROW(cell.bands({}, {.probability = 0.4}), std::invalid_argument);
  EXPECT_THROW(cell.bands({}, {.probability = 0.999}), std::invalid_argument);
  EXPECT_THROW(cell.bands({}, {.probability = 0.95, .samples = 5}), std::invalid_argument);
  EXPECT_THROW(cell.bands({{-0.1, 0.1, 0.1}, 0.1}, {}), std::invalid_argument);
  EXPECT_THROW(cell.bands({{0.1, 0.1, 1.0}, 0.1}, {}), std::invalid_argument);
  EXPECT_THROW(sample_cells(cell.material, cell.modes, {}, 0, 1), std::invalid_argument);
}

}  // namespace
}  // namespace stillcut
