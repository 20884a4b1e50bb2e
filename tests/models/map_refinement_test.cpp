// A map that is off is found off by as much as it is, and a sound one sound. Heard frequencies come from the Floquet
// solution here; tests/tools/command_refine_test takes them from cuts simulated in time.
#include "models/map_refinement.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "models/floquet.hpp"
#include "tests/models/stability_cases.hpp"

namespace stillcut {
namespace {

// A cut that chatters, one of its aliases, and a map with one mode off.
struct OffMap {
  test::StabilityCase truth;
  HeardChatter heard;
  std::size_t off = 0;
  double ratio = 1.0;  // true over mapped
  std::vector<Mode> map;
};

std::optional<OffMap> random_off_map(std::mt19937_64& random) {
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  OffMap one{.truth = test::random_case(random), .heard = {}, .off = 0, .ratio = 1.0, .map = {}};
  one.heard.spindle_speed = rpm_to_rad_s(uniform(3000, 12000));
  const DepthLimit limit =
      floquet_depth_limit(one.truth.cut, one.truth.modes, one.heard.spindle_speed, {.max_depth = 0.01});
  if (!std::isfinite(limit.depth) || limit.instability != Instability::hopf) return {};
  one.heard.axial_depth = limit.depth * uniform(1.05, 1.5);
  const FloquetPoint point =
      floquet_point(one.truth.cut, one.truth.modes, one.heard.spindle_speed, one.heard.axial_depth);
  if (point.instability != Instability::hopf) return {};
  one.heard.frequency = point.chatter_frequency;
  for (std::size_t m = 1; m < one.truth.modes.size(); ++m) {
    const auto distance = [&](std::size_t i) {
      return std::abs(one.truth.modes[i].natural_frequency - one.heard.frequency);
    };
    if (distance(m) < distance(one.off)) one.off = m;
  }
  one.ratio = 1.0 + uniform(-0.03, 0.03);
  one.map = one.truth.modes;
  one.map[one.off].natural_frequency /= one.ratio;
  return one;
}

TEST(ShiftOfMode, IsThatWhichTheMapIsOffBy) {
  std::mt19937_64 random(7);
  int asked = 0, told = 0, right = 0;
  while (asked < 60) {
    const auto one = random_off_map(random);
    if (!one) continue;
    ++asked;
    const auto shift = shift_of_mode(one->truth.cut, one->map, one->heard);
    if (!shift) continue;
    ++told;
    if (shift->mode == one->off && std::abs(shift->ratio - one->ratio) < 1e-3) ++right;
  }
  EXPECT_GE(told, 30);              // of 60; the others leave it open, and say so
  EXPECT_GE(right, told * 9 / 10);  // a neighbour may explain a frequency as well
}

TEST(ShiftOfMode, IsNoneOnASoundMap) {
  std::mt19937_64 random(8);
  for (int told = 0; told < 20;) {
    const auto one = random_off_map(random);
    if (!one) continue;
    const auto shift = shift_of_mode(one->truth.cut, one->truth.modes, one->heard);
    if (!shift) continue;
    EXPECT_NEAR(shift->ratio, 1.0, 1e-4);
    ++told;
  }
}

TEST(ShiftOfMode, KnowsAnAliasAndItsMirror) {
  const test::StabilityCase one{test::cut_of(2, Milling::down, 0.5, 8e8, 3e8), {test::mode_of(500, 0.03, 2e7, 1, 0)}};
  std::vector<Mode> map = one.modes;
  map[0].natural_frequency *= 1.01;
  int speeds = 0;
  for (double rpm = 4000; rpm < 9000; rpm += 100) {
    const double speed = rpm_to_rad_s(rpm), passing = 2.0 * speed;
    const DepthLimit limit = floquet_depth_limit(one.cut, one.modes, speed, {.max_depth = 0.05});
    const FloquetPoint point = floquet_point(one.cut, one.modes, speed, 1.2 * limit.depth);
    const double own = point.chatter_frequency, mirrored = std::round(2.0 * own / passing) * passing - own;
    // Near half the tooth-passing frequency an alias and its mirror are too near to each other.
    if (point.instability != Instability::hopf || std::abs(mirrored - own) < 0.3 * passing) continue;
    const bool told = shift_of_mode(one.cut, map, {speed, 1.2 * limit.depth, own}).has_value();
    speeds += told ? 1 : 0;
    for (const double heard : {own, own + passing, mirrored}) {
      const auto shift = shift_of_mode(one.cut, map, {speed, 1.2 * limit.depth, heard});
      EXPECT_EQ(shift.has_value(), told) << rpm << " " << heard;
      if (!shift) continue;
      EXPECT_NEAR(shift->ratio, 1.0 / 1.01, 1e-4);
    }
  }
  EXPECT_GE(speeds, 5);
}

TEST(ShiftOfMode, LeavesOpenWhatAFrequencyCannotTell) {
  const test::StabilityCase one{test::cut_of(2, Milling::down, 0.5, 8e8, 3e8), {test::mode_of(500, 0.03, 2e7, 1, 0)}};
  const double speed = rpm_to_rad_s(5000);
  const DepthLimit limit = floquet_depth_limit(one.cut, one.modes, speed, {.max_depth = 0.05});
  // Too far from anything that a small shift explains.
  EXPECT_FALSE(shift_of_mode(one.cut, one.modes, {speed, limit.depth, 1.08 * limit.chatter_frequency}));
  // Two modes that swing alike: one cannot be told from the other.
  const std::vector<Mode> twins{test::mode_of(500, 0.03, 2e7, 1, 0), test::mode_of(500.5, 0.03, 2e7, 1, 0)};
  const DepthLimit both = floquet_depth_limit(one.cut, twins, speed, {.max_depth = 0.05});
  EXPECT_FALSE(shift_of_mode(one.cut, twins, {speed, both.depth, 1.005 * both.chatter_frequency}));
  // A flip stands at half the tooth-passing frequency wherever the mode is.
  for (double rpm = 3000; rpm < 40000; rpm += 250) {
    const DepthLimit flip = floquet_depth_limit(one.cut, one.modes, rpm_to_rad_s(rpm), {.max_depth = 0.05});
    if (flip.instability != Instability::flip || !std::isfinite(flip.depth)) continue;
    EXPECT_FALSE(shift_of_mode(one.cut, one.modes, {rpm_to_rad_s(rpm), 1.02 * flip.depth, flip.chatter_frequency}));
    return;
  }
  FAIL() << "no flip lobe was met";
}

std::vector<ShiftObservation> scattered(std::size_t count, double ratio, double scatter, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<> normal(ratio, scatter);
  std::vector<ShiftObservation> observations;
  for (std::size_t i = 0; i < count; ++i) observations.push_back({2, 1, normal(random)});
  return observations;
}

TEST(WeighShifts, ProposesWhatExceedsTheScatterAndHardlyEverAnythingElse) {
  int false_proposals = 0, found = 0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    false_proposals += weigh_shifts(scattered(10, 1.0, 0.01, seed), {})[0].proposed ? 1 : 0;
    const ModeEvidence off = weigh_shifts(scattered(10, 0.98, 0.005, seed), {})[0];
    if (!off.proposed) continue;
    ++found;
    EXPECT_NEAR(off.ratio, 0.98, 0.01);
  }
  EXPECT_LE(false_proposals, 20);
  EXPECT_GE(found, 980);
}

TEST(WeighShifts, TakesTheMedianOfEachModeAndAsksForEnough) {
  std::vector<ShiftObservation> some{{0, 4, 0.97}, {0, 4, 0.971}, {1, 4, 1.03}, {0, 4, 0.969}, {0, 2, 1.0}};
  const auto few = weigh_shifts(some, {});
  ASSERT_EQ(few.size(), 3U);
  EXPECT_EQ(few[0].mode, 2U);
  EXPECT_EQ(few[1].observations, 3U);
  EXPECT_DOUBLE_EQ(few[1].ratio, 0.97);
  for (const ModeEvidence& one : few) EXPECT_FALSE(one.proposed);
  some.insert(some.end(), {{0, 4, 0.9705}, {0, 4, 1.04}});  // the latter astray
  const auto enough = weigh_shifts(some, {});
  EXPECT_TRUE(enough[1].proposed);
  EXPECT_DOUBLE_EQ(enough[1].ratio, 0.9705);
  EXPECT_FALSE(weigh_shifts(some, {.least_observations = 6})[1].proposed);
}

}  // namespace
}  // namespace stillcut
