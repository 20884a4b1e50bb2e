// The Floquet verdict against an independent oracle: the linear delay equations integrated in time by Runge-Kutta, with
// the growth per period fitted at the end.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "models/floquet.hpp"
#include "stability_cases.hpp"
#include "tests/sanitized.hpp"

namespace stillcut {
namespace {

// Integrates q'' + 2 zeta w q' + w^2 q = w^2/k u.F, F = -a sum over cutting teeth of (w n.(x - x_delayed) + C_p/v n
// n.x'), each tooth with its own delay, by a classical fourth-order step on a grid that divides every delay. A step in
// which a tooth enters or leaves is an O(h) error; the grid is fine enough for the verdict.
class TimeIntegration {
 public:
  TimeIntegration(const test::StabilityCase& cutting, double speed, double depth, int steps_a_turn)
      : case_(cutting), speed_(speed), depth_(depth), turn_(steps_a_turn), step_(kTwoPi / speed / steps_a_turn) {
    const LinearCut& cut = case_.cut;
    double lead = 0.0;
    for (int tooth = 0; tooth < cut.teeth; ++tooth) {
      const double pitch = cut.pitch.empty() ? kTwoPi / cut.teeth : cut.pitch[static_cast<std::size_t>(tooth)];
      teeth_.push_back({lead, static_cast<int>(std::lround(pitch / kTwoPi * steps_a_turn))});
      lead += pitch;
    }
    for (const Mode& mode : case_.modes) directions_.push_back(Eigen::Vector3d(mode.direction.data()).normalized());
    std::mt19937_64 random(5);
    for (std::size_t k = 0; k < 2 * case_.modes.size(); ++k) state_[k] = std::normal_distribution<>(0.0, 1e-6)(random);
    history_.assign(2 * static_cast<std::size_t>(turn_), {0.0, 0.0});
  }

  // Radius per turn of the spindle from the growth over the second half of the turns.
  double growth(int turns) {
    double logarithm = 0.0;
    for (int turn = 0; turn < turns; ++turn) {
      for (int i = 0; i < turn_; ++i) advance(i);
      double size = 0.0;
      for (std::size_t m = 0; m < case_.modes.size(); ++m) {
        size += std::pow(state_[2 * m], 2) + std::pow(state_[2 * m + 1] / case_.modes[m].natural_frequency, 2);
      }
      for (const Eigen::Vector2d& x : history_) size += x.squaredNorm() / static_cast<double>(history_.size());
      const double scale = 1e-6 / std::sqrt(size);
      if (turn >= turns / 2) logarithm -= std::log(scale);
      for (double& value : state_) value *= scale;
      for (Eigen::Vector2d& x : history_) x *= scale;
    }
    return std::exp(logarithm / (turns - turns / 2));
  }

 private:
  using State = std::array<double, 12>;  // (q, q') of up to six modes
  struct ToothPlace {
    double lead;
    int delay;  // in steps
  };

  Eigen::Vector2d sum(const State& state, std::size_t first) const {
    Eigen::Vector2d x(0.0, 0.0);
    for (std::size_t m = 0; m < directions_.size(); ++m) x += directions_[m].head<2>() * state[2 * m + first];
    return x;
  }

  // half: the half step within the turn, 0 to 2 turn_.
  State derivative(const State& state, int half) const {
    const Eigen::Vector2d now = sum(state, 0), rate = sum(state, 1);
    const LinearCut& cut = case_.cut;
    Eigen::Vector3d force(0.0, 0.0, 0.0);
    for (const ToothPlace& tooth : teeth_) {
      const double phi = std::fmod(0.5 * speed_ * step_ * half + tooth.lead, kTwoPi);
      if (phi < cut.immersion.entry || phi > cut.immersion.exit) continue;
      const Eigen::Vector2d before =
          history_[static_cast<std::size_t>((half + 2 * turn_ - 2 * tooth.delay) % (2 * turn_))];
      const double s = std::sin(phi), c = std::cos(phi);
      const double chip = depth_ * (s * (now[0] - before[0]) + c * (now[1] - before[1]));
      const double rub = depth_ * cut.process_damping / (speed_ * cut.radius) * (s * rate[0] + c * rate[1]);
      force += Eigen::Vector3d(-cut.ktc * chip * c - (cut.krc * chip + rub) * s,
                               cut.ktc * chip * s - (cut.krc * chip + rub) * c, -cut.kac * chip);
    }
    State result{};
    for (std::size_t m = 0; m < directions_.size(); ++m) {
      const Mode& mode = case_.modes[m];
      const double w = mode.natural_frequency;
      result[2 * m] = state[2 * m + 1];
      result[2 * m + 1] = w * w / mode.stiffness * directions_[m].dot(force) -
                          2.0 * mode.damping_ratio * w * state[2 * m + 1] - w * w * state[2 * m];
    }
    return result;
  }

