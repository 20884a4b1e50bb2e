#include "models/floquet.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "models/zeroth_order.hpp"
#include "stability_cases.hpp"

namespace stillcut {
namespace {

using test::cut_of, test::mode_of, test::random_case, test::read_table, test::reference_case;

Milling milling_named(const std::string& name) { return name == "up" ? Milling::up : Milling::down; }

TEST(Floquet, SpectralRadiusAgreesWithEveryReferencePoint) {
  const auto rows = read_table("spectral_radius.csv");
  ASSERT_EQ(rows.size(), 56u);
  for (const auto& row : rows) {
    const auto [cut, modes] = reference_case(row[0], std::stod(row[1]), milling_named(row[2]));
    const double expected = std::stod(row[5]);
    const FloquetPoint point = floquet_point(cut, modes, rpm_to_rad_s(std::stod(row[3])), std::stod(row[4]));
    EXPECT_NEAR(point.spectral_radius, expected, 1e-6 * std::max(1.0, expected))
        << row[0] << ' ' << row[1] << ' ' << row[2] << ' ' << row[3] << " rpm";
    EXPECT_LT(point.error_estimate, 1e-6 * std::max(1.0, expected));
    EXPECT_DOUBLE_EQ(point.period, 60.0 / (2.0 * std::stod(row[3])));
  }
}

void expect_reference_limits(const std::string& table, const std::string& name) {
  std::vector<double> errors;
  for (const auto& row : read_table(table)) {
    const auto [cut, modes] = reference_case(name, std::stod(row[0]), milling_named(row[1]));
    const DepthLimit limit = floquet_depth_limit(cut, modes, rpm_to_rad_s(std::stod(row[2])), {});
    const double expected =
        row.size() > 3 && !row[3].empty() ? std::stod(row[3]) : std::numeric_limits<double>::infinity();
    errors.push_back(limit.depth == expected ? 0.0 : std::abs(limit.depth / expected - 1.0));
    EXPECT_LT(errors.back(), 1e-4) << row[0] << " at " << row[2] << " rpm";
  }
  ASSERT_GT(errors.size(), 20u);
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 1e-5);
}

TEST(Floquet, DepthLimitAgreesWithTheReferenceForOneMode) { expect_reference_limits("one_mode_down.csv", "a"); }
TEST(Floquet, DepthLimitAgreesWithTheReferenceForTwoModes) { expect_reference_limits("two_modes_down.csv", "b"); }

TEST(Floquet, RadiusIsOneAtTheLimitAndRisesAcrossIt) {
  std::mt19937_64 random(11);
  int finite = 0;
  for (int i = 0; i < 30; ++i) {
    const auto [cut, modes] = random_case(random);
    const double speed = rpm_to_rad_s(std::uniform_real_distribution<>(1500, 12000)(random));
    const DepthLimit limit = floquet_depth_limit(cut, modes, speed, {});
    if (!std::isfinite(limit.depth)) continue;
    ++finite;
    EXPECT_NEAR(floquet_point(cut, modes, speed, limit.depth).spectral_radius, 1.0, 1e-5);
    EXPECT_LT(floquet_point(cut, modes, speed, 0.999 * limit.depth).spectral_radius, 1.0);
    EXPECT_GT(floquet_point(cut, modes, speed, 1.001 * limit.depth).spectral_radius, 1.0);
    EXPECT_LE(limit.error_estimate, 1e-4);
  }
  EXPECT_GT(finite, 15);
}

TEST(Floquet, WithoutDepthTheSlowestDecayingModeRemains) {
  const std::vector<Mode> modes{mode_of(300, 0.02, 1e7, 1, 0), mode_of(60, 0.05, 5e6, 0, 1)};
  const double speed = rpm_to_rad_s(4000), period = 60.0 / (3 * 4000.0);
  const FloquetPoint point = floquet_point(cut_of(3, Milling::slot, 1.0, 8e8, 3e8), modes, speed, 0.0);
  EXPECT_NEAR(point.spectral_radius, std::exp(-0.05 * kTwoPi * 60 * period), 1e-12);
}

TEST(Floquet, ModesAcrossTheCuttingPlaneNeverChatter) {
  const std::vector<Mode> modes{mode_of(200, 0.02, 1e5, 0, 0, 1)};
  const DepthLimit limit = floquet_depth_limit(cut_of(2, Milling::down, 0.5, 8e8, 3e8), modes, rpm_to_rad_s(3000), {});
  EXPECT_EQ(limit.depth, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(limit.chatter_frequency));
}

TEST(Floquet, FlipLobesVibrateAtHalfTheToothFrequencyFamily) {
  const auto [cut, modes] = reference_case("c_feed45", 0.5, Milling::down);
  const DepthLimit limit = floquet_depth_limit(cut, modes, rpm_to_rad_s(3400), {});
  ASSERT_EQ(limit.instability, Instability::flip);
  const double tooth_frequency = 2 * 3400.0 / 60.0;
  EXPECT_NEAR(limit.chatter_frequency / kTwoPi, 0.5 * tooth_frequency, 1e-6);  // nearest the 55 Hz mode
}

TEST(Floquet, HopfFrequencyLiesNearASingleMode) {
  const auto [cut, modes] = reference_case("a", 0.5, Milling::down);
  const DepthLimit limit = floquet_depth_limit(cut, modes, rpm_to_rad_s(9000), {});
  EXPECT_EQ(limit.instability, Instability::hopf);
  EXPECT_NEAR(limit.chatter_frequency / kTwoPi, 922.0, 60.0);
}

TEST(Floquet, HelixOverWholeAxialPitchesMakesTheCutSteadyAndZerothOrderExact) {
  // Where the edge's lag is a whole pitch, one tooth leaves as the next follows: the summed stiffness does not depend
  // on the angle. The lag is chosen so that this happens just at the limit depth.
  auto [cut, modes] = reference_case("b", 0.5, Milling::down);
  const double speeds[] = {rpm_to_rad_s(8000)};
  const double depth = zeroth_order_limits(cut, modes, speeds, 0.02).front().depth;
  ASSERT_TRUE(std::isfinite(depth));
  cut.lag_per_depth = kTwoPi / cut.teeth / depth;
  EXPECT_NEAR(floquet_point(cut, modes, speeds[0], depth).spectral_radius, 1.0, 1e-5);
}

TEST(Floquet, ProcessDampingLiftsTheLimitOfASlowMode) {
  auto [cut, modes] = reference_case("c_feed0", 0.5, Milling::down);
  const double speed = rpm_to_rad_s(3000);
  const double plain = floquet_depth_limit(cut, modes, speed, {}).depth;
  cut.process_damping = 2e5;
  EXPECT_GT(floquet_depth_limit(cut, modes, speed, {}).depth, 1.02 * plain);
}

TEST(Floquet, RefusesWhatIsNotACut) {
  const auto [cut, modes] = reference_case("a", 0.5, Milling::down);
  EXPECT_THROW(floquet_point(cut, modes, 0.0, 1e-3), std::invalid_argument);
  EXPECT_THROW(floquet_point(cut, modes, -100.0, 1e-3), std::invalid_argument);
  EXPECT_THROW(floquet_point(cut, modes, 1e-3, 1e-3), std::invalid_argument);  // hours to a turn
  EXPECT_THROW(floquet_point(cut, modes, 100.0, -1e-3), std::invalid_argument);
  EXPECT_THROW(floquet_point(cut, modes, 100.0, std::nan("")), std::invalid_argument);
  EXPECT_THROW(floquet_point(cut, {}, 100.0, 1e-3), std::invalid_argument);
  EXPECT_THROW(floquet_depth_limit(cut, modes, 100.0, {.max_depth = 0.0}), std::invalid_argument);
  for (Mode bad : {mode_of(0, 0.02, 1e7, 1, 0), mode_of(100, 0.0, 1e7, 1, 0), mode_of(100, 1.0, 1e7, 1, 0),
                   mode_of(100, 0.02, 0.0, 1, 0), mode_of(100, 0.02, 1e7, 0, 0)}) {
    EXPECT_THROW(floquet_point(cut, std::vector<Mode>{bad}, 100.0, 1e-3), std::invalid_argument);
  }
}

}  // namespace
}  // namespace stillcut
