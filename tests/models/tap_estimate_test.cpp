// Frequency responses from hits on structures whose receptance is known in closed form. An estimator that averages the
// wrong way, a window applied to one channel only, or a decay that is not accounted for fails here by far more than
// the tolerance.
#include "models/tap_estimate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/models/tapped_structure.hpp"

namespace stillcut {
namespace {

const std::vector<Mode>& robot_modes() {
  static const std::vector<Mode> modes{{kTwoPi * 12.0, 0.02, 1.5e6, {0.8, 0.6, 0.0}},
                                       {kTwoPi * 55.0, 0.03, 4e6, {0.36, 0.48, 0.8}},
                                       {kTwoPi * 130.0, 0.015, 9e6, {-0.6, 0.0, 0.8}},
                                       {kTwoPi * 310.0, 0.02, 3e7, {0.48, -0.64, 0.6}}};
  return modes;
}

// The modes as an exponential window shows them: the same modal mass and damped frequency, a faster decay.
std::vector<Mode> with_decay(std::vector<Mode> modes, double added_per_s) {
  for (Mode& mode : modes) {
    const double mass = mode.stiffness / std::pow(mode.natural_frequency, 2);
    const double decay = mode.damping_ratio * mode.natural_frequency;
    const double damped = mode.natural_frequency * std::sqrt(1.0 - std::pow(mode.damping_ratio, 2));
    mode.natural_frequency = std::hypot(damped, decay + added_per_s);
    mode.damping_ratio = (decay + added_per_s) / mode.natural_frequency;
    mode.stiffness = mass * std::pow(mode.natural_frequency, 2);
  }
  return modes;
}

// The largest deviation within 20 % of a resonance, as a share of what the column of responses amounts to there: one
// axis may hardly move where another resounds.
double worst_around_resonances(const FrequencyResponse& response, std::size_t force_axis,
                               const std::vector<Mode>& truth) {
  double worst = 0.0;
  for (std::size_t i = 0; i < response.frequencies_hz.size(); ++i) {
    const double hz = response.frequencies_hz[i];
    if (std::ranges::none_of(
            truth, [&](const Mode& mode) { return std::abs(kTwoPi * hz / mode.natural_frequency - 1.0) < 0.2; }))
      continue;
    double deviation = 0.0, size = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::complex<double> expected = receptance_between(truth, axis, force_axis, hz);
      deviation += std::norm(response.receptance[axis][force_axis][i] - expected);
      size += std::norm(expected);
    }
    worst = std::max(worst, std::sqrt(deviation / size));
  }
  return worst;
}

TEST(TapEstimate, IsTheClosedFormWithinAPercentOnceTheWindowsDecayIsKnown) {
  const TapSettings settings{.force_axis = 2};
  const std::vector<TapRecording> recordings{
      tapped(robot_modes(), 2, 1.0, std::vector<HammerPulse>{{0.3, 600, 0.0025}}, 5.0, 8192.0),
      tapped(robot_modes(), 2, 1.0, std::vector<HammerPulse>{{0.2, 900, 0.0022}}, 5.0, 8192.0)};
  const TapEstimate estimate = estimate_taps(recordings, settings);
  EXPECT_EQ(estimate.hits_used, 2U);
  EXPECT_NEAR(estimate.added_decay_per_s, -std::log(0.01) * 8192.0 / 8192.0, 0.02);
  const std::vector<Mode> seen = with_decay(robot_modes(), estimate.added_decay_per_s);
  for (const FrequencyResponse* response : {&estimate.h1, &estimate.h2, &estimate.hv}) {
    EXPECT_LT(worst_around_resonances(*response, 2, seen), 0.01);
    EXPECT_EQ(measured_entries(*response), 3U);
  }
  EXPECT_GT(worst_around_resonances(estimate.h1, 2, robot_modes()), 0.2) << "the window must matter here";
  EXPECT_GT(std::ranges::min(std::span{estimate.coherence[0]}.subspan(8, 400)), 0.99);
  EXPECT_GT(estimate.force_spectrum[0], 0.9 * 0.5 * 600 * 0.0025);
}

TEST(TapEstimate, IsTheClosedFormWithinAPercentOfALongRecordWithoutExponential) {
  const TapSettings settings{.force_axis = 0, .force_sense = -1.0, .record_s = 6.0, .end_weight = 1.0};
  const std::vector<TapRecording> recordings{
      tapped(robot_modes(), 0, -1.0, std::vector<HammerPulse>{{0.3, 600, 0.0025}}, 7.0, 8192.0)};
  const TapEstimate estimate = estimate_taps(recordings, settings);
  EXPECT_EQ(estimate.added_decay_per_s, 0.0);
  EXPECT_LT(worst_around_resonances(estimate.h1, 0, robot_modes()), 0.01);
  EXPECT_TRUE(std::isnan(estimate.coherence[1][10])) << "one hit agrees with itself";
}

TEST(TapEstimate, IsNotMovedBySensorOffsets) {
  TapRecording recording = tapped(robot_modes(), 2, 1.0, std::vector<HammerPulse>{{0.3, 600, 0.0025}}, 8.0, 8192.0);
  for (double& value : recording.force) value += 1.5;
  for (double& value : recording.acceleration[2]) value -= 9.81;
  const TapEstimate estimate = estimate_taps({&recording, 1}, {.force_axis = 2});
  EXPECT_LT(worst_around_resonances(estimate.h1, 2, with_decay(robot_modes(), estimate.added_decay_per_s)), 0.01);
}

TEST(TapEstimate, OfAModeGivesItsOwnDampingBack) {
  for (const double decay : {0.0, 0.5, 4.6, 40.0})
    for (const Mode& mode : robot_modes()) {
      const Mode seen = with_decay({mode}, decay)[0], back = without_added_decay(seen, decay);
      EXPECT_NEAR(back.natural_frequency, mode.natural_frequency, 1e-11 * mode.natural_frequency);
      EXPECT_NEAR(back.damping_ratio, mode.damping_ratio, 1e-11);
      EXPECT_NEAR(back.stiffness, mode.stiffness, 1e-10 * mode.stiffness);
    }
  EXPECT_THROW((void)without_added_decay(robot_modes()[0], 2.0), std::invalid_argument);
}

// A mode at 300 Hz struck softly, so that the force there is small; noise on either channel is a given share of power
// at the resonance, and the expectation follows from the share at each line.
struct NoisyTaps {
  static constexpr int kHits = 400;
  static constexpr std::size_t kAxis = 1;
  const double rate = 4096.0;
  const TapSettings settings{
      .force_axis = 1, .record_s = 0.5, .trigger_n = 100.0, .least_peak_n = 500.0, .force_window_s = kInfinity};
  const std::vector<Mode> modes{{kTwoPi * 300.0, 0.03, 2e7, {0.6, 0.8, 0.0}}};
  TapRecording once;
  TapEstimate clean;
  std::size_t first = 0, last = 0;  // lines around the resonance

