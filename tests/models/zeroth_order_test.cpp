#include "models/zeroth_order.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "models/floquet.hpp"
#include "models/lobes.hpp"
#include "stability_cases.hpp"

namespace stillcut {
namespace {

using test::cut_of, test::mode_of, test::random_case, test::reference_case;
using Complex = std::complex<double>;

TEST(ZerothOrder, DirectionalCoefficientsAreThoseOfAltintas) {
  const LinearCut cut = cut_of(3, Milling::down, 0.3, 8e8, 2e8);
  const double kr = cut.krc / cut.ktc;
  const auto bracket = [&](const auto& function) {
    return 0.5 * (function(cut.immersion.exit) - function(cut.immersion.entry));
  };
  const double xx = bracket([&](double p) { return std::cos(2 * p) - 2 * kr * p + kr * std::sin(2 * p); });
  const double xy = bracket([&](double p) { return -std::sin(2 * p) - 2 * p + kr * std::cos(2 * p); });
  const double yx = bracket([&](double p) { return -std::sin(2 * p) + 2 * p + kr * std::cos(2 * p); });
  const double yy = bracket([&](double p) { return -std::cos(2 * p) - 2 * kr * p - kr * std::sin(2 * p); });
  const DirectionMatrix integral = cutting_stiffness_integral(cut, cut.immersion.entry, cut.immersion.exit);
  EXPECT_NEAR(-2.0 / cut.ktc * integral(0, 0), xx, 1e-12);
  EXPECT_NEAR(-2.0 / cut.ktc * integral(0, 1), xy, 1e-12);
  EXPECT_NEAR(-2.0 / cut.ktc * integral(1, 0), yx, 1e-12);
  EXPECT_NEAR(-2.0 / cut.ktc * integral(1, 1), yy, 1e-12);
}

TEST(ZerothOrder, LobesOfOneModeFollowTheClosedForm) {
  // One mode in x: the only eigenvalue is alpha_xx G(w), so a(w) and every lobe's speed are known outright.
  const LinearCut cut = cut_of(2, Milling::down, 0.5, 6e8, 2e8);
  const std::vector<Mode> modes{mode_of(500, 0.03, 1e7, 1, 0)};
  const double alpha = -2.0 / cut.ktc * cutting_stiffness_integral(cut, cut.immersion.entry, cut.immersion.exit)(0, 0);
  int checked = 0;
  for (const double ratio : {0.7, 0.9, 0.95, 0.98, 1.02, 1.05, 1.1, 1.4}) {
    const double frequency = ratio * modes[0].natural_frequency;
    const Complex g = 1.0 / (1e7 * Complex(1.0 - ratio * ratio, 2.0 * 0.03 * ratio));
    const Complex lambda = -1.0 / (alpha * g);
    const double kappa = lambda.imag() / lambda.real();
    const double depth = -kTwoPi * lambda.real() / (cut.teeth * cut.ktc) * (1.0 + kappa * kappa);
    if (depth <= 0.0) continue;
    double phase = std::numbers::pi - 2.0 * std::atan2(lambda.imag(), lambda.real());
    phase -= kTwoPi * std::floor(phase / kTwoPi);
    for (int lobe = 0; lobe < 3; ++lobe) {
      const double period = (phase + lobe * kTwoPi) / frequency;
      // The closing condition itself: with this period and depth 1 + Lambda0 alpha G = 0.
      const Complex closing = 1.0 - 0.5 * depth * cut.ktc * cut.teeth / kTwoPi *
                                        (1.0 - std::exp(Complex(0, -frequency * period))) * alpha * g;
      EXPECT_LT(std::abs(closing), 1e-9);
      const double speeds[] = {kTwoPi / (cut.teeth * period)};
      const DepthLimit limit = zeroth_order_limits(cut, modes, speeds, 1.0).front();
      EXPECT_LE(limit.depth, depth * (1.0 + 1e-6));  // another lobe may lie lower
      if (std::abs(limit.depth / depth - 1.0) < 1e-6) {
        EXPECT_NEAR(limit.chatter_frequency, frequency, 1e-5 * frequency);
        ++checked;
      }
    }
  }
  EXPECT_GE(checked, 5);
}

TEST(ZerothOrder, ReachesTheAbsoluteLimitOfOneMode) {
  // min over w of -1/Re(alpha G) gives a = 8 pi k zeta (1 + zeta) / (N ktc |alpha_xx|), or 1 - zeta where
  // alpha_xx is positive and the receptance's largest real part counts.
  const LinearCut cut = cut_of(2, Milling::down, 0.5, 6e8, 2e8);
  const std::vector<Mode> modes{mode_of(500, 0.03, 1e7, 1, 0)};
  const double alpha = -2.0 / cut.ktc * cutting_stiffness_integral(cut, cut.immersion.entry, cut.immersion.exit)(0, 0);
  const double zeta = 0.03;
  const double expected = alpha < 0 ? 8 * std::numbers::pi * 1e7 * zeta * (1 + zeta) / (cut.teeth * cut.ktc * -alpha)
                                    : 8 * std::numbers::pi * 1e7 * zeta * (1 - zeta) / (cut.teeth * cut.ktc * alpha);
  double lowest = std::numeric_limits<double>::infinity();
  const auto speeds = equally_spaced_speeds(rpm_to_rad_s(4000), rpm_to_rad_s(12000), 1001);
  for (const DepthLimit& limit : zeroth_order_limits(cut, modes, speeds, 1.0)) lowest = std::min(lowest, limit.depth);
  EXPECT_NEAR(lowest, expected, 1e-4 * expected);
}

TEST(ZerothOrder, AgreesWithFloquetWhenManyTeethMakeTheCutSteady) {
  // A slot with eight teeth: the summed cutting stiffness does not depend on the angle, so the mean is the whole truth.
  const LinearCut cut = cut_of(8, Milling::slot, 1.0, 8e8, 3e8);
  const std::vector<Mode> modes{mode_of(500, 0.03, 2e7, 1, 0), mode_of(430, 0.04, 1.5e7, 0.6, 0.8)};
  const auto speeds = equally_spaced_speeds(rpm_to_rad_s(1500), rpm_to_rad_s(9000), 26);
  const auto limits = zeroth_order_limits(cut, modes, speeds, 0.02);
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    const DepthLimit exact = floquet_depth_limit(cut, modes, speeds[i], {});
    EXPECT_NEAR(limits[i].depth, exact.depth, 1e-5 * exact.depth) << rad_s_to_rpm(speeds[i]) << " rpm";
  }
}

TEST(ZerothOrder, SeesNoFlipLobeAndIsFarOffOnARobot) {
  const auto [cut, modes] = reference_case("c_feed45", 0.5, Milling::down);
  const double speeds[] = {rpm_to_rad_s(3400)};
  const double first_look = zeroth_order_limits(cut, modes, speeds, 0.02).front().depth;
  const double converged = floquet_depth_limit(cut, modes, speeds[0], {}).depth;
  EXPECT_GT(std::abs(first_look / converged - 1.0), 0.3);
}

TEST(ZerothOrder, LimitsAreInfiniteAboveTheLargestDepth) {
  const auto [cut, modes] = reference_case("a", 0.05, Milling::down);
  const double speeds[] = {rpm_to_rad_s(9000)};
  const double depth = zeroth_order_limits(cut, modes, speeds, 1.0).front().depth;
  ASSERT_TRUE(std::isfinite(depth));
  EXPECT_EQ(zeroth_order_limits(cut, modes, speeds, 0.5 * depth).front().depth,
            std::numeric_limits<double>::infinity());
}

TEST(ZerothOrder, RefusesSpeedsThatAreNotPositive) {
  const auto [cut, modes] = reference_case("a", 0.5, Milling::down);
  const double zero[] = {0.0}, negative[] = {-1.0};
  EXPECT_THROW(zeroth_order_limits(cut, modes, zero, 0.02), std::invalid_argument);
  EXPECT_THROW(zeroth_order_limits(cut, modes, negative, 0.02), std::invalid_argument);
}

}  // namespace
}  // namespace stillcut
