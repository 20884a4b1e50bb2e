#include "tools/tuning_score.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace stillcut {
namespace {

using LabelKind = ChatterKind;
using Stretches = std::vector<ChatterStretch>;

LogHearing hearing_of(std::vector<HeardOnset> onsets) { return {std::move(onsets), {{0.0, 100.0}}}; }

TEST(TuningScore, AnOnsetInAStretchDetectsItFromATenthBefore) {
  const Stretches stretches{{{10.0, 12.0}, LabelKind::regenerative}};
  for (const double time_s : {9.95, 10.0, 11.0, 12.0}) {
    const DetectionScore score = score_log(stretches, hearing_of({{time_s, LabelKind::unknown}}));
    EXPECT_EQ(score.detected, 1) << time_s;
    EXPECT_EQ(score.false_alarms, 0) << time_s;
    EXPECT_NEAR(score.delay_median_s(), time_s - 10.0, 1e-12);
  }
  EXPECT_EQ(score_log(stretches, hearing_of({{9.85, LabelKind::regenerative}})).detected, 0);
  EXPECT_EQ(score_log(stretches, hearing_of({{9.85, LabelKind::regenerative}})).false_alarms, 1);
}

TEST(TuningScore, WhatFollowsAStretchAtOnceIsNeitherFoundNorFalse) {
  const Stretches stretches{{{10.0, 12.0}, LabelKind::unknown}};
  const DetectionScore fading = score_log(stretches, hearing_of({{12.15, LabelKind::unknown}}));
  EXPECT_EQ(fading.detected, 0);
  EXPECT_EQ(fading.false_alarms, 0);
  EXPECT_EQ(score_log(stretches, hearing_of({{12.25, LabelKind::unknown}})).false_alarms, 1);
}

TEST(TuningScore, ManyOnsetsDetectAStretchOnceAndTheFirstCounts) {
  const Stretches stretches{{{10.0, 12.0}, LabelKind::unknown}};
  const DetectionScore score = score_log(
      stretches, hearing_of({{10.3, LabelKind::unknown}, {10.8, LabelKind::regenerative}, {11.9, LabelKind::unknown}}));
  EXPECT_EQ(score.detected, 1);
  EXPECT_EQ(score.false_alarms, 0);
  ASSERT_EQ(score.delays_s.size(), 1U);
  EXPECT_NEAR(score.delays_s[0], 0.3, 1e-12);
}

TEST(TuningScore, AnOnsetLateInAStretchIsNotAnEarlyOneOfTheNext) {
  const Stretches stretches{{{10.0, 12.0}, LabelKind::unknown}, {{12.05, 13.0}, LabelKind::unknown}};
  EXPECT_EQ(score_log(stretches, hearing_of({{11.98, LabelKind::unknown}})).detected, 1);
  EXPECT_EQ(score_log(stretches, hearing_of({{12.02, LabelKind::unknown}})).detected, 1);
}

TEST(TuningScore, ChatterOfTheStructureCountsForItsOwnStretchesOnly) {
  const LogHearing structural = hearing_of({{10.5, LabelKind::structural}});
  EXPECT_EQ(score_log(Stretches{{{10.0, 12.0}, LabelKind::structural}}, structural).detected, 1);
  for (const LabelKind kind : {LabelKind::regenerative, LabelKind::unknown}) {
    const DetectionScore score = score_log(Stretches{{{10.0, 12.0}, kind}}, structural);
    EXPECT_EQ(score.detected, 0);
    EXPECT_EQ(score.false_alarms, 1);
  }
  // The kind that the tool's own detector gives is taken as it comes.
  EXPECT_EQ(
      score_log(Stretches{{{10.0, 12.0}, LabelKind::structural}}, hearing_of({{10.5, LabelKind::unknown}})).detected,
      1);
}

TEST(TuningScore, SoundTimeIsTheCutOutsideTheStretchesAndTheirRims) {
  const LogHearing hearing{{}, {{1.0, 4.0}, {6.0, 8.0}, {20.0, 21.0}}};
  EXPECT_NEAR(score_log({}, hearing).sound_s, 6.0, 1e-12);
  const Stretches stretches{{{2.0, 3.0}, LabelKind::unknown}, {{6.05, 9.0}, LabelKind::unknown}};
  EXPECT_NEAR(score_log(stretches, hearing).sound_s, 0.9 + 0.8 + 0.0 + 1.0, 1e-12);
}

TEST(TuningScore, FiguresThatDoNotApplyAreNotANumberAndARateWithoutTimeIsInfinite) {
  const DetectionScore none;
  EXPECT_TRUE(std::isnan(none.detected_percent()));
  EXPECT_TRUE(std::isnan(none.delay_median_s()));
  EXPECT_TRUE(std::isnan(none.delay_p95_s()));
  EXPECT_EQ(none.false_alarms_per_hour(), 0.0);
  EXPECT_TRUE(std::isinf(DetectionScore{.false_alarms = 1}.false_alarms_per_hour()));
  EXPECT_NEAR((DetectionScore{.false_alarms = 3, .sound_s = 1800.0}.false_alarms_per_hour()), 6.0, 1e-12);
}

TEST(TuningScore, MedianAndNinetyFifthPercentileAreThoseOfTheSortedDelays) {
  DetectionScore score;
  for (int i = 100; i >= 1; --i) score.delays_s.push_back(i);
  EXPECT_EQ(score.delay_median_s(), 50.5);
  EXPECT_EQ(score.delay_p95_s(), 95.0);
  score.delays_s = {0.3, -0.05, 0.1};
  EXPECT_EQ(score.delay_median_s(), 0.1);
  EXPECT_EQ(score.delay_p95_s(), 0.3);
  score.delays_s = {0.2};
  EXPECT_EQ(score.delay_p95_s(), 0.2);
}

LabelKind random_kind(std::mt19937_64& random) { return static_cast<LabelKind>(random() % 3); }

// The rules again, as sentences about single onsets and stretches; time is counted on a fine grid.
TEST(TuningScore, AgreesWithTheRulesSpelledOutOnRandomLogs) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> time(0.0, 10.0), length(0.05, 1.5);
  for (int round = 0; round < 300; ++round) {
    Stretches stretches;
    LogHearing hearing;
    for (std::size_t i = random() % 4; i > 0; --i) {
      const double from_s = time(random);
      stretches.push_back({{from_s, from_s + length(random)}, random_kind(random)});
    }
    for (std::size_t i = random() % 12; i > 0; --i) hearing.onsets.push_back({time(random), random_kind(random)});
    for (double at = length(random); at < 10.0; at += 0.1 + length(random)) {
      const double end = at + length(random);
      hearing.in_cut.push_back({at, end});
      at = end;
    }
    const auto fits = [](const HeardOnset& o, const ChatterStretch& s, double before, double after) {
      return (o.kind != LabelKind::structural || s.kind == LabelKind::structural) &&
             o.time_s >= s.time.from_s - before && o.time_s <= s.time.to_s + after;
    };
    const auto any_fits = [&](const HeardOnset& o, double before, double after) {
      return std::any_of(stretches.begin(), stretches.end(), [&](const auto& s) { return fits(o, s, before, after); });
    };
    DetectionScore expected;
    for (const ChatterStretch& s : stretches) {
      double first = std::numeric_limits<double>::infinity();
      for (const HeardOnset& o : hearing.onsets) {
        const bool early = fits(o, s, 0.1, -s.time.to_s + s.time.from_s) && !any_fits(o, 0.0, 0.0);
        if (fits(o, s, 0.0, 0.0) || early) first = std::min(first, o.time_s);
      }
      if (std::isfinite(first)) expected.delays_s.push_back(first - s.time.from_s);
    }
    for (const HeardOnset& o : hearing.onsets) expected.false_alarms += any_fits(o, 0.1, 0.2) ? 0 : 1;
    constexpr double kStep = 1e-3;
    for (double at = 0.5 * kStep; at < 14.0; at += kStep) {
      const bool cut = std::any_of(hearing.in_cut.begin(), hearing.in_cut.end(),
                                   [&](const LogSpan& span) { return at >= span.from_s && at < span.to_s; });
      const bool out = std::any_of(stretches.begin(), stretches.end(), [&](const ChatterStretch& s) {
        return at >= s.time.from_s - 0.1 && at <= s.time.to_s + 0.2;
      });
      if (cut && !out) expected.sound_s += kStep;
    }
    const DetectionScore score = score_log(stretches, hearing);
    ASSERT_EQ(score.stretches, static_cast<int>(stretches.size()));
    ASSERT_EQ(score.delays_s, expected.delays_s);
    ASSERT_EQ(score.detected, static_cast<int>(expected.delays_s.size()));
    ASSERT_EQ(score.false_alarms, expected.false_alarms);
    ASSERT_NEAR(score.sound_s, expected.sound_s, 40 * kStep);
  }
}

