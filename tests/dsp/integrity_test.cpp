#include "dsp/integrity.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace stillcut {
namespace {

// The doubts that samples of one axis raise, each in turn; `full` marks those at the end of the range.
std::vector<std::uint32_t> doubts(const std::vector<float>& samples, const std::vector<int>& full = {}) {
  SampleCheck check;
  std::vector<std::uint32_t> raised;
  SampleBlock block;
  block.axes_present = 1;
  block.samples = 1;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    block.acceleration[0][0] = samples[i];
    block.full_scale[0] = i < full.size() ? static_cast<std::uint64_t>(full[i]) : 0;
    raised.push_back(check.check(block, 0));
  }
  return raised;
}

TEST(SampleCheck, CallsSixteenEqualSamplesStuck) {
  const auto raised = doubts(std::vector<float>(20, 1.5F));
  for (std::size_t i = 0; i < raised.size(); ++i) EXPECT_EQ(raised[i], i < 15 ? kNoDoubt : kStuck) << i;
}

TEST(SampleCheck, AllowsASensorThatHoldsEachValueForTwoOrThreeSamples) {
  std::vector<float> pairs, triples;
  for (int i = 0; i < 300; ++i) {
    pairs.push_back(static_cast<float>(i / 2 % 7));
    triples.push_back(static_cast<float>(i / 3 % 5) - 2.5F);
  }
  for (const std::uint32_t doubt : doubts(pairs)) EXPECT_EQ(doubt, kNoDoubt);
  for (const std::uint32_t doubt : doubts(triples)) EXPECT_EQ(doubt, kNoDoubt);
}

TEST(SampleCheck, GivesZerosLonger) {
  const auto raised = doubts(std::vector<float>(300, 0.0F));
  EXPECT_EQ(raised[200], kNoDoubt);
  EXPECT_EQ(raised[299], kStuck);
}

TEST(SampleCheck, CallsThreeInARowAtTheEndOfTheRangeSaturated) {
  EXPECT_EQ(doubts({9, 9, 1, 9, 9, 1}, {1, 1, 0, 1, 1, 0}), std::vector<std::uint32_t>(6, kNoDoubt));
  EXPECT_EQ(doubts({9, 9, 9, 9, 1}, {1, 1, 1, 1, 0}),
            (std::vector<std::uint32_t>{kNoDoubt, kNoDoubt, kSaturated, kSaturated, kNoDoubt}));
}

TEST(SampleCheck, CallsALongClipSaturatedAndNotStuck) {
  for (const std::uint32_t doubt : doubts(std::vector<float>(20, 9.0F), std::vector<int>(20, 1))) {
    EXPECT_EQ(doubt & kStuck, 0U);
  }
}

TEST(SampleCheck, SeesWhatIsNoNumber) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
  EXPECT_EQ(doubts({1, nan, 2, infinite, -infinite, 3}),
            (std::vector<std::uint32_t>{kNoDoubt, kNotFinite, kNoDoubt, kNotFinite, kNotFinite, kNoDoubt}));
}

TEST(SampleCheck, LooksAtPresentAxesOnly) {
  SampleCheck check;
  SampleBlock block;
  block.axes_present = 0b101;
  block.samples = 1;
  block.acceleration[1][0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(check.check(block, 0), kNoDoubt);
  block.acceleration[2][0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(check.check(block, 0), kNotFinite);
}

TEST(SampleCheck, ForgetsRunsAtAGap) {
  SampleCheck check;
  SampleBlock block;
  block.axes_present = 1;
  block.samples = 1;
  block.acceleration[0][0] = 2.0F;
  for (int i = 0; i < 7; ++i) EXPECT_EQ(check.check(block, 0), kNoDoubt);
  check.forget_runs();
  for (int i = 0; i < 7; ++i) EXPECT_EQ(check.check(block, 0), kNoDoubt);
}

// Coarse values hold for a while now and then, on axes that come and go with no number or at the end of the range.
TEST(SampleCheck, ClearsARunOfSamplesOnlyWhenEachOfThemIsClear) {
  constexpr int kBlocks = 20000, kRun = 10;
  std::mt19937 random{1};
  const auto one_in = [&random](unsigned n) { return random() % n == 0; };
  SampleCheck each, run;
  SampleBlock block;
  block.axes_present = 0b101;
  block.samples = kRun;
  int cleared = 0, doubtful = 0;
  float coarseness = 2.0F;
  for (int n = 0; n < kBlocks; ++n) {
    if (one_in(20)) coarseness = one_in(2) ? 1.0F : 1000.0F;
    for (float& x : block.acceleration[0]) x = static_cast<float>(random() % 1000) / 1000.0F;
    for (float& x : block.acceleration[2]) x = std::floor(static_cast<float>(random() % 1000) / 800.0F * coarseness);
    if (one_in(50)) block.acceleration[0][random() % kRun] = std::numeric_limits<float>::infinity();
    block.full_scale[2] = one_in(50) ? 7U << random() % 8 : 0U;
    std::array<Lanes, kRun> x{};
    for (int i = 0; i < kRun; ++i) x[i] = {block.acceleration[0][i], block.acceleration[2][i], 0.0F, 0.0F};
    std::uint32_t expected = kNoDoubt, raised = kNoDoubt;
    for (int i = 0; i < kRun; ++i) expected |= each.check(block, i);
    const bool clear = run.beyond_doubt(block, x);
    for (int i = 0; i < kRun && !clear; ++i) raised |= run.check(block, i);
    ASSERT_EQ(raised, expected) << n;
    cleared += clear ? 1 : 0;
    doubtful += expected != kNoDoubt ? 1 : 0;
  }
  EXPECT_GT(cleared, kBlocks / 10);
  EXPECT_GT(doubtful, kBlocks / 100);
}

TEST(Doubts, AllHaveWords) {
  for (int d = 0; d < kDoubtCount; ++d) EXPECT_STRNE(describe(static_cast<Doubt>(1U << d)), "") << d;
}

}  // namespace
}  // namespace stillcut
