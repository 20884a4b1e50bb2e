#include "rt/stage_times.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <set>
#include <string>
#include <thread>

#include "rt/loop_times.hpp"

namespace stillcut {
namespace {

void work() { std::this_thread::sleep_for(std::chrono::microseconds{300}); }

TEST(StageTimes, GivesEachStageItsOwnTimeAndAddsUpWhatReturns) {
  StageTimes times;
  const StageProbe probe = times.probe();
  const int ticks = 2 * times.timed_every();
  for (int tick = 0; tick < ticks; ++tick) {
    times.begin_tick();
    const std::int64_t began_ns = monotonic_ns();
    for (int frame = 0; frame < 3; ++frame) {
      probe(Stage::decode);
      work();
      probe(Stage::filter);
    }
    probe(Stage::hand_over);
    times.end_tick();
    const std::int64_t took_ns = monotonic_ns() - began_ns;
    if (tick > 0) continue;
    const LatencyHistogram& decode = times.histogram(Stage::decode);
    ASSERT_EQ(decode.count(), 1U);
    EXPECT_GE(decode.max_ns(), 900'000);  // three times 300 µs, which a sleep never undercuts
    EXPECT_LE(decode.max_ns(), took_ns);
    EXPECT_LE(times.histogram(Stage::filter).max_ns() + decode.max_ns(), took_ns);
  }
  EXPECT_EQ(times.histogram(Stage::decode).count(), 2U);
  EXPECT_EQ(times.histogram(Stage::transform).count(), 0U) << "a stage that did not come up counts as none";
}

TEST(StageTimes, OutsideATickNothingIsCounted) {
  StageTimes times;
  times.begin(Stage::decide);
  times.end_tick();
  for (int s = 0; s < kStages; ++s) EXPECT_EQ(times.histogram(static_cast<Stage>(s)).count(), 0U);
}

TEST(LoopTimes, NameEveryPartOnce) {
  const auto times = std::make_unique<LoopTimes>();
  std::set<std::string> names;
  for (const NamedLatency& part : named_latencies(*times)) names.insert(part.name);
  EXPECT_EQ(names.size(), kNamedLatencies);
}

}  // namespace
}  // namespace stillcut
