#include "rt/speed_choice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "dsp/numbers.hpp"
#include "models/lobes.hpp"

namespace stillcut {
namespace {

// A diagram of the spindle's range with random limits around the depth of 1 mm: stable and unstable stretches of random
// width, now and then stable or unstable at every depth.
LobeDiagram random_diagram(const SpindleLimits& limits, std::mt19937_64& random) {
  std::uniform_real_distribution<double> depth(0.2e-3, 2e-3), chance(0.0, 1.0);
  LobeDiagram diagram;
  diagram.valid = true;
  diagram.point_count = 101;
  double held = depth(random);
  for (int i = 0; i < diagram.point_count; ++i) {
    if (chance(random) < 0.15) held = depth(random);
    const double special = chance(random);
    diagram.points[i] = {limits.min_speed + (limits.max_speed - limits.min_speed) * i / (diagram.point_count - 1),
                         special < 0.02   ? std::numeric_limits<double>::infinity()
                         : special < 0.04 ? kNaN
                                          : held,
                         0.0};
  }
  return diagram;
}

struct Case {
  SpeedQuestion question;
  LobeDiagram diagram;
  std::vector<double> tried;
};

class RandomCases : public ::testing::Test {
 protected:
  Case next() {
    std::uniform_real_distribution<double> chance(0.0, 1.0);
    Case c;
    SpeedQuestion& q = c.question;
    q.limits = {rpm_to_rad_s(1000 + 9000 * chance(random_)), 0.0, rpm_to_rad_s(3000), rpm_to_rad_s(30000)};
    q.limits.max_speed = q.limits.min_speed * (1.0 + 2.0 * chance(random_));
    q.chatter_frequency_hz = std::pow(10.0, 1.0 + 2.7 * chance(random_));  // 10 Hz to 5 kHz
    q.teeth = 1 + static_cast<int>(6 * chance(random_));
    q.speed = q.limits.min_speed + (q.limits.max_speed - q.limits.min_speed) * chance(random_);
    q.axial_depth = chance(random_) < 0.1 ? kNaN : 1e-3;
    c.diagram = random_diagram(q.limits, random_);
    const int tried = static_cast<int>(4 * chance(random_));
    for (int i = 0; i < tried; ++i) {  // likely ones: they are n_k themselves
      const int k = 1 + static_cast<int>(20 * chance(random_));
      c.tried.push_back(kTwoPi * q.chatter_frequency_hz / (q.teeth * k));
    }
    return c;
  }
  static void connect(Case& c, bool with_lobes) {
    c.question.lobes = with_lobes ? &c.diagram : nullptr;
    c.question.tried = c.tried;
  }