  NoisyTaps() {
    once = tapped(modes, kAxis, 1.0, std::vector<HammerPulse>{{0.02, 1000, 0.006}}, 0.52, rate);
    // z stands still; it is left out.
    once.acceleration[2].clear();
    clean = estimate_taps({&once, 1}, settings);
    const std::vector<double>& hz = clean.h1.frequencies_hz;
    first = static_cast<std::size_t>(std::ranges::lower_bound(hz, 288.0) - hz.begin());
    last = static_cast<std::size_t>(std::ranges::lower_bound(hz, 312.0) - hz.begin());
  }

  // Of a transform of white noise of unit variance under the exponential window, squared, (s)^2.
  double noise_power() const {
    double sum = 0.0;
    for (int n = 0; n < 2048; ++n) sum += std::exp(2.0 * std::log(0.01) * n / 2048.0);
    return sum / (rate * rate);
  }
  double acceleration_line(std::size_t i) const {
    const std::complex<double> p(clean.added_decay_per_s, kTwoPi * clean.h1.frequencies_hz[i]);
    return std::abs(p * p * clean.h1.receptance[kAxis][kAxis][i]) * clean.force_spectrum[i];
  }
  std::size_t resonance() const { return (first + last) / 2; }

  struct Shares {
    double h1 = 0.0, h2 = 0.0, hv = 0.0, coherence = 0.0;  // mean over the lines; of truth
    double expected_h1 = 0.0, expected_h2 = 0.0, expected_hv = 0.0, expected_coherence = 0.0;
  };
  Shares estimate(double force_share, double response_share, unsigned seed) const {
    const double force_noise = clean.force_spectrum[resonance()] * std::sqrt(force_share / noise_power()),
                 response_noise = acceleration_line(resonance()) * std::sqrt(response_share / noise_power());
    TapRecording noisy = repeated_with_noise(once, kHits, force_noise, response_noise, seed);
    const TapEstimate found = estimate_taps({&noisy, 1}, settings);
    EXPECT_GT(found.hits_used, kHits - 5U);
    Shares mean;
    const double lines = static_cast<double>(last - first);
    for (std::size_t i = first; i < last; ++i) {
      const std::complex<double> truth = clean.h1.receptance[kAxis][kAxis][i];
      const auto share = [&](const FrequencyResponse& h) { return h.receptance[kAxis][kAxis][i] / truth; };
      // In phase with the truth: noise that only turns the phase does not count as size.
      mean.h1 += share(found.h1).real() / lines;
      mean.h2 += share(found.h2).real() / lines;
      mean.hv += share(found.hv).real() / lines;
      mean.coherence += found.coherence[kAxis][i] / lines;
      EXPECT_LE(std::abs(share(found.h1)), std::abs(share(found.hv)));
      EXPECT_LE(std::abs(share(found.hv)), std::abs(share(found.h2)));
      const double f = 1.0 + noise_power() * std::pow(force_noise / clean.force_spectrum[i], 2),
                   x = 1.0 + noise_power() * std::pow(response_noise / acceleration_line(i), 2);
      mean.expected_h1 += 1.0 / f / lines;
      mean.expected_h2 += x / lines;
      mean.expected_hv += std::sqrt(x / f) / lines;
      mean.expected_coherence += 1.0 / (f * x) / lines;
    }
    EXPECT_NEAR(mean.h1, mean.expected_h1, 0.015);
    EXPECT_NEAR(mean.h2, mean.expected_h2, 0.02);
    EXPECT_NEAR(mean.hv, mean.expected_hv, 0.015);
    EXPECT_NEAR(mean.coherence, mean.expected_coherence, 0.015);
    return mean;
  }
};

TEST(TapEstimate, ByH1IsRightWhereResponsesAreNoisy) {
  const NoisyTaps::Shares shares = NoisyTaps().estimate(0.0, 0.25, 1);
  EXPECT_NEAR(shares.h1, 1.0, 0.015);
  EXPECT_GT(shares.h2, 1.2);
  EXPECT_LT(shares.coherence, 0.85);
}

TEST(TapEstimate, ByH2IsRightWhereTheForceIsNoisy) {
  const NoisyTaps::Shares shares = NoisyTaps().estimate(0.1, 0.0, 2);
  EXPECT_NEAR(shares.h2, 1.0, 0.02);
  EXPECT_LT(shares.h1, 0.95);
  EXPECT_LT(shares.coherence, 0.95);
}

TEST(TapEstimate, ByHvLiesBetweenAndIsNearestWhereBothAreNoisy) {
  const NoisyTaps::Shares shares = NoisyTaps().estimate(0.1, 0.07, 3);
  EXPECT_NEAR(shares.hv, 1.0, 0.02);
  EXPECT_LT(shares.h1, 0.95);
  EXPECT_GT(shares.h2, 1.05);
}

TEST(TapEstimate, HasTheResolutionOfItsRecord) {
  const NoisyTaps taps;
  EXPECT_DOUBLE_EQ(taps.clean.resolution_hz, 2.0);
  EXPECT_DOUBLE_EQ(taps.clean.h1.frequencies_hz.front(), 2.0);
  EXPECT_NEAR(taps.clean.h1.frequencies_hz.back(), 0.4 * 4096, 2.0);
  EXPECT_EQ(measured_entries(taps.clean.h1), 2U);
}

TEST(TapEstimate, LeavesBadHitsOutAndSaysWhichWhereNoneIsLeft) {
  const std::vector<HammerPulse> double_hit{{0.2, 500, 0.003}, {0.25, 200, 0.003}};
  const TapRecording bad = tapped(robot_modes(), 2, 1.0, double_hit, 1.5, 4096.0);
  const TapRecording good = tapped(robot_modes(), 2, 1.0, std::vector<HammerPulse>{{0.2, 500, 0.003}}, 1.5, 4096.0);
  const TapSettings settings{.force_axis = 2};
  const TapEstimate alone = estimate_taps(std::vector{good}, settings);
  const TapEstimate both = estimate_taps(std::vector{bad, good}, settings);
  EXPECT_EQ(both.hits.size(), 2U);
  EXPECT_EQ(both.hits[1].recording, 1U);
  EXPECT_EQ(both.hits_used, 1U);
  EXPECT_EQ(both.h1.receptance, alone.h1.receptance);

  const auto refusal = [&](const std::vector<TapRecording>& recordings, const TapSettings& how) {
    try {
      (void)estimate_taps(recordings, how);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal({bad}, settings).find("no hit can be used: at 0.2 s double hit: let the hammer"), 0U)
      << refusal({bad}, settings);
  EXPECT_EQ(refusal({good}, {.force_axis = 2, .trigger_n = 600, .least_peak_n = 600})
                .find("no hit: force stays below the trigger of 600 N, it reaches "),
            0U);
  TapRecording slower = good, fewer = good;
  slower.sample_rate_hz = 2048.0;
  fewer.acceleration[0].clear();
  EXPECT_NE(refusal({good, slower}, settings), "");
  EXPECT_NE(refusal({good, fewer}, settings), "");
  EXPECT_NE(refusal({}, settings), "");
}

}  // namespace
}  // namespace stillcut
