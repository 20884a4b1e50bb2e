// The Floquet verdict against an independent oracle: the linear delay equations integrated in time by Runge-Kutta, with
// the growth per tooth period fitted at the end.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "models/floquet.hpp"
#include "stability_cases.hpp"

namespace stillcut {
namespace {

// Integrates q'' + 2 zeta w q' + w^2 q = w^2/k u.F with F = -a sum over cutting teeth of w n.(x - x_delayed), a
// classical fourth-order step on a grid that divides the tooth period. Steps whose ends see different teeth are an O(h)
// error; the grid is fine enough for the verdict.
class TimeIntegration {
 public:
  TimeIntegration(const test::StabilityCase& cutting, double speed, double depth, int steps)
      : case_(cutting),
        speed_(speed),
        depth_(depth),
        steps_(steps),
        step_(kTwoPi / (speed * cutting.cut.teeth) / steps) {
    std::mt19937_64 random(5);
    state_.resize(2 * case_.modes.size());
    for (double& value : state_) value = std::normal_distribution<>(0.0, 1e-6)(random);
    history_.assign(2 * static_cast<std::size_t>(steps) + 1, {0.0, 0.0});
  }

  // Radius per tooth period from the growth of the state's size over the second half of the periods.
  double growth(int periods) {
    double logarithm = 0.0;
    for (int period = 0; period < periods; ++period) {
      std::vector<Eigen::Vector2d> next = history_;
      next[0] = displacement(state_);
      for (int i = 0; i < steps_; ++i) {
        advance(i);
        next[2 * static_cast<std::size_t>(i) + 1] = middle_;
        next[2 * static_cast<std::size_t>(i) + 2] = displacement(state_);
      }
      history_ = next;
      double size = 0.0;
      for (std::size_t m = 0; m < case_.modes.size(); ++m) {
        size += std::pow(state_[2 * m], 2) + std::pow(state_[2 * m + 1] / case_.modes[m].natural_frequency, 2);
      }
      for (const Eigen::Vector2d& x : history_) size += x.squaredNorm() / static_cast<double>(history_.size());
      const double scale = 1e-6 / std::sqrt(size);
      if (period >= periods / 2) logarithm -= std::log(scale);
      for (double& value : state_) value *= scale;
      for (Eigen::Vector2d& x : history_) x *= scale;
    }
    return std::exp(logarithm / (periods - periods / 2));
  }

 private:
  using State = std::vector<double>;

  Eigen::Vector2d displacement(const State& state) const {
    Eigen::Vector2d x(0.0, 0.0);
    for (std::size_t m = 0; m < case_.modes.size(); ++m) {
      const Eigen::Vector3d u = Eigen::Vector3d(case_.modes[m].direction.data()).normalized();
      x += u.head<2>() * state[2 * m];
    }
    return x;
  }

  State derivative(const State& state, double angle, const Eigen::Vector2d& delayed) const {
    const Eigen::Vector2d difference = displacement(state) - delayed;
    Eigen::Vector3d force(0.0, 0.0, 0.0);
    for (int tooth = 0; tooth < case_.cut.teeth; ++tooth) {
      const double phi = std::fmod(angle + tooth * kTwoPi / case_.cut.teeth, kTwoPi);
      if (phi < case_.cut.immersion.entry || phi > case_.cut.immersion.exit) continue;
      const double s = std::sin(phi), c = std::cos(phi), chip = s * difference[0] + c * difference[1];
      const double tangential = case_.cut.ktc * depth_ * chip, radial = case_.cut.krc * depth_ * chip;
      force +=
          Eigen::Vector3d(-tangential * c - radial * s, tangential * s - radial * c, -case_.cut.kac * depth_ * chip);
    }
    State result(state.size());
    for (std::size_t m = 0; m < case_.modes.size(); ++m) {
      const Mode& mode = case_.modes[m];
      const double w = mode.natural_frequency;
      const double push = Eigen::Vector3d(mode.direction.data()).normalized().dot(force);
      result[2 * m] = state[2 * m + 1];
      result[2 * m + 1] =
          w * w / mode.stiffness * push - 2.0 * mode.damping_ratio * w * state[2 * m + 1] - w * w * state[2 * m];
    }
    return result;
  }

  void advance(int i) {
    const auto at = 2 * static_cast<std::size_t>(i);
    const double angle = speed_ * step_ * i, half = 0.5 * speed_ * step_;
    // The delayed displacement at half steps is kept as it was computed, so that the order is not lost to
    // interpolation.
    const auto moved = [&](const State& by, double h) {
      State result = state_;
      for (std::size_t k = 0; k < result.size(); ++k) result[k] += h * by[k];
      return result;
    };
    const State k1 = derivative(state_, angle, history_[at]);
    const State k2 = derivative(moved(k1, 0.5 * step_), angle + half, history_[at + 1]);
    const State half_way = moved(k2, 0.5 * step_);
    const State k3 = derivative(half_way, angle + half, history_[at + 1]);
    const State k4 = derivative(moved(k3, step_), angle + 2 * half, history_[at + 2]);
    middle_ = displacement(half_way);
    for (std::size_t k = 0; k < state_.size(); ++k) state_[k] += step_ / 6.0 * (k1[k] + 2 * k2[k] + 2 * k3[k] + k4[k]);
  }

  const test::StabilityCase& case_;
  double speed_, depth_;
  int steps_;
  double step_;
  State state_;
  std::vector<Eigen::Vector2d> history_;  // displacement a tooth period ago at every half step
  Eigen::Vector2d middle_{0.0, 0.0};
};

TEST(FloquetAgainstTime, VerdictsAgreeOnRandomCuts) {
  std::mt19937_64 random(2024);
  int compared = 0, unstable = 0;
  for (int i = 0; i < 40; ++i) {
    const test::StabilityCase cutting = test::random_case(random);
    const double speed = rpm_to_rad_s(std::uniform_real_distribution<>(2000, 12000)(random));
    const double depth = std::exp(std::uniform_real_distribution<>(std::log(2e-4), std::log(6e-3))(random));
    const double radius = floquet_point(cutting.cut, cutting.modes, speed, depth).spectral_radius;
    if (radius > 0.98 && radius < 1.02) continue;
    const double grown = TimeIntegration(cutting, speed, depth, 800).growth(120);
    EXPECT_EQ(grown < 1.0, radius < 1.0) << "cut " << i << ": " << grown << " in time, " << radius << " by Floquet";
    EXPECT_NEAR(grown, radius, 0.02 * radius) << "cut " << i;
    ++compared;
    unstable += radius > 1.0;
  }
  EXPECT_GT(compared, 30);
  EXPECT_GT(unstable, 8);
  EXPECT_LT(unstable, compared - 8);
}

}  // namespace
}  // namespace stillcut
