// Once built, the monitor takes nothing from the heap.
#include <gtest/gtest.h>

#include "tests/count_allocations.hpp"
#include "tests/dsp/synthetic_cut.hpp"

namespace stillcut {
namespace {

TEST(Monitor, AllocatesNothingWhileItRuns) {
  SyntheticCut cut;
  cut.chatter = {733.0, 1.0, 40.0, 1.5, 1.6};
  cut.knocks_s = {0.9};
  cut.speed_rpm = [](double t) { return t < 2.0 ? 6000.0 : 6000.0 - 4000.0 * (t - 2.0); };  // knots change as well
  cut.frame_is_sent = [](double t) { return t < 2.5 || t > 2.55; };
  const SyntheticLog log = record(cut);
  Monitor monitor{monitor_settings(cut)};
  monitor.set_origin(kSyntheticOrigin_ns);
  const ExpectedMode mode{732.0, 0.03};
  std::size_t next_speed = 0, onsets = 0;
  allocations = 0;
  counting = true;
  for (const SampleBlock& block : log.blocks) {
    for (; next_speed < log.speeds.size() && log.speeds[next_speed].stamp_ns <= block.stamp_ns; ++next_speed) {
      monitor.add_speed(log.speeds[next_speed]);
    }
    monitor.expect({&mode, 1}, 0.1);
    monitor.advance(block.stamp_ns);
    monitor.add_samples(block);
    for (const Event& event : monitor.events()) onsets += event.type == EventType::chatter_onset ? 1 : 0;
    monitor.clear_events();
  }
  counting = false;
  EXPECT_EQ(allocations, 0);
  EXPECT_GE(onsets, 1U);  // the whole path was taken
}

TEST(Monitor, IsWatchedByACounterThatCounts) {
  SyntheticCut cut;
  cut.duration_s = 0.01;
  allocations = 0;
  counting = true;
  const SyntheticLog log = record(cut);
  counting = false;
  EXPECT_GT(allocations, 0);
}

}  // namespace
}  // namespace stillcut
