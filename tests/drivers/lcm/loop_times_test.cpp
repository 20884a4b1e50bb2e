// What the loop says of its time, as it is published and read back from a recording.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <string_view>

#include "drivers/lcm/telemetry_messages.hpp"

namespace stillcut {
namespace {

std::unique_ptr<LoopTimes> some_times(unsigned seed) {
  auto times = std::make_unique<LoopTimes>();
  std::mt19937 random{seed};
  times->loop.ticks = random();
  times->loop.overruns = random() % 100;
  times->loop.skipped = random() % 100;
  times->times_out = random() % 10;
  times->in_time = random() % 2 == 0;
  for (int i = 0; i < 1000; ++i) {
    times->decision.record(random() % 2'000'000);
    times->loop.execution.record(random() % 100'000);
  }
  return times;
}

TEST(LoopTimesMessage, ComesBackAsItWasTold) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto times = some_times(seed);
    const auto back = decode_latency(encode(latency_report(*times, 1'700'000'000'123'456'000)));
    ASSERT_TRUE(back.ok()) << back.why_not;
    const LatencyReport& report = back.value;
    EXPECT_EQ(report.stamp_ns, 1'700'000'000'123'456'000);
    EXPECT_EQ(report.ticks, static_cast<std::int64_t>(times->loop.ticks));
    EXPECT_EQ(report.overruns, static_cast<std::int64_t>(times->loop.overruns));
    EXPECT_EQ(report.skipped, static_cast<std::int64_t>(times->loop.skipped));
    EXPECT_EQ(report.times_out, static_cast<std::int64_t>(times->times_out));
    EXPECT_EQ(report.in_time, times->in_time);
    const auto named = named_latencies(*times);
    ASSERT_EQ(report.stages.size(), named.size());
    for (std::size_t i = 0; i < named.size(); ++i) {
      EXPECT_EQ(report.stages[i].name, named[i].name);
      EXPECT_EQ(report.stages[i].count, static_cast<std::int64_t>(named[i].times.count));
      EXPECT_EQ(report.stages[i].p50_us, static_cast<double>(named[i].times.p50_ns) * 1e-3);
      EXPECT_EQ(report.stages[i].p99_us, static_cast<double>(named[i].times.p99_ns) * 1e-3);
      EXPECT_EQ(report.stages[i].p999_us, static_cast<double>(named[i].times.p999_ns) * 1e-3);
      EXPECT_EQ(report.stages[i].max_us, static_cast<double>(named[i].times.max_ns) * 1e-3);
    }
  }
}

TEST(LoopTimesMessage, RefusesNamesThatEndBeforeTheirEnd) {
  MessageBytes bytes = encode(latency_report(*some_times(1), 1'700'000'000'000'000'000));
  const std::string_view name = "wake-up";
  const auto found = std::search(bytes.begin(), bytes.end(), name.begin(), name.end());
  ASSERT_NE(found, bytes.end());
  found[4] = 0;
  EXPECT_FALSE(decode_latency(bytes).ok());
  found[4] = '-', found[7] = 'x';  // and none at its end
  EXPECT_FALSE(decode_latency(bytes).ok());
}

TEST(LoopTimesMessage, SurvivesAnyDamage) {
  const MessageBytes whole = encode(latency_report(*some_times(1), 1'700'000'000'000'000'000));
  for (std::size_t length = 0; length < whole.size(); ++length)
    EXPECT_FALSE(decode_latency(std::span(whole).first(length)).ok()) << length;
  std::mt19937 random{3};
  for (int i = 0; i < 20'000; ++i) {
    MessageBytes damaged = whole;
    for (unsigned n = 1 + random() % 4; n > 0; --n)
      damaged[random() % damaged.size()] = static_cast<std::uint8_t>(random());
    (void)decode_latency(damaged);  // the sanitizers watch
  }
}

}  // namespace
}  // namespace stillcut