DetectionScore alarms(int count, double hours = 1.0) { return {.false_alarms = count, .sound_s = 3600.0 * hours}; }

TEST(TuningChoice, IsTheSmallestLimitFromWhichOnAllKeepTheWish) {
  const std::vector<DetectionScore> curve{alarms(9), alarms(1), alarms(3), alarms(1), alarms(0)};
  const LimitChoice one = choose_limit(curve, 1.0);
  EXPECT_EQ(one.limit, 3U);  // and not the lucky second
  EXPECT_TRUE(one.wish_met);
  EXPECT_EQ(choose_limit(curve, 0.5).limit, 4U);
  EXPECT_EQ(choose_limit(curve, 3.0).limit, 1U);
  EXPECT_EQ(choose_limit(curve, 100.0).limit, 0U);
}

TEST(TuningChoice, IsTheFewestFalseAlarmsWhereTheWishCannotBeMet) {
  const std::vector<DetectionScore> curve{alarms(9), alarms(2), alarms(2), alarms(5)};
  const LimitChoice best = choose_limit(curve, 1.0);
  EXPECT_EQ(best.limit, 1U);
  EXPECT_FALSE(best.wish_met);
}

ScoresOfLogs random_scores(std::mt19937_64& random) {
  std::uniform_real_distribution<double> seconds(1.0, 2000.0);
  const std::size_t limits = 1 + random() % 7;
  ScoresOfLogs scores(2 + random() % 5);
  for (auto& log : scores) {
    const int stretches = static_cast<int>(random() % 4);
    const double sound_s = random() % 8 == 0 ? 0.0 : seconds(random);
    for (std::size_t i = 0; i < limits; ++i) {
      DetectionScore score{.stretches = stretches, .sound_s = sound_s};
      score.detected = static_cast<int>(random() % static_cast<std::uint64_t>(stretches + 1));
      score.false_alarms = static_cast<int>(random() % (limits - i + 1));
      for (int d = 0; d < score.detected; ++d) score.delays_s.push_back(seconds(random) * 1e-4);
      log.push_back(score);
    }
  }
  return scores;
}

