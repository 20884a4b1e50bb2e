#include "models/modal_refit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "models/interpolation.hpp"
#include "models/machining.hpp"
#include "models/receptance.hpp"
#include "models/receptance_peaks.hpp"
#include "tests/sanitized.hpp"

namespace stillcut {
namespace {

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<>(low, high)(random);
}

Mode random_mode(std::mt19937_64& random, double low_hz, double high_hz) {
  std::normal_distribution<> component;
  Eigen::Vector3d u(component(random), component(random), component(random));
  u.normalize();
  return {kTwoPi * low_hz * std::pow(high_hz / low_hz, uniform(random, 0, 1)),
          uniform(random, 0.01, 0.08),
          1e6 * std::pow(30.0, uniform(random, 0, 1)),
          {u[0], u[1], u[2]}};
}

// The frf superposition of a few postures whose modes drift from one to the next.
std::vector<Mode> superposition(std::mt19937_64& random, int mode_count, int posture_count, double drift) {
  std::vector<Mode> modes;
  for (int m = 0; m < mode_count; ++m) {
    const Mode base = random_mode(random, 15 * std::pow(2.0, m), 20 * std::pow(2.0, m));
    for (int p = 0; p < posture_count; ++p) {
      Mode mode = base;
      mode.natural_frequency *= 1.0 + drift * uniform(random, -1, 1);
      mode.stiffness *= posture_count * (1.0 + drift * uniform(random, -1, 1));
      mode.damping_ratio *= 1.0 + drift * uniform(random, -1, 1);
      modes.push_back(mode);
    }
  }
  return modes;
}

void expect_physical(const std::vector<Mode>& modes) {
  EXPECT_NO_THROW(check_modes(modes));
  for (const Mode& mode : modes)
    EXPECT_NEAR(std::hypot(mode.direction[0], mode.direction[1], mode.direction[2]), 1.0, 1e-9);
  EXPECT_TRUE(std::is_sorted(modes.begin(), modes.end(),
                             [](const Mode& a, const Mode& b) { return a.natural_frequency < b.natural_frequency; }));
}

TEST(ModalRefit, WeightedCopiesOfAFewModesComeBackExactly) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 30; ++trial) {
    std::vector<Mode> distinct;
    for (int m = 0; m <= trial % 12; ++m) distinct.push_back(random_mode(random, 10, 900));
    std::sort(distinct.begin(), distinct.end(),
              [](const Mode& a, const Mode& b) { return a.natural_frequency < b.natural_frequency; });
    std::vector<Mode> copies;
    for (const Mode& mode : distinct) {
      double left = 1.0;
      for (int c = 0; c < 8; ++c) {
        const double weight = c == 7 ? left : left * uniform(random, 0.05, 0.5);
        left -= weight;
        Mode copy = mode;
        copy.stiffness /= weight;
        if (c % 2 == 1)
          for (double& component : copy.direction) component = -component;
        copies.push_back(copy);
      }
    }
    std::shuffle(copies.begin(), copies.end(), random);
    const ModalRefit refit = refit_modes(copies);
    ASSERT_EQ(refit.modes.size(), distinct.size());
    for (std::size_t m = 0; m < distinct.size(); ++m) {
      EXPECT_NEAR(refit.modes[m].natural_frequency / distinct[m].natural_frequency, 1.0, 1e-12);
      EXPECT_NEAR(refit.modes[m].damping_ratio / distinct[m].damping_ratio, 1.0, 1e-12);
      EXPECT_NEAR(refit.modes[m].stiffness / distinct[m].stiffness, 1.0, 1e-12);
    }
    EXPECT_LT(refit.error.worst, 1e-12);
    EXPECT_LT(refit.error.at_peak, 1e-12);
  }
}

TEST(ModalRefit, CopiesThatDifferByMeasurementNoiseComeBackWithinIt) {
  std::mt19937_64 random(2);
  const std::vector<Mode> modes = superposition(random, 4, 20, 1e-4);
  const ModalRefit refit = refit_modes(modes, 4);
  EXPECT_EQ(refit.modes.size(), 4U);
  EXPECT_LT(refit.error.worst, 2e-3);
}

// The declared error beside one computed here, at frequencies of this test's own.
TEST(ModalRefit, DeclaresItsErrorHonestly) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 4; ++trial) {
    const std::vector<Mode> modes = superposition(random, 4, 12, 0.04);
    const ModalRefit refit = refit_modes(modes, 6);
    ASSERT_LE(refit.modes.size(), 6U);
    expect_physical(refit.modes);
    const auto [low, high] = std::minmax_element(modes.begin(), modes.end(), [](const Mode& a, const Mode& b) {
      return a.natural_frequency < b.natural_frequency;
    });
    double squares = 0.0, worst = 0.0, highest = 0.0, at_peak = 0.0;
    constexpr int kPoints = 4000;
    for (int i = 0; i < kPoints; ++i) {
      const double frequency = 0.7 * low->natural_frequency *
                               std::pow(2.0 * high->natural_frequency / low->natural_frequency, (i + 0.5) / kPoints);
      const Eigen::Matrix3cd g = receptance(modes, frequency);
      const double error = (receptance(refit.modes, frequency) - g).norm() / g.norm();
      squares += error * error / kPoints;
      worst = std::max(worst, error);
      if (g.norm() > highest) highest = g.norm(), at_peak = error;
    }
    EXPECT_NEAR(refit.error.rms, std::sqrt(squares), 0.02 * std::sqrt(squares));
    EXPECT_NEAR(refit.error.worst, worst, 0.02 * worst);
    EXPECT_NEAR(refit.error.at_peak, at_peak, 0.1 * at_peak + 1e-3);
  }
}

