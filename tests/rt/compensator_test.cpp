#include "rt/compensator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "dsp/numbers.hpp"
#include "tests/rt/compensator_bench.hpp"

namespace stillcut {
namespace {

TEST(Compensator, OffSaysNothing) {
  Bench bench{RuntimeMode::off};
  bench.run(1.0, chattering(0));
  MonitorView doubtful = chattering(0);
  doubtful.doubts = kSaturated;
  bench.run(0.1, doubtful);
  EXPECT_TRUE(bench.corrections.empty());
  EXPECT_TRUE(bench.events.empty());
}

TEST(Compensator, QuietCutsNeedNoCorrection) {
  for (const RuntimeMode mode : {RuntimeMode::shadow, RuntimeMode::active}) {
    Bench bench{mode};
    bench.in.controller_alive = true;
    for (const State state : {State::idle, State::air, State::entry, State::cut, State::exit, State::air}) {
      bench.run(0.3, quiet(0, state));
    }
    EXPECT_TRUE(bench.corrections.empty());
    EXPECT_TRUE(bench.events.empty());
  }
}

TEST(Compensator, EveryMessageIsNumberedDatedAndExpires) {
  for (const RuntimeMode mode : {RuntimeMode::shadow, RuntimeMode::active}) {
    Bench bench{mode};
    bench.in.controller_alive = true;
    bench.run_acknowledged(1.0, chattering(0));
    bench.run_acknowledged(1.0, quiet(0));
    bench.run_acknowledged(1.1, quiet(0, State::air));
    ASSERT_GT(bench.corrections.size(), 20U);
    EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::release);
    for (std::size_t i = 0; i < bench.corrections.size(); ++i) {
      const Correction& c = bench.corrections[i];
      EXPECT_EQ(c.sequence, static_cast<std::int64_t>(i) + 1);
      EXPECT_EQ(c.mode, mode);
      EXPECT_GT(c.valid_for_ms, 0);
      EXPECT_LE(c.valid_for_ms, 1000);
      EXPECT_NE(c.reason[0], 0);
      EXPECT_TRUE(c.kind == CorrectionKind::release || c.kind == CorrectionKind::spindle_speed);
      if (i == 0) continue;
      const Correction& before = bench.corrections[i - 1];
      EXPECT_GE(c.stamp_ns, before.stamp_ns);
      // Renewed well before it runs out.
      EXPECT_LT(c.stamp_ns - before.stamp_ns, before.valid_for_ms * kMillisecond / 2);
    }
  }
}

TEST(Compensator, SetpointRampsWithinAccelerationAndJerkToTheTarget) {
  Bench bench{RuntimeMode::shadow};
  bench.run(2.0, chattering(0));
  const std::vector<double> targets = bench.targets_rpm();
  ASSERT_EQ(targets.size(), 1U);
  EXPECT_NEAR(targets[0], 60.0 * 738.0 / (2 * 3), 1e-9);  // 7380: nearer than 11070
  std::vector<double> time, speed;
  for (const Correction& c : bench.corrections) {
    time.push_back(static_cast<double>(c.stamp_ns - bench.corrections[0].stamp_ns) * 1e-9);
    speed.push_back(c.spindle_speed_rpm);
    EXPECT_GE(c.spindle_speed_rpm, 6000.0);
    EXPECT_LE(c.spindle_speed_rpm, 12000.0);
    EXPECT_NEAR(c.feed_override, c.spindle_speed_rpm / 9000.0, 1e-12);  // the same feed per tooth
  }
  EXPECT_NEAR(speed.front(), 9000.0, 1e-9);
  EXPECT_NEAR(speed.back(), targets[0], 1e-9);
  double slope_before = 0.0, time_before = time[0];
  bool accelerated = false;
  for (std::size_t i = 1; i < speed.size(); ++i) {
    const double slope = (speed[i] - speed[i - 1]) / (time[i] - time[i - 1]);
    const double middle = 0.5 * (time[i] + time[i - 1]);
    EXPECT_LE(std::abs(slope), 3000.0 * (1.0 + 1e-9));
    EXPECT_LE(std::abs(slope - slope_before), 30000.0 * (middle - time_before) * (1.0 + 1e-9) + 1e-6);
    accelerated = accelerated || std::abs(slope) > 1500.0;
    slope_before = slope;
    time_before = middle;
  }
  EXPECT_TRUE(accelerated);
  EXPECT_NE(bench.corrections.front().limited_by & kLimitedByAcceleration, 0);
  EXPECT_EQ(bench.corrections.back().limited_by, 0);
}

TEST(Compensator, AProgrammedSpeedBeyondTheSpindleDoesNotScaleTheFeed) {
  for (const double programmed : {1e-3, 1e9, kNaN, 0.0}) {
    Bench bench{RuntimeMode::shadow};
    bench.in.nominal_speed = programmed;
    bench.run(0.5, chattering(0));
    ASSERT_FALSE(bench.corrections.empty());
    for (const Correction& c : bench.corrections) EXPECT_NEAR(c.feed_override, c.spindle_speed_rpm / 9000.0, 1e-12);
  }
}

TEST(Compensator, ShadowFollowsTheFrequencyOnlyWhenItDrifts) {
  Bench bench{RuntimeMode::shadow};
  bench.run(3.0, chattering(0));
  EXPECT_EQ(bench.targets_rpm().size(), 1U);  // nobody follows a shadow: chatter going on is no failure
  EXPECT_EQ(bench.events.size(), 1U);
  bench.run(1.0, chattering(0, 738.0 * 1.01));
  EXPECT_EQ(bench.targets_rpm().size(), 1U);
  bench.run(1.0, chattering(0, 738.0 * 0.93));
  ASSERT_EQ(bench.targets_rpm().size(), 2U);
  EXPECT_NEAR(bench.targets_rpm()[1], 738.0 * 0.93 * 15.0, 1e-6);
  ASSERT_EQ(bench.events.size(), 2U);
  for (const Event& event : bench.events) EXPECT_EQ(event.type, EventType::correction);
  EXPECT_NEAR(bench.events[1].spindle_speed_rpm, 738.0 * 0.93 * 15.0, 1e-6);
  EXPECT_NEAR(bench.events[1].frequency_hz, 738.0 * 0.93, 1e-9);
  EXPECT_EQ(bench.releases(), 0);
}

TEST(Compensator, AnyDoubtReleasesOnceAndSilencesUntilItClears) {
  for (const RuntimeMode mode : {RuntimeMode::shadow, RuntimeMode::active}) {
    for (int bit = 0; bit < kDoubtCount; ++bit) {
      if (1U << bit == kSaturated) continue;  // chatter may be what saturates: below
      Bench bench{mode};
      bench.in.controller_alive = true;
      bench.run_acknowledged(0.5, chattering(0));
      ASSERT_TRUE(bench.compensator().correcting());
      const std::size_t before = bench.corrections.size();
      MonitorView doubtful = chattering(0);
      doubtful.doubts = 1U << bit;
      bench.run_acknowledged(2.0, doubtful);
      ASSERT_EQ(bench.corrections.size(), before + 1) << "doubt " << bit;
      EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::release);
      EXPECT_FALSE(bench.compensator().correcting());
      bench.run_acknowledged(0.1, chattering(0));
      EXPECT_GT(bench.corrections.size(), before + 1);
      EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::spindle_speed);
    }
  }
}