// By trying every limit against every larger one, and from sums made anew.
LimitChoice choice_by_trial(const ScoresOfLogs& scores, std::size_t left_out, double wish) {
  const std::size_t limits = scores.front().size();
  std::vector<double> rate(limits);
  for (std::size_t i = 0; i < limits; ++i) {
    int count = 0;
    double hours = 0.0;
    for (std::size_t log = 0; log < scores.size(); ++log) {
      count += log == left_out ? 0 : scores[log][i].false_alarms;
      hours += log == left_out ? 0.0 : scores[log][i].sound_s / 3600.0;
    }
    rate[i] = count == 0 ? 0.0 : count / hours;
  }
  for (std::size_t i = 0; i < limits; ++i) {
    bool good = true;
    for (std::size_t j = i; j < limits; ++j) good = good && rate[j] <= wish;
    if (good) return {i, true};
  }
  std::size_t best = 0;
  for (std::size_t i = 1; i < limits; ++i) best = rate[i] < rate[best] * (1.0 - 1e-12) ? i : best;
  return {best, false};
}

TEST(TuningChoice, AndCrossValidationAgreeWithTrialOnRandomScores) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> exponent(-1.0, 2.0);
  int met = 0, unmet = 0;
  for (int round = 0; round < 2000; ++round) {
    const ScoresOfLogs scores = random_scores(random);
    const double wish = std::pow(10.0, exponent(random));
    const LimitChoice all = choose_limit(pooled_scores(scores), wish), trial = choice_by_trial(scores, 99, wish);
    ASSERT_EQ(all.limit, trial.limit);
    ASSERT_EQ(all.wish_met, trial.wish_met);
    (all.wish_met ? met : unmet)++;

    const CrossValidation validation = cross_validate(scores, wish);
    ASSERT_EQ(validation.choices.size(), scores.size());
    DetectionScore expected;
    for (std::size_t log = 0; log < scores.size(); ++log) {
      const LimitChoice choice = choice_by_trial(scores, log, wish);
      ASSERT_EQ(validation.choices[log].limit, choice.limit);
      ASSERT_EQ(validation.choices[log].wish_met, choice.wish_met);
      const DetectionScore& own = scores[log][choice.limit];
      expected.detected += own.detected;
      expected.stretches += own.stretches;
      expected.false_alarms += own.false_alarms;
      expected.sound_s += own.sound_s;
      expected.delays_s.insert(expected.delays_s.end(), own.delays_s.begin(), own.delays_s.end());
    }
    ASSERT_EQ(validation.score.detected, expected.detected);
    ASSERT_EQ(validation.score.stretches, expected.stretches);
    ASSERT_EQ(validation.score.false_alarms, expected.false_alarms);
    ASSERT_EQ(validation.score.sound_s, expected.sound_s);
    ASSERT_EQ(validation.score.delays_s, expected.delays_s);
  }
  EXPECT_GT(met, 200);
  EXPECT_GT(unmet, 200);
}

// Garwood's table: upper limits of a Poisson mean at 95 % (one-sided) for 0, 1, 2, 5, 10 and 100 counts.
TEST(ProvedRate, IsTheExactPoissonLimitAndTheRuleOfThreeWithoutAlarms) {
  EXPECT_NEAR(proved_rate_per_hour(0, 1.0), -std::log(0.05), 1e-9);
  EXPECT_NEAR(proved_rate_per_hour(0, 10.0), 0.3, 0.001);
  EXPECT_NEAR(proved_rate_per_hour(1, 1.0), 4.744, 0.001);
  EXPECT_NEAR(proved_rate_per_hour(2, 1.0), 6.296, 0.001);
  EXPECT_NEAR(proved_rate_per_hour(5, 1.0), 10.513, 0.001);
  EXPECT_NEAR(proved_rate_per_hour(10, 2.0), 16.962 / 2, 0.001);
  EXPECT_NEAR(proved_rate_per_hour(100, 1.0), 118.08, 0.01);
  EXPECT_NEAR(proved_rate_per_hour(5000, 1.0), 5118.1, 1.0);
  EXPECT_TRUE(std::isinf(proved_rate_per_hour(0, 0.0)));
}

}  // namespace
}  // namespace stillcut