TEST(ModalRefit, MoreModesFitBetter) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 3; ++trial) {
    const std::vector<Mode> modes = superposition(random, 4, 12, 0.06);
    const double four = refit_modes(modes, 4).error.rms, eight = refit_modes(modes, 8).error.rms,
                 twelve = refit_modes(modes, 12).error.rms;
    EXPECT_LT(eight, four);
    EXPECT_LT(twelve, eight);
    EXPECT_LT(twelve, 0.05);
  }
}

// What the issue names: 49 postures of four modes are 196 superposed ones.
TEST(ModalRefit, BringsThePaperSizedMapDownToTwelve) {
  std::mt19937_64 random(5);
  const std::vector<Mode> modes = superposition(random, 4, 49, 0.05);
  ASSERT_EQ(modes.size(), 196U);
  const ModalRefit refit = refit_modes(modes);
  EXPECT_LE(refit.modes.size(), kMostRefitModes);
  expect_physical(refit.modes);
  EXPECT_LT(refit.error.rms, 0.03);
  EXPECT_LT(refit.error.at_peak, 0.1);  // 0.049 seen
  if (test::kSanitized) return;
  const ModalRefit again = refit_modes(modes);
  for (std::size_t m = 0; m < refit.modes.size(); ++m) {
    EXPECT_EQ(again.modes[m].natural_frequency, refit.modes[m].natural_frequency);
    EXPECT_EQ(again.modes[m].stiffness, refit.modes[m].stiffness);
  }
}

TEST(ModalRefit, KeepsAFewModesAsTheyAreAndRefusesNonsense) {
  std::mt19937_64 random(6);
  std::vector<Mode> modes{random_mode(random, 10, 20), random_mode(random, 30, 40)};
  const ModalRefit refit = refit_modes(modes);
  EXPECT_EQ(refit.modes[0].natural_frequency, modes[0].natural_frequency);
  EXPECT_EQ(refit.modes[1].stiffness, modes[1].stiffness);
  EXPECT_THROW(refit_modes(modes, 0), std::invalid_argument);
  EXPECT_THROW(refit_modes({}), std::invalid_argument);
  modes[1].damping_ratio = 0.0;
  EXPECT_THROW(refit_modes(modes), std::invalid_argument);
  EXPECT_EQ(refit_modes(std::vector<Mode>{random_mode(random, 10, 11), random_mode(random, 10, 11)}, 1).modes.size(),
            1U);
}

TEST(ReceptancePeaks, OfOneModeStandAtItsResonance) {
  std::mt19937_64 random(7);
  for (int trial = 0; trial < 50; ++trial) {
    const Mode mode = random_mode(random, 5, 1000);
    const auto peaks = receptance_peaks(std::vector<Mode>{mode});
    ASSERT_EQ(peaks.size(), 1U);
    const double zeta = mode.damping_ratio;
    EXPECT_NEAR(peaks[0].frequency / mode.natural_frequency, std::sqrt(1 - 2 * zeta * zeta), 1e-6);
    EXPECT_NEAR(peaks[0].receptance * 2 * mode.stiffness * zeta * std::sqrt(1 - zeta * zeta), 1.0, 1e-9);
  }
}

TEST(ReceptancePeaks, LargestReceptanceIsTheLargestSingularValue) {
  std::mt19937_64 random(8);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Mode> modes;
    for (int m = 0; m <= trial % 5; ++m) modes.push_back(random_mode(random, 10, 100));
    const double frequency = kTwoPi * uniform(random, 5, 150);
    const Eigen::Matrix3cd g = receptance(modes, frequency);
    Eigen::Vector3cd x(1.0, std::complex<double>(0.3, 0.5), std::complex<double>(-0.2, 0.7));
    for (int i = 0; i < 3000; ++i) x = (g.adjoint() * (g * x)).normalized();  // power iteration
    EXPECT_NEAR(largest_receptance(modes, frequency) / (g * x).norm(), 1.0, 1e-6);
  }
}

TEST(ReceptancePeaks, CountsModesThatStandApartAndSplitOnesTwice) {
  const auto mode = [](double hz) { return Mode{kTwoPi * hz, 0.02, 1e6, {1, 0, 0}}; };
  EXPECT_EQ(receptance_peaks(std::vector<Mode>{mode(20), mode(50), mode(120)}).size(), 3U);
  EXPECT_EQ(receptance_peaks(std::vector<Mode>{mode(20), mode(22)}).size(), 2U);
  EXPECT_EQ(receptance_peaks(std::vector<Mode>{mode(20), mode(20.1)}).size(), 1U);
}

TEST(FewModes, FitsSuperposedModesOnlyAndSaysHowWell) {
  std::mt19937_64 random(9);
  PredictedPosture predicted;
  for (int m = 0; m < 15; ++m) predicted.posture.modes.push_back(random_mode(random, 10, 300));
  EXPECT_EQ(with_few_modes(predicted).posture.modes.size(), 15U);  // measured ones are kept as they are
  predicted.superposed = true;
  EXPECT_EQ(with_few_modes(predicted, 15).posture.modes.size(), 15U);
  const PredictedPosture few = with_few_modes(predicted);
  EXPECT_EQ(few.posture.modes.size(), kMostRefitModes);
  EXPECT_EQ(few.fitted_from, 15U);
  EXPECT_EQ(few.fit_error, receptance_error(few.posture.modes, predicted.posture.modes).rms);
  EXPECT_GT(few.fit_error, 0.0);
}

}  // namespace
}  // namespace stillcut