// The chatter that is being corrected drives the sensor beyond its range: the move goes on to its end, and no further.
TEST(Compensator, SaturationByTheChatterThatIsCorrectedEndsTheCorrectionOnlyAfterItsTime) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  bench.run_acknowledged(0.2, chattering(0));
  MonitorView saturated = quiet(0, State::cannot_tell);
  saturated.doubts = kSaturated;
  bench.run_acknowledged(0.3, saturated);
  EXPECT_TRUE(bench.compensator().correcting());
  EXPECT_EQ(bench.releases(), 0);
  bench.run_acknowledged(2.0, saturated);
  EXPECT_FALSE(bench.compensator().correcting());
  EXPECT_EQ(bench.releases(), 1);
}

TEST(Compensator, AnUnknownKindWaitsAndAFadingLineIsLeftAlone) {
  Bench waiting{RuntimeMode::shadow};
  MonitorView unknown = chattering(0);
  unknown.kind = ChatterKind::unknown;
  waiting.run(0.1, unknown);
  EXPECT_TRUE(waiting.corrections.empty());
  waiting.run(0.2, unknown);
  EXPECT_FALSE(waiting.corrections.empty());

  Bench fading{RuntimeMode::shadow};
  MonitorView low = chattering(0);
  low.indicator = 0.8;
  fading.run(1.0, low);
  low.indicator = kNaN;
  fading.run(1.0, low);
  EXPECT_TRUE(fading.corrections.empty());
}

TEST(Compensator, TheCutsEndReleases) {
  for (const State over : {State::air, State::idle}) {
    Bench bench{RuntimeMode::shadow};
    bench.run(0.5, chattering(0));
    bench.run(0.5, quiet(0));  // it helped: held as long as the cut lasts
    EXPECT_TRUE(bench.compensator().correcting());
    bench.run(0.5, quiet(0, over));  // a gap in the part is not its end
    EXPECT_TRUE(bench.compensator().correcting());
    bench.run(0.6, quiet(0, over));
    EXPECT_FALSE(bench.compensator().correcting());
    EXPECT_EQ(bench.releases(), 1);
    EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::release);
    EXPECT_NEAR(bench.corrections.back().spindle_speed_rpm, 9000.0, 1e-9);
    EXPECT_EQ(bench.corrections.back().feed_override, 1.0);
  }
}

}  // namespace
}  // namespace stillcut