  std::mt19937_64 random_{20250612};
};

// What may be chosen, by the rules of the header and in its plainest words: the oracle.
struct Candidate {
  int k = 0;
  double speed = 0.0, margin = 0.0;
};

std::vector<Candidate> allowed(const SpeedQuestion& q) {
  const auto margin_of = [&](double speed) { return q.lobes ? margin_at(*q.lobes, speed, q.axial_depth) : kNaN; };
  std::vector<Candidate> list;
  for (int k = 1; k < 5000; ++k) {
    const double speed = rpm_to_rad_s(60.0 * q.chatter_frequency_hz / (q.teeth * k));
    if (speed > q.limits.max_speed) continue;
    if (speed < q.limits.min_speed) break;
    if (std::abs(speed - q.speed) < 0.005 * q.speed) continue;
    if (std::any_of(q.tried.begin(), q.tried.end(), [&](double t) { return std::abs(t - speed) < 0.01 * speed; })) {
      continue;
    }
    double margin = margin_of(speed);
    for (const double beside : {0.99, 1.01}) {
      margin = std::min(margin, margin_of(std::clamp(speed * beside, q.limits.min_speed, q.limits.max_speed)));
    }
    if (margin <= margin_of(q.speed)) continue;
    list.push_back({k, speed, margin});
  }
  return list;
}

TEST_F(RandomCases, TargetIsInStepWithTheChatterInsideTheLimitsAndNotPredictedWorse) {
  int found = 0;
  for (int i = 0; i < 20000; ++i) {
    Case c = next();
    connect(c, i % 4 != 0);
    const SpeedQuestion& q = c.question;
    const SpeedChoice choice = choose_speed(q);
    if (!choice.found) continue;
    ++found;
    const double n_rpm = 60.0 * q.chatter_frequency_hz / (q.teeth * choice.lobe);
    EXPECT_NEAR(rad_s_to_rpm(choice.target), n_rpm, 1e-9 * n_rpm);
    EXPECT_GE(choice.target, q.limits.min_speed);
    EXPECT_LE(choice.target, q.limits.max_speed);
    EXPECT_GE(choice.lobe, 1);
    for (const double t : c.tried) EXPECT_GE(std::abs(t - choice.target), 0.01 * choice.target);
    if (q.lobes != nullptr && !std::isnan(choice.margin_before)) {
      EXPECT_GT(choice.margin_after, choice.margin_before);
      EXPECT_GT(margin_at(*q.lobes, choice.target, q.axial_depth), margin_at(*q.lobes, q.speed, q.axial_depth));
    }
    EXPECT_EQ(choice.limited_by, 0);
    EXPECT_GT(choice.confidence_percent, 0);
    EXPECT_LE(choice.confidence_percent, 100);
  }
  EXPECT_GT(found, 5000);
}

TEST_F(RandomCases, NearestStableIsPreferredThenTheMostStable) {
  int stable_chosen = 0, best_of_bad = 0;
  for (int i = 0; i < 20000; ++i) {
    Case c = next();
    c.question.axial_depth = 1e-3;
    connect(c, true);
    const std::vector<Candidate> candidates = allowed(c.question);
    const SpeedChoice choice = choose_speed(c.question);
    ASSERT_EQ(choice.found, !candidates.empty());
    if (candidates.empty()) continue;
    const auto distance = [&](const Candidate& a) { return std::abs(a.speed - c.question.speed); };
    std::vector<Candidate> stable;
    std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(stable),
                 [](const Candidate& a) { return a.margin > 0.0; });
    const Candidate wanted =
        stable.empty() ? *std::max_element(candidates.begin(), candidates.end(),
                                           [](const auto& a, const auto& b) { return a.margin < b.margin; })
                       : *std::min_element(stable.begin(), stable.end(),
                                           [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
    EXPECT_EQ(choice.margin_after > 0.0, !stable.empty());
    if (stable.empty()) {
      EXPECT_EQ(choice.margin_after, wanted.margin);  // of equal ones any
      ++best_of_bad;
    } else {
      EXPECT_EQ(choice.lobe, wanted.k);
      ++stable_chosen;
    }
  }
  EXPECT_GT(stable_chosen, 1000);
  EXPECT_GT(best_of_bad, 100);
}

TEST_F(RandomCases, WithoutADiagramTheNearestIsChosen) {
  int found = 0;
  for (int i = 0; i < 5000; ++i) {
    Case c = next();
    connect(c, false);
    const std::vector<Candidate> candidates = allowed(c.question);
    const SpeedChoice choice = choose_speed(c.question);
    ASSERT_EQ(choice.found, !candidates.empty());
    if (candidates.empty()) continue;
    ++found;
    for (const Candidate& other : candidates) {
      EXPECT_LE(std::abs(choice.target - c.question.speed), std::abs(other.speed - c.question.speed) * (1.0 + 1e-12));
    }
    EXPECT_TRUE(std::isnan(choice.margin_before));
    EXPECT_TRUE(std::isnan(choice.margin_after));
  }
  EXPECT_GT(found, 1000);
}

TEST_F(RandomCases, WhereNothingMayBeChosenItSaysSo) {
  int none = 0;
  for (int i = 0; i < 20000; ++i) {
    Case c = next();
    connect(c, i % 4 != 0);
    if (!allowed(c.question).empty()) continue;
    const SpeedChoice choice = choose_speed(c.question);
    ASSERT_FALSE(choice.found);
    EXPECT_EQ(choice.limited_by, kNoStableSettingKnown | kLimitedBySpeedRange);
    EXPECT_EQ(choice.confidence_percent, 0);
    ++none;
  }
  EXPECT_GT(none, 500);
}

TEST(SpeedChoice, QuestionsWithoutAnAnswerAreToldNotComputed) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const SpeedQuestion good{750.0,   2, rpm_to_rad_s(9000), 1e-3, {rpm_to_rad_s(6000), rpm_to_rad_s(12000), 300, 3000},
                           nullptr, {}};
  ASSERT_TRUE(choose_speed(good).found);
  std::vector<SpeedQuestion> bad(11, good);
  bad[0].chatter_frequency_hz = kNaN;
  bad[1].chatter_frequency_hz = kInf;
  bad[2].chatter_frequency_hz = 0.0;
  bad[3].chatter_frequency_hz = -750.0;
  bad[4].teeth = 0;
  bad[5].speed = kNaN;
  bad[6].speed = 0.0;
  bad[7].limits = {};
  bad[8].limits.max_speed = kNaN;
  bad[9].teeth = -2;
  bad[10].chatter_frequency_hz = 1e300;
  for (std::size_t i = 0; i < bad.size(); ++i) {
    const SpeedChoice choice = choose_speed(bad[i]);
    EXPECT_FALSE(choice.found) << i;
    EXPECT_NE(choice.limited_by & kNoStableSettingKnown, 0) << i;
  }
}

}  // namespace
}  // namespace stillcut
