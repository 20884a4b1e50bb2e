#include "rt/variation_choice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "dsp/numbers.hpp"
#include "tests/rt/choice_cases.hpp"
#include "tests/rt/monitor_script.hpp"

namespace stillcut {
namespace {

struct SwingCase {
  CompensationLimits limits;
  KeptPrediction kept;
  double speed = 0.0, programmed_speed = 0.0;

  [[nodiscard]] VariationQuestion question() const { return {speed, programmed_speed, kept.view()}; }
};

class RandomSwings : public ::testing::Test {
 protected:
  SwingCase next() {
    SwingCase c;
    c.limits = cases_.limits();
    c.limits.max_variation = cases_.chance(0.1) ? 0.0 : cases_.between(0.0, 0.4);
    c.limits.max_variation_hz = cases_.between(0.2, 5.0);
    c.limits.spindle_time_constant_s = cases_.between(0.02, 1.0);
    c.kept = random_prediction(cases_, c.limits.spindle);
    c.speed = cases_.speed_in(c.limits);
    c.programmed_speed = cases_.chance(0.7) ? c.speed : cases_.speed_in(c.limits);
    return c;
  }

  ChoiceCases cases_{7};
};

// Share of a slow sine that a first-order lag lets through.
double let_through(double frequency_hz, double time_constant_s) {
  return 1.0 / std::hypot(1.0, kTwoPi * frequency_hz * time_constant_s);
}

// 1 / mean(a / a_lim) - 1 over so many phases of what the spindle really does.
double mean_margin(const SwingCase& c, double mean, double ratio, double frequency_hz, int phases) {
  const double swung = ratio * let_through(frequency_hz, c.limits.spindle_time_constant_s);
  double sum = 0.0;
  for (int i = 0; i < phases; ++i) {
    const double speed = mean * (1.0 + swung * std::sin(kTwoPi * (i + 0.5) / phases));
    const double of_limit = margin_at(c.kept.view(), speed) + 1.0;
    sum += of_limit == 0.0 ? kInfinity : 1.0 / of_limit;
  }
  return sum == 0.0 ? kInfinity : phases / sum - 1.0;
}

bool swing_fits(const SwingCase& c, double mean, double ratio) {
  return std::ranges::all_of(
      std::initializer_list<double>{mean * (1.0 - ratio), mean, mean * (1.0 + ratio)}, [&](double speed) {
        return spindle_may_stay(c.limits, speed) && tooth_may_take(c.limits, speed, c.programmed_speed);
      });
}

TEST_F(RandomSwings, SwingStaysInsideTheRangeTheWindowAndWhatTheSpindleCan) {
  int found = 0;
  for (int i = 0; i < 3000; ++i) {
    const SwingCase c = next();
    const VariationChoice choice = choose_variation(c.question(), c.limits);
    if (!choice.found) continue;
    ++found;
    EXPECT_GT(choice.ratio, 0.0);
    EXPECT_LE(choice.ratio, c.limits.max_variation);
    const double swing = choice.mean * choice.ratio, turn = kTwoPi * choice.frequency_hz;
    EXPECT_GE(choice.mean - swing, c.limits.spindle.min_speed * (1.0 - 1e-12));
    EXPECT_LE(choice.mean + swing, c.limits.spindle.max_speed * (1.0 + 1e-12));
    // In a dead zone the spindle does not stay: neither at the mean nor where it turns.
    EXPECT_TRUE(swing_fits(c, choice.mean, choice.ratio * (1.0 - 1e-12)));
    EXPECT_GT(choice.frequency_hz, 0.0);
    EXPECT_LE(choice.frequency_hz, c.limits.max_variation_hz);
    EXPECT_LE(swing * turn, c.limits.spindle.acceleration * (1.0 + 1e-9));
    EXPECT_LE(swing * turn * turn, c.limits.spindle.jerk * (1.0 + 1e-9));
    EXPECT_GE(let_through(choice.frequency_hz, c.limits.spindle_time_constant_s), 0.7 - 1e-9);
  }
  EXPECT_GT(found, 500);
}

TEST_F(RandomSwings, AnyFasterSwingIsMoreThanTheSpindleCan) {
  for (int i = 0; i < 3000; ++i) {
    const SwingCase c = next();
    const double ratio = cases_.between(0.01, 0.3), faster = 1.01 * fastest_swing_hz(c.limits, c.speed, ratio);
    const double swing = c.speed * ratio, turn = kTwoPi * faster;
    EXPECT_TRUE(swing * turn > c.limits.spindle.acceleration || swing * turn * turn > c.limits.spindle.jerk ||
                let_through(faster, c.limits.spindle_time_constant_s) < 0.7 || faster > c.limits.max_variation_hz);
  }
}

TEST_F(RandomSwings, MarginIsThatOfTheMeanOverTheSwingAndBetterThanThePresentOne) {
  int found = 0;
  for (int i = 0; i < 3000; ++i) {
    const SwingCase c = next();
    const VariationChoice choice = choose_variation(c.question(), c.limits);
    const double before = margin_at(c.kept.view(), c.speed);
    EXPECT_TRUE(choice.margin_before == before || (std::isnan(choice.margin_before) && std::isnan(before)));
    if (!choice.found || std::isnan(before)) continue;
    ++found;
    EXPECT_GT(choice.margin_after, before);
    // A mean over 24 phases may miss a narrow stretch of the diagram, or weigh it twice.
    const double wanted = mean_margin(c, choice.mean, choice.ratio, choice.frequency_hz, 24);
    if (std::isinf(wanted)) {
      EXPECT_EQ(choice.margin_after, wanted);
    } else {
      EXPECT_NEAR(choice.margin_after, wanted, 1e-9 * (1.0 + wanted));
    }
  }
  EXPECT_GT(found, 300);
}

// A diagram without jumps: then the phases that are looked at are enough.
TEST(VariationChoice, MarginAgreesWithTheMeanOverManyPhases) {
  SwingCase c;
  c.limits.spindle = spindle_6000_to_12000();
  std::vector<double> waves;
  for (int i = 0; i < 251; ++i) waves.push_back(0.8 + 0.5 * std::sin(i * 0.05));
  c.kept.here = diagram_of(waves, c.limits.spindle);
  c.speed = c.programmed_speed = rpm_to_rad_s(6000 + 6000 * 94 / 250.0);  // the worst speed
  const VariationChoice choice = choose_variation(c.question(), c.limits);
  ASSERT_TRUE(choice.found);
  const double wanted = mean_margin(c, choice.mean, choice.ratio, choice.frequency_hz, 100000);
  EXPECT_NEAR(choice.margin_after, wanted, 0.02 * (1.0 + wanted));
}

TEST_F(RandomSwings, NoSwingOfAGridIsBetter) {
  constexpr double kGridRatios[] = {0.05, 0.1, 0.15, 0.2, 0.3};
  int found = 0, none = 0;
  for (int i = 0; i < 400; ++i) {
    SwingCase c = next();
    if (!c.kept.here || std::isnan(c.kept.axial_depth)) continue;
    const double before = margin_at(c.kept.view(), c.speed);
    if (std::isnan(before)) continue;
    double best = before + 0.1;  // what is worth a swing
    for (const double ratio : kGridRatios)
      for (int step = 0; step <= 40; ++step) {
        const double low = c.limits.spindle.min_speed, high = c.limits.spindle.max_speed;
        const double mean = low + (high - low) * step / 40.0;
        if (ratio > c.limits.max_variation || !swing_fits(c, mean, ratio)) continue;
        const double margin = mean_margin(c, mean, ratio, fastest_swing_hz(c.limits, mean, ratio), 24);
        if (!std::isnan(margin)) best = std::max(best, margin);
      }
    const VariationChoice choice = choose_variation(c.question(), c.limits);
    if (best > before + 0.1 + 1e-9) {
      ASSERT_TRUE(choice.found);
    }
    if (choice.found) {
      EXPECT_FALSE(choice.margin_after < best - 1e-9);
    }
    ++(choice.found ? found : none);
  }
  EXPECT_GT(found, 50);
  EXPECT_GT(none, 50);
}

TEST_F(RandomSwings, WithoutAPredictionASwingOfATenthAboutThePresentSpeed) {
  int found = 0;
  for (int i = 0; i < 2000; ++i) {
    SwingCase c = next();
    c.kept = {};
    const double ratio = std::min(0.1, c.limits.max_variation);
    const VariationChoice choice = choose_variation(c.question(), c.limits);
    if (ratio > 0.0 && swing_fits(c, c.speed, ratio)) {
      ASSERT_TRUE(choice.found);
      EXPECT_EQ(choice.mean, c.speed);
    }
    if (!choice.found) continue;
    ++found;
    EXPECT_EQ(choice.ratio, ratio);
    EXPECT_TRUE(std::isnan(choice.margin_before));
    EXPECT_TRUE(std::isnan(choice.margin_after));
  }
  EXPECT_GT(found, 500);
}

TEST_F(RandomSwings, WithoutAPredictionTheMeanGivesWayToTheRangeOnly) {
  int moved = 0;
  for (int i = 0; i < 2000; ++i) {
    SwingCase c = next();
    c.kept = {};
    c.limits.avoided_count = 0;
    c.limits.feed_per_tooth = 0.0;
    const double ratio = std::min(0.1, c.limits.max_variation);
    const double low = c.limits.spindle.min_speed / (1.0 - ratio), high = c.limits.spindle.max_speed / (1.0 + ratio);
    const VariationChoice choice = choose_variation(c.question(), c.limits);
    if (ratio == 0.0 || std::abs(high - low) < 1e-9 * low) continue;
    ASSERT_EQ(choice.found, low < high);
    if (!choice.found) continue;
    EXPECT_NEAR(choice.mean, std::clamp(c.speed, low, high), 1e-9 * c.speed);
    moved += c.speed < low || c.speed > high ? 1 : 0;
  }
  EXPECT_GT(moved, 100);
}

TEST(VariationChoice, ASpindleThatCannotVaryIsNotAskedTo) {
  SwingCase c;
  c.limits.spindle = spindle_6000_to_12000();
  c.limits.max_variation = 0.0;
  c.speed = c.programmed_speed = rpm_to_rad_s(9000);
  EXPECT_FALSE(choose_variation(c.question(), c.limits).found);
  std::vector<double> dip(61, 2.0);
  dip[30] = 0.5;
  c.kept.here = diagram_of(dip, c.limits.spindle);
  EXPECT_FALSE(choose_variation(c.question(), c.limits).found);
  c.limits.max_variation = 0.2;
  EXPECT_TRUE(choose_variation(c.question(), c.limits).found);
}

TEST(VariationChoice, QuestionsWithoutAnAnswerFindNothing) {
  CompensationLimits limits;
  limits.spindle = spindle_6000_to_12000();
  const double speed = rpm_to_rad_s(9000);
  ASSERT_TRUE(choose_variation({speed, speed, {}}, limits).found);
  for (const double bad : {0.0, -speed, kNaN}) {
    EXPECT_FALSE(choose_variation({bad, speed, {}}, limits).found);
    EXPECT_FALSE(choose_variation({speed, bad, {}}, limits).found);
  }
  limits.spindle = {};
  EXPECT_FALSE(choose_variation({speed, speed, {}}, limits).found);
}

}  // namespace
}  // namespace stillcut
