#include "rt/timekeeper.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

namespace stillcut {
namespace {

constexpr std::int64_t kMs = 1'000'000;

// Ticks on the grid from `at` on for `seconds`, each up to `jitter_ns` late; true while it stays in time.
bool keeps_time(Timekeeper& keeper, std::int64_t& at_ns, double seconds, std::int64_t jitter_ns, std::mt19937& random) {
  std::uniform_int_distribution<std::int64_t> late{0, jitter_ns};
  bool in_time = true;
  for (const std::int64_t end_ns = at_ns + static_cast<std::int64_t>(seconds * 1e9); at_ns < end_ns; at_ns += kMs) {
    keeper.tick(at_ns + late(random));
    in_time = in_time && keeper.in_time();
  }
  return in_time;
}

TEST(Timekeeper, ToleratesLateTicksThatDoNotAddUp) {
  std::mt19937 random{1};
  Timekeeper keeper{kMs};
  std::int64_t at_ns = 5'000 * kMs;
  for (int second = 0; second < 20; ++second) {
    EXPECT_TRUE(keeps_time(keeper, at_ns, 1.0, kMs / 2, random));
    at_ns += 20 * kMs;  // stands still for less than is allowed
  }
  EXPECT_TRUE(keeper.in_time());
}

TEST(Timekeeper, IsOutOfTimeAfterOneLongGapAndBackAfterASecondInTime) {
  std::mt19937 random{2};
  for (const std::int64_t gap_ms : {27, 100, 5'000}) {
    Timekeeper keeper{kMs};
    std::int64_t at_ns = 1'000 * kMs;
    ASSERT_TRUE(keeps_time(keeper, at_ns, 2.0, 100'000, random));
    at_ns += gap_ms * kMs;
    EXPECT_TRUE(keeper.tick(at_ns)) << "a change";
    EXPECT_FALSE(keeper.in_time());
    EXPECT_NEAR(static_cast<double>(keeper.longest_gap_ns()), static_cast<double>((gap_ms + 1) * kMs), 2e6);
    at_ns += kMs;
    keeps_time(keeper, at_ns, 0.9, 100'000, random);
    EXPECT_FALSE(keeper.in_time()) << "too soon";
    keeps_time(keeper, at_ns, 1.2, 100'000, random);
    EXPECT_TRUE(keeper.in_time());
    EXPECT_EQ(keeper.longest_gap_ns(), 0);
  }
}

TEST(Timekeeper, IsOutOfTimeWhereMoreThanATenthOfTheTicksIsMissed) {
  for (const bool many : {false, true}) {
    Timekeeper keeper{kMs};
    std::int64_t at_ns = 1'000 * kMs;
    bool in_time = true;
    for (int tick = 0; tick < 5000; ++tick) {
      at_ns += tick % (many ? 5 : 20) == 0 ? 2 * kMs : kMs;  // a fifth, a twentieth of them missed
      keeper.tick(at_ns);
      in_time = in_time && keeper.in_time();
    }
    EXPECT_EQ(in_time, !many);
  }
}

TEST(Timekeeper, StaysOutWhileTheGapsGoOn) {
  Timekeeper keeper{kMs};
  std::int64_t at_ns = 1'000 * kMs;
  int changes = 0;
  for (int gap = 0; gap < 50; ++gap) {
    for (int tick = 0; tick < 500; ++tick) changes += keeper.tick(at_ns += kMs) ? 1 : 0;
    changes += keeper.tick(at_ns += 40 * kMs) ? 1 : 0;
  }
  EXPECT_EQ(changes, 1);
  EXPECT_FALSE(keeper.in_time());
}

}  // namespace
}  // namespace stillcut
