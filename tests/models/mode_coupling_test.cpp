#include "models/mode_coupling.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <limits>
#include <stdexcept>

#include "models/eigenvalues.hpp"
#include "stability_cases.hpp"
#include "tests/sanitized.hpp"

namespace stillcut {
namespace {

using test::cut_of;
using test::mode_of;

// Two to six structural modes between 8 and 25 Hz in any direction, any immersion.
test::StabilityCase random_robot(std::mt19937_64& random) {
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  test::StabilityCase robot;
  robot.cut = cut_of(std::uniform_int_distribution<int>(1, 4)(random),
                     static_cast<Milling>(std::uniform_int_distribution<int>(1, 3)(random)), uniform(0.05, 1.0),
                     uniform(5e8, 1.5e9), uniform(1e8, 5e8));
  robot.cut.kac = uniform(-2e8, 2e8);
  const int count = std::uniform_int_distribution<int>(1, 6)(random);
  for (int i = 0; i < count; ++i) {
    Eigen::Vector3d u(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    u.normalize();
    robot.modes.push_back(mode_of(uniform(8, 25), uniform(0.005, 0.06), uniform(5e5, 5e6), u[0], u[1], u[2]));
  }
  return robot;
}

// The oracle: the same mean cut written out tooth angle by tooth angle, as a first-order system in modal coordinates.
class MeanCut {
 public:
  explicit MeanCut(const test::StabilityCase& robot) : robot_(robot) {
    constexpr int kAngles = 4000;
    const Immersion& arc = robot.cut.immersion;
    const double width = (arc.exit - arc.entry) / kAngles;
    for (int i = 0; i < kAngles; ++i) {
      const double phi = arc.entry + (i + 0.5) * width, s = std::sin(phi), c = std::cos(phi);
      // F_x = -F_t cos - F_r sin, F_y = +F_t sin - F_r cos, F_z = -F_a for a chip of x sin + y cos
      const Eigen::Vector3d force(-robot.cut.ktc * c - robot.cut.krc * s, robot.cut.ktc * s - robot.cut.krc * c,
                                  -robot.cut.kac);
      force_per_displacement_ += robot.cut.teeth * width / kTwoPi * force * Eigen::RowVector3d(s, c, 0.0);
    }
  }

  Eigen::MatrixXd stiffness(double depth) const {  // M^-1 (K - K_process)
    const auto count = static_cast<Eigen::Index>(robot_.modes.size());
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(count, count);
    for (Eigen::Index r = 0; r < count; ++r) {
      const Mode& mode = robot_.modes[static_cast<std::size_t>(r)];
      const double square = mode.natural_frequency * mode.natural_frequency;
      result(r, r) = square;
      for (Eigen::Index s = 0; s < count; ++s)
        result(r, s) -= depth * square / mode.stiffness * direction(r).dot(force_per_displacement_ * direction(s));
    }
    return result;
  }

  Eigen::MatrixXd state_matrix(double depth) const {
    const auto count = static_cast<Eigen::Index>(robot_.modes.size());
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(2 * count, 2 * count);
    result.topRightCorner(count, count).setIdentity();
    result.bottomLeftCorner(count, count) = -stiffness(depth);
    for (Eigen::Index r = 0; r < count; ++r) {
      const Mode& mode = robot_.modes[static_cast<std::size_t>(r)];
      result(count + r, count + r) = -2.0 * mode.damping_ratio * mode.natural_frequency;
    }
    return result;
  }

  std::complex<double> rightmost(double depth) const {
    const Eigen::VectorXcd values = eigenvalues(state_matrix(depth));
    Eigen::Index index;
    values.real().maxCoeff(&index);
    return values[index];
  }

 private:
  Eigen::Vector3d direction(Eigen::Index mode) const {
    return Eigen::Vector3d(robot_.modes[static_cast<std::size_t>(mode)].direction.data());
  }

  const test::StabilityCase& robot_;
  Eigen::Matrix3d force_per_displacement_ = Eigen::Matrix3d::Zero();
};

TEST(ModeCoupling, IsWhereTheStateMatrixTurnsUnstable) {
  std::mt19937_64 random(21);
  int limits = 0, free = 0;
  constexpr int kRobots = test::kSanitized ? 40 : 300;
  for (int i = 0; i < kRobots; ++i) {
    const test::StabilityCase robot = random_robot(random);
    const MeanCut oracle(robot);
    constexpr double kDeepest = 0.02;
    const ModeCouplingLimit limit = mode_coupling_limit(robot.cut, robot.modes, kDeepest);
    const double end = std::min(limit.depth * (1.0 - 1e-4), kDeepest);
    for (int step = 0; step <= 200; ++step) ASSERT_LT(oracle.rightmost(end * step / 200).real(), 0.0) << i;
    if (std::isinf(limit.depth)) {
      EXPECT_TRUE(std::isnan(limit.frequency));
      ++free;
      continue;
    }
    ++limits;
    const std::complex<double> above = oracle.rightmost(limit.depth * (1.0 + 1e-4));
    EXPECT_GT(above.real(), 0.0) << i;
    EXPECT_NEAR(std::abs(above.imag()), limit.frequency, 1e-2 * robot.modes[0].natural_frequency) << i;
  }
  EXPECT_GT(limits, kRobots / 6);
  EXPECT_GT(free, kRobots / 6);
}

// Runge-Kutta over the same equations: the motion dies away below the limit and grows above it, at its frequency.
TEST(ModeCoupling, AgreesWithIntegrationInTime) {
  std::mt19937_64 random(22);
  int met = 0;
  while (met < (test::kSanitized ? 1 : 5)) {
    const test::StabilityCase robot = random_robot(random);
    const ModeCouplingLimit limit = mode_coupling_limit(robot.cut, robot.modes, 0.02);
    if (!std::isfinite(limit.depth) || limit.frequency == 0.0) continue;
    ++met;
    const MeanCut oracle(robot);
    for (const double share : {0.98, 1.02}) {  // close by: some are stable again further up
      const Eigen::MatrixXd a = oracle.state_matrix(share * limit.depth);
      Eigen::VectorXd state = Eigen::VectorXd::Ones(a.rows());
      constexpr double kStep = 1e-3;
      double logarithm = 0.0;
      for (int step = 0; step < 200'000; ++step) {
        const Eigen::VectorXd k1 = a * state, k2 = a * (state + 0.5 * kStep * k1);
        const Eigen::VectorXd k3 = a * (state + 0.5 * kStep * k2), k4 = a * (state + kStep * k3);
        state += kStep / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        if (step % 1000 == 999) {
          if (step > 100'000) logarithm += std::log(state.norm());
          state.normalize();
        }
      }
      EXPECT_EQ(logarithm > 0.0, share > 1.0) << share;
    }
  }
}

// Two modes of one frequency, damping and stiffness: the motion splits along the eigenvectors of the modes' coupling,
// s^2 + 2 zeta w s + w^2 (1 + a m) = 0 with m its complex eigenvalue, and a root on the imaginary axis asks for
// (2 zeta)^2 (1 + a Re m) = (a Im m)^2.
TEST(ModeCoupling, TwoEqualModesAtAnAngleFollowTheClosedForm) {
  for (const double angle_deg : {60.0, 90.0, 120.0}) {
    for (const double damping : {0.005, 0.02, 0.05}) {
      constexpr double kStiffness = 1.5e6;
      test::StabilityCase robot{cut_of(2, Milling::slot, 1.0, 8e8, 1e8), {}};
      for (const double direction : {0.2, 0.2 + deg_to_rad(angle_deg)}) {
        robot.modes.push_back(mode_of(14, damping, kStiffness, std::cos(direction), std::sin(direction)));
      }
      // The mean cut of a slot: both diagonal elements are N k_r/4, the others +-N k_t/4.
      const double r = robot.cut.teeth * robot.cut.krc / 4, t = robot.cut.teeth * robot.cut.ktc / 4;
      Eigen::Matrix2d mean, directions;
      mean << r, t, -t, r;
      EXPECT_LT((mean - mean_cutting_stiffness(robot.cut).topRows<2>()).norm(), 1e-9 * mean.norm());
      directions << std::cos(0.2), std::cos(0.2 + deg_to_rad(angle_deg)), std::sin(0.2),
          std::sin(0.2 + deg_to_rad(angle_deg));
      const Eigen::Matrix2d coupling = directions.transpose() * mean * directions / kStiffness;
      const std::complex<double> m = eigenvalues(coupling)[0];
      ASSERT_GT(std::abs(m.imag()), 0.0);
      const double b = 4.0 * damping * damping, square = m.imag() * m.imag();
      const double depth = (b * m.real() + std::sqrt(b * b * m.real() * m.real() + 4.0 * square * b)) / (2.0 * square);
      const ModeCouplingLimit limit = mode_coupling_limit(robot.cut, robot.modes, 0.1);
      EXPECT_NEAR(limit.depth, depth, 1e-8 * depth);
      EXPECT_NEAR(limit.frequency, robot.modes[0].natural_frequency * std::sqrt(1.0 + depth * m.real()), 1e-5);
      // Without damping equal modes couple at once.
      EXPECT_TRUE(std::isnan(undamped_mode_coupling_limit(robot.cut, robot.modes, 0.1).depth));
    }
  }
}

// Without damping two modes couple where the discriminant of the 2 x 2 matrix passes 0.
TEST(ModeCoupling, UndampedLimitOfTwoModesIsTheRootOfTheirDiscriminant) {
  std::mt19937_64 random(23);
  int met = 0;
  while (met < 50) {
    test::StabilityCase robot = random_robot(random);
    if (robot.modes.size() < 2) continue;
    robot.modes.resize(2);
    const MeanCut oracle(robot);
    const auto discriminant = [&](double depth) {
      const Eigen::Matrix2d a = oracle.stiffness(depth);
      return std::pow(a(0, 0) - a(1, 1), 2) + 4.0 * a(0, 1) * a(1, 0);
    };
    constexpr double kDeepest = 0.02;
    const ModeCouplingLimit limit = undamped_mode_coupling_limit(robot.cut, robot.modes, kDeepest);
    if (!std::isfinite(limit.depth)) continue;
    ++met;
    if (limit.frequency == 0.0) {
      EXPECT_NEAR(oracle.stiffness(limit.depth).determinant() / oracle.stiffness(0.0).determinant(), 0.0, 1e-5);
      continue;
    }
    EXPECT_GT(discriminant(0.999 * limit.depth), 0.0);
    EXPECT_LT(discriminant(1.001 * limit.depth), 0.0);
    const double mean_square = 0.5 * oracle.stiffness(limit.depth).trace();
    EXPECT_NEAR(limit.frequency, std::sqrt(mean_square), 1e-3 * limit.frequency);
  }
}

TEST(ModeCoupling, LooksNoHigherThanAsked) {
  std::mt19937_64 random(25);
  int fast = 0, slow = 0;
  for (int i = 0; i < 100; ++i) {
    test::StabilityCase robot = random_robot(random);
    robot.modes.push_back(mode_of(750, 0.02, 6e6, 1, 0));
    robot.modes.push_back(mode_of(790, 0.02, 6e6, 0, 1));
    constexpr double kDeepest = 0.02, kBelow = kTwoPi * 200.0;
    const ModeCouplingLimit any = mode_coupling_limit(robot.cut, robot.modes, kDeepest);
    const ModeCouplingLimit low = mode_coupling_limit(robot.cut, robot.modes, kDeepest, kBelow);
    const ModeCouplingLimit undamped = undamped_mode_coupling_limit(robot.cut, robot.modes, kDeepest, kBelow);
    if (std::isfinite(undamped.depth)) {
      EXPECT_LE(undamped.frequency, kBelow);
    }
    EXPECT_GE(low.depth, any.depth);
    if (any.frequency <= kBelow) {
      EXPECT_EQ(low.depth, any.depth);
    }
    if (any.frequency > kBelow) ++fast;
    if (std::isinf(low.depth)) continue;
    ++slow;
    EXPECT_LE(low.frequency, kBelow);
    const Eigen::VectorXcd values = eigenvalues(MeanCut(robot).state_matrix(low.depth));
    EXPECT_LT((values.array() - std::complex<double>(0.0, low.frequency)).abs().minCoeff(), 0.1) << i;
  }
  EXPECT_GT(fast, 5);
  EXPECT_GT(slow, 5);
}

TEST(ModeCoupling, LimitFallsAsTheMaterialHardens) {
  std::mt19937_64 random(24);
  for (int i = 0; i < 50; ++i) {
    test::StabilityCase robot = random_robot(random);
    const double depth = mode_coupling_limit(robot.cut, robot.modes, 0.02).depth;
    robot.cut.ktc *= 2.0, robot.cut.krc *= 2.0, robot.cut.kac *= 2.0;
    const double halved = mode_coupling_limit(robot.cut, robot.modes, 0.01).depth;
    if (std::isinf(depth)) {
      EXPECT_EQ(halved, depth);
    } else {
      EXPECT_NEAR(2.0 * halved, depth, 1e-6 * depth);
    }
  }
}

TEST(ModeCoupling, ASingleModeHasNothingToCoupleWith) {
  // Pushed back by the cut it is stiffer; drawn in by it, it gives way without vibration at a = k / |u . W u|.
  const LinearCut slot = cut_of(2, Milling::slot, 1.0, 8e8, 1e8), down = cut_of(2, Milling::down, 0.3, 8e8, 1e8);
  EXPECT_TRUE(std::isinf(mode_coupling_limit(slot, std::vector{mode_of(14, 0.03, 1e6, 1, 0)}, 1.0).depth));
  const double pull = -mean_cutting_stiffness(down)(0, 0);
  ASSERT_GT(pull, 0.0);
  const std::vector<Mode> modes{mode_of(14, 0.03, 1e6, 1, 0)};
  for (const auto& limit : {mode_coupling_limit(down, modes, 1.0), undamped_mode_coupling_limit(down, modes, 1.0)}) {
    EXPECT_NEAR(limit.depth, 1e6 / pull, 1e-5 * limit.depth);
    EXPECT_EQ(limit.frequency, 0.0);
  }
}

TEST(ModeCoupling, RefusesWhatIsNoStructure) {
  const LinearCut cut = cut_of(2, Milling::slot, 1.0, 8e8, 1e8);
  EXPECT_THROW(mode_coupling_limit(cut, {}, 0.02), std::invalid_argument);
  EXPECT_THROW(mode_coupling_limit(cut, std::vector{mode_of(14, 0.0, 1e6, 1, 0)}, 0.02), std::invalid_argument);
  EXPECT_THROW(mode_coupling_limit(cut, std::vector{mode_of(14, 0.03, 1e6, 1, 0)}, 0.0), std::invalid_argument);
  EXPECT_THROW(undamped_mode_coupling_limit(cut, std::vector{mode_of(14, 0.03, 1e6, 1, 0)}, -1.0),
               std::invalid_argument);
}

}  // namespace
}  // namespace stillcut