  void advance(int i) {
    const auto moved = [&](const State& by, double h) {
      State result = state_;
      for (std::size_t k = 0; k < result.size(); ++k) result[k] += h * by[k];
      return result;
    };
    const State k1 = derivative(state_, 2 * i);
    const State k2 = derivative(moved(k1, 0.5 * step_), 2 * i + 1);
    const State half_way = moved(k2, 0.5 * step_);
    const State k3 = derivative(half_way, 2 * i + 1);
    const State k4 = derivative(moved(k3, step_), 2 * i + 2);
    // The displacement half way is kept as it was computed, so that the order is not lost to interpolation. What was
    // there a turn ago is not needed any more: no tooth looks back that far, but a single one, which has just done so.
    history_[2 * static_cast<std::size_t>(i)] = sum(state_, 0);
    history_[2 * static_cast<std::size_t>(i) + 1] = sum(half_way, 0);
    for (std::size_t k = 0; k < state_.size(); ++k) state_[k] += step_ / 6.0 * (k1[k] + 2 * k2[k] + 2 * k3[k] + k4[k]);
  }

  const test::StabilityCase& case_;
  double speed_, depth_;
  int turn_;  // steps
  double step_;
  std::vector<ToothPlace> teeth_;
  std::vector<Eigen::Vector3d> directions_;
  State state_{};
  std::vector<Eigen::Vector2d> history_;  // displacement at every half step of the last turn
};

constexpr int kSeries = test::kSanitized ? 1 : 4;  // so that two processors share the work
constexpr int kCuts = test::kSanitized ? 40 : 150;

class FloquetAgainstTime : public ::testing::TestWithParam<int> {};

// One to six modes, all immersions, equal and unequal pitch, a third with process damping.
TEST_P(FloquetAgainstTime, VerdictsAgreeOnRandomCuts) {
  constexpr int kSteps = 1260;  // a turn; divides by every number of teeth
  std::mt19937_64 random(2024 + static_cast<unsigned>(GetParam()));
  int compared = 0, unstable = 0, uneven = 0;
  for (int i = 0; i < kCuts; ++i) {
    const bool unequal = i % 2 == 1;
    test::StabilityCase cutting = unequal ? test::random_uneven_case(random, kSteps / 3) : test::random_case(random);
    if (i % 3 == 0) cutting.cut.process_damping = std::uniform_real_distribution<>(0.0, 2e4)(random);
    const double speed = rpm_to_rad_s(std::uniform_real_distribution<>(2000, 12000)(random));
    const double depth = std::exp(std::uniform_real_distribution<>(std::log(4e-4), std::log(10e-3))(random));
    const FloquetPoint point = floquet_point(cutting.cut, cutting.modes, speed, depth);
    if (point.spectral_radius > 0.98 && point.spectral_radius < 1.02) continue;
    const double in_turns = kTwoPi / speed / point.period;
    const double grown = std::pow(TimeIntegration(cutting, speed, depth, kSteps).growth(90), 1.0 / in_turns);
    EXPECT_EQ(grown < 1.0, point.spectral_radius < 1.0)
        << "cut " << i << ": " << grown << " in time, " << point.spectral_radius << " by Floquet";
    const double logarithm = std::log(point.spectral_radius);
    EXPECT_NEAR(std::log(grown), logarithm, 0.03 * std::max(1.0, std::abs(logarithm))) << "cut " << i;
    ++compared;
    unstable += point.spectral_radius > 1.0;
    uneven += unequal;
  }
  EXPECT_GE(compared, kCuts * 5 / 6);
  EXPECT_GT(unstable, compared / 10);
  EXPECT_LT(unstable, compared * 4 / 5);
  EXPECT_GT(uneven, compared / 3);
  RecordProperty("compared", compared);
}

INSTANTIATE_TEST_SUITE_P(Series, FloquetAgainstTime, ::testing::Range(0, kSeries));

}  // namespace
}  // namespace stillcut
