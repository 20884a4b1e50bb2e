// Which hits are found and which are refused. Each hit here is one that a threshold left out, or taken the wrong way
// round, would judge otherwise.
#include "models/tap_hits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/models/tapped_structure.hpp"

namespace stillcut {
namespace {

constexpr double kRate = 4000.0;

const std::vector<Mode>& beaten() {
  static const std::vector<Mode> modes{{kTwoPi * 40.0, 0.05, 2e6, {0.8, 0.6, 0.0}}};
  return modes;
}

TapRecording hit_at(const std::vector<HammerPulse>& pulses, double seconds) {
  return tapped(beaten(), 0, 1.0, pulses, seconds, kRate);
}

std::vector<TapFault> faults(const TapRecording& recording, const TapSettings& settings) {
  std::vector<TapFault> result;
  for (const TapHit& hit : find_hits(recording, settings)) result.push_back(hit.fault);
  return result;
}

std::string refusal(const TapRecording& recording, const TapSettings& settings = {}) {
  try {
    require_sound_taps(recording, settings);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(TapHits, AreFoundWhereTheForceRises) {
  const std::vector<HammerPulse> pulses{{0.5, 400, 0.004}, {2.0, 900, 0.003}, {3.7, 250, 0.006}};
  const std::vector<TapHit> hits = find_hits(hit_at(pulses, 5.0), {});
  ASSERT_EQ(hits.size(), pulses.size());
  for (std::size_t i = 0; i < pulses.size(); ++i) {
    EXPECT_EQ(hits[i].fault, TapFault::none) << i;
    const double at_s = static_cast<double>(hits[i].at) / kRate;
    EXPECT_GT(at_s, pulses[i].at_s);
    EXPECT_LT(at_s, pulses[i].at_s + 0.3 * pulses[i].duration_s);
    EXPECT_NEAR(hits[i].peak_n, pulses[i].peak_n, 0.01 * pulses[i].peak_n);
  }
}

TEST(TapHits, ThatReboundAnywhereInTheRecordAreDouble) {
  for (const double later_s : {0.006, 0.015, 0.1, 0.5, 0.97})
    EXPECT_EQ(faults(hit_at({{0.5, 500, 0.004}, {0.5 + later_s, 60, 0.004}, {2.5, 500, 0.004}}, 4.0), {}),
              (std::vector{TapFault::double_hit, TapFault::none}))
        << later_s;
}

TEST(TapHits, FollowedByLessThanTheShareOfAReboundAreSound) {
  EXPECT_EQ(faults(hit_at({{0.5, 1000, 0.004}, {0.6, 40, 0.004}}, 2.0), {}), std::vector{TapFault::none});
  EXPECT_EQ(faults(hit_at({{0.5, 1000, 0.004}, {0.6, 60, 0.004}}, 2.0), {}), std::vector{TapFault::double_hit});
}

TEST(TapHits, AreSoundAgainOnceTheRecordBeforeIsOver) {
  EXPECT_EQ(faults(hit_at({{0.5, 500, 0.004}, {1.51, 500, 0.004}}, 3.0), {}),
            (std::vector{TapFault::none, TapFault::none}));
}

TEST(TapHits, BeyondTheRangeOfHammerOrSensorAreRefused) {
  const TapRecording recording = hit_at({{0.5, 500, 0.004}, {2.5, 300, 0.004}}, 4.0);
  TapRecording told = recording;
  told.response_overloads = {find_hits(recording, {})[1].at + 1};
  EXPECT_EQ(faults(told, {}), (std::vector{TapFault::none, TapFault::response_overload}));
  told.force_overloads = {find_hits(recording, {})[0].at};
  EXPECT_EQ(faults(told, {}), (std::vector{TapFault::force_overload, TapFault::response_overload}));
  EXPECT_EQ(faults(recording, {.force_full_scale_n = 500}), (std::vector{TapFault::force_overload, TapFault::none}));
  double loudest = 0.0;
  for (const double value : recording.acceleration[1]) loudest = std::max(loudest, std::abs(value));
  TapRecording one_axis = recording;
  one_axis.acceleration[0].clear();
  EXPECT_EQ(faults(one_axis, {.acceleration_full_scale_m_per_s2 = loudest}),
            (std::vector{TapFault::response_overload, TapFault::none}));
  EXPECT_EQ(faults(one_axis, {.acceleration_full_scale_m_per_s2 = 1.1 * loudest}),
            (std::vector{TapFault::none, TapFault::none}));
}

TEST(TapHits, ThatAreTooWeakTooLongOrCutOffAreRefused) {
  EXPECT_EQ(faults(hit_at({{0.5, 90, 0.004}, {2.0, 110, 0.004}}, 4.0), {}),
            (std::vector{TapFault::too_weak, TapFault::none}));
  EXPECT_EQ(faults(hit_at({{0.5, 300, 0.04}, {2.0, 300, 0.018}}, 4.0), {}),
            (std::vector{TapFault::too_long, TapFault::none}));
  EXPECT_EQ(faults(hit_at({{0.005, 300, 0.004}, {2.0, 300, 0.004}}, 2.9), {}),
            (std::vector{TapFault::cut_off, TapFault::cut_off}));
}

TEST(TapHits, AreNoneBelowTheTrigger) { EXPECT_TRUE(faults(hit_at({{0.5, 19, 0.004}}, 2.0), {}).empty()); }

TEST(TapHits, InUnsoundRecordingsAreRefusedInWords) {
  const TapRecording sound = hit_at({{0.5, 500, 0.004}}, 2.0);
  EXPECT_EQ(refusal(sound).find("acceleration z is zero throughout"), 0U);
  TapRecording recording = sound;
  recording.acceleration[2].clear();
  EXPECT_EQ(refusal(recording), "");
  TapRecording other = recording;
  other.acceleration[1][17] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal(other), "acceleration y is not finite at sample 17: record again");
  other = recording;
  other.acceleration[0].pop_back();
  EXPECT_EQ(refusal(other), "acceleration x has 7999 samples, force has 8000: record them together");
  other = recording;
  for (double& value : other.force) value = -value;
  EXPECT_NE(refusal(other).find("turn the hammer's sign"), std::string::npos);
  other = recording;
  for (std::vector<double>& values : other.acceleration) values.clear();
  EXPECT_NE(refusal(other), "");
  other = recording;
  other.sample_rate_hz = 0.0;
  EXPECT_NE(refusal(other), "");
  EXPECT_NE(refusal(recording, {.end_weight = 0.0}), "");
  EXPECT_NE(refusal(recording, {.trigger_n = 200.0}), "");
  EXPECT_NE(refusal(recording, {.highest_of_rate = 0.5}), "");
}

TEST(TapHits, HaveRecordsThatTransformQuickly) {
  EXPECT_EQ(record_samples({.record_s = 1.0}, 4000.0), 4000U);
  EXPECT_EQ(record_samples({.record_s = 1.0}, 4099.0), 4096U);  // 4099 is prime
  EXPECT_THROW((void)record_samples({.record_s = 0.01}, 4000.0), std::invalid_argument);
}

}  // namespace
}  // namespace stillcut
