#include "rt/compensator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string_view>
#include <vector>

#include "models/lobes.hpp"
#include "tests/rt/monitor_script.hpp"

namespace stillcut {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// A compensator with its inputs, stepped every 2 ms as the monitor's hops would; keeps all that it says.
class Bench {
 public:
  explicit Bench(RuntimeMode mode) : compensator_{{mode, 2, spindle_6000_to_12000(), 0.05}} {
    in.axial_depth = 1e-3;
    in.nominal_speed = rpm_to_rad_s(9000);
  }

  void step(MonitorView view) {
    now_ns += 2 * kMillisecond;
    view.stamp_ns = now_ns;
    in.now_ns = now_ns;
    in.monitor = &view;
    compensator_.step(in, queue_);
    for (const Output& output : queue_.items()) {
      if (output.type == Output::Type::correction) corrections.push_back(output.correction);
      if (output.type == Output::Type::event) events.push_back(output.event);
    }
    queue_.clear();
  }
  void run(double seconds, const MonitorView& view) {
    for (const std::int64_t end = now_ns + static_cast<std::int64_t>(seconds * 1e9); now_ns < end;) step(view);
  }
  // The same with a controller that says yes to every message.
  void run_acknowledged(double seconds, const MonitorView& view) {
    for (const std::int64_t end = now_ns + static_cast<std::int64_t>(seconds * 1e9); now_ns < end;) {
      step(view);
      acknowledge(true);
    }
  }
  void acknowledge(bool accepted) {
    if (corrections.empty()) return;
    compensator_.acknowledge({now_ns, corrections.back().sequence, accepted, 0.0, 1.0});
  }
  [[nodiscard]] Compensator& compensator() { return compensator_; }
  [[nodiscard]] int releases() const {
    return static_cast<int>(std::count_if(corrections.begin(), corrections.end(),
                                          [](const Correction& c) { return c.kind == CorrectionKind::release; }));
  }
  [[nodiscard]] std::vector<double> targets_rpm() const {
    std::vector<double> targets;
    for (const Correction& c : corrections) {
      if (c.kind != CorrectionKind::spindle_speed) continue;
      if (targets.empty() || targets.back() != c.spindle_speed_target_rpm)
        targets.push_back(c.spindle_speed_target_rpm);
    }
    return targets;
  }

  CompensatorInputs in;
  std::int64_t now_ns = 1'700'000'000 * kSecond;
  std::vector<Correction> corrections;
  std::vector<Event> events;

 private:
  Compensator compensator_;
  OutputQueue queue_;
};

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
    bench.run_acknowledged(0.1, quiet(0, State::air));
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
    bench.run(0.2, quiet(0, over));
    EXPECT_FALSE(bench.compensator().correcting());
    EXPECT_EQ(bench.releases(), 1);
    EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::release);
    EXPECT_NEAR(bench.corrections.back().spindle_speed_rpm, 9000.0, 1e-9);
    EXPECT_EQ(bench.corrections.back().feed_override, 1.0);
  }
}

TEST(Compensator, ActiveAsksNothingOfASilentController) {
  Bench bench{RuntimeMode::active};
  bench.run(1.0, chattering(0));
  ASSERT_EQ(bench.corrections.size(), 1U);
  EXPECT_EQ(bench.corrections[0].kind, CorrectionKind::release);
  bench.in.controller_alive = true;
  bench.run_acknowledged(0.3, chattering(0));
  EXPECT_TRUE(bench.compensator().correcting());
  bench.in.controller_alive = false;
  bench.run(0.3, chattering(0));
  EXPECT_FALSE(bench.compensator().correcting());
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::release);
}

TEST(Compensator, ActiveGivesUpAfterASecondWithoutAnAnswer) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  bench.run(3.0, chattering(0));
  EXPECT_FALSE(bench.compensator().correcting());
  EXPECT_EQ(bench.releases(), 1);  // and then nothing more in this episode
  EXPECT_LE(bench.corrections.back().stamp_ns - bench.corrections.front().stamp_ns, kSecond + 4 * kMillisecond);
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::release);
  const std::size_t before = bench.corrections.size();
  bench.run(0.1, quiet(0));
  bench.run(0.1, chattering(0));  // a new episode is a new question
  EXPECT_GT(bench.corrections.size(), before);
}

TEST(Compensator, ActiveRefusedStaysQuietUntilTheEpisodeEnds) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  bench.run_acknowledged(0.1, chattering(0));
  bench.acknowledge(false);
  bench.run(5.0, chattering(0));
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::release);
  EXPECT_EQ(bench.releases(), 1);
  bench.run(0.1, quiet(0));
  bench.run_acknowledged(0.1, chattering(0));
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::spindle_speed);
}

TEST(Compensator, AnswersToOtherMessagesCountForNothing) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  bench.run_acknowledged(0.2, chattering(0));
  bench.run_acknowledged(0.1, quiet(0, State::air));
  bench.run_acknowledged(0.1, chattering(0));
  ASSERT_TRUE(bench.compensator().correcting());
  const std::int64_t newest = bench.corrections.back().sequence;
  for (const std::int64_t sequence : {std::int64_t{-1}, std::int64_t{0}, std::int64_t{1}, newest + 1}) {
    bench.compensator().acknowledge({bench.now_ns, sequence, false, 0.0, 1.0});
  }
  bench.run_acknowledged(0.1, chattering(0));
  EXPECT_TRUE(bench.compensator().correcting());
  for (int i = 0; i < 1000; ++i) {  // accepting what was asked before the last release is no answer either
    bench.step(chattering(0));
    bench.compensator().acknowledge({bench.now_ns, 1, true, 0.0, 1.0});
  }
  EXPECT_FALSE(bench.compensator().correcting());
}

TEST(Compensator, ActiveTriesTheNextSpeedThenSaysThatNoneIsKnown) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  // A machine that follows, and chatters on at every speed: 7380 and 11070 rpm are all there is.
  double speed_rpm = 9000.0;
  std::int64_t second_target_ns = 0;
  for (int i = 0; i < 5000; ++i) {
    bench.step(chattering(0, 738.0, speed_rpm));
    bench.acknowledge(true);
    if (bench.corrections.empty()) continue;
    speed_rpm = bench.corrections.back().spindle_speed_rpm;
    if (second_target_ns == 0 && bench.targets_rpm().size() == 2) second_target_ns = bench.now_ns;
  }
  const std::vector<double> targets = bench.targets_rpm();
  ASSERT_EQ(targets.size(), 2U);
  EXPECT_NEAR(targets[0], 7380.0, 1e-6);
  EXPECT_NEAR(targets[1], 11070.0, 1e-6);
  // The first had time to be reached: 1620 rpm at 3000 rpm/s takes more than half a second.
  EXPECT_GT(second_target_ns - bench.corrections.front().stamp_ns, kSecond / 2);
  ASSERT_EQ(bench.releases(), 1);
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::release);
  EXPECT_NE(bench.corrections.back().limited_by & kNoStableSettingKnown, 0);
  EXPECT_EQ(bench.events.size(), 3U);
  EXPECT_TRUE(std::isnan(bench.events.back().spindle_speed_rpm));
}

TEST(Compensator, ActiveGivesUpAfterAFewSpeedsHoweverManyThereAre) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  double speed_rpm = 9000.0;
  for (int i = 0; i < 20000; ++i) {  // 40 s; 5 kHz gives 13 speeds in the range
    bench.step(chattering(0, 5000.0, speed_rpm));
    bench.acknowledge(true);
    if (!bench.corrections.empty()) speed_rpm = bench.corrections.back().spindle_speed_rpm;
  }
  EXPECT_GE(bench.targets_rpm().size(), 2U);
  EXPECT_LE(bench.targets_rpm().size(), 5U);
  EXPECT_FALSE(bench.compensator().correcting());
  EXPECT_NE(bench.corrections.back().limited_by & kNoStableSettingKnown, 0);
}

TEST(Compensator, WhereEverySpeedIsPredictedWorseNoneIsAsked) {
  Bench bench{RuntimeMode::shadow};
  const LobeDiagram worse = diagram_of({0.1, 0.1, 0.1, 0.9, 0.1, 0.1, 0.1}, spindle_6000_to_12000());
  bench.in.lobes = &worse;
  bench.run(2.0, chattering(0));
  ASSERT_EQ(bench.corrections.size(), 1U);
  EXPECT_EQ(bench.corrections[0].kind, CorrectionKind::release);
  EXPECT_NE(bench.corrections[0].limited_by & kNoStableSettingKnown, 0);
}

// Whatever comes in - speeds that jump, frequencies that are no numbers, lobes that come and go, doubts that flicker,
// controllers that answer nonsense - nothing unsafe goes out.
TEST(Compensator, NothingUnsafeIsEverPublished) {
  const SpindleLimits spindle = spindle_6000_to_12000();
  const double min_rpm = rad_s_to_rpm(spindle.min_speed), max_rpm = rad_s_to_rpm(spindle.max_speed);
  std::int64_t asked = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    std::mt19937_64 random{seed};
    std::uniform_real_distribution<double> chance(0.0, 1.0);
    Bench bench{seed % 2 == 0 ? RuntimeMode::shadow : RuntimeMode::active};
    std::vector<double> limits_mm(61);
    MonitorView view = chattering(0);
    LobeDiagram diagram = diagram_of(limits_mm, spindle);
    std::int64_t sequence = 0;
    for (int i = 0; i < 1500; ++i) {
      if (chance(random) < 0.01) {
        for (double& limit : limits_mm) limit = chance(random) < 0.05 ? kNaN : 2.0 * chance(random);
        diagram = diagram_of(limits_mm, spindle);
        bench.in.lobes = chance(random) < 0.3 ? nullptr : &diagram;
      }
      if (chance(random) < 0.01) {
        const double pick = chance(random);
        view.speed = pick < 0.1 ? kNaN : pick < 0.2 ? 0.0 : pick < 0.3 ? -100.0 : rpm_to_rad_s(20000 * chance(random));
      }
      if (chance(random) < 0.02) view.chatter = chance(random) < 0.7;
      if (chance(random) < 0.02) view.state = static_cast<State>(8 * chance(random));
      if (chance(random) < 0.02) view.kind = static_cast<ChatterKind>(3 * chance(random));
      if (chance(random) < 0.02) view.indicator = chance(random) < 0.1 ? kNaN : 4.0 * chance(random);
      if (chance(random) < 0.02) {
        view.chatter_frequency_hz = chance(random) < 0.1 ? kNaN : std::pow(10.0, 4.0 * chance(random));
      }
      view.doubts = chance(random) < 0.02 ? 1U << static_cast<int>(7 * chance(random)) : 0U;
      bench.in.axial_depth = chance(random) < 0.1 ? kNaN : 1e-3;
      bench.in.nominal_speed = chance(random) < 0.1 ? kNaN : rpm_to_rad_s(15000 * chance(random));
      bench.in.controller_alive = chance(random) < 0.99;

      const std::size_t before = bench.corrections.size();
      const std::size_t events_before = bench.events.size();
      bench.step(view);
      if (chance(random) < 0.5) bench.acknowledge(chance(random) < 0.99);
      // Every new target is announced by an event; only then is it chosen with what is known now.
      bool chosen_now = false;
      for (std::size_t e = events_before; e < bench.events.size(); ++e) {
        chosen_now = chosen_now || !std::isnan(bench.events[e].spindle_speed_rpm);
      }
      for (std::size_t c = before; c < bench.corrections.size(); ++c) {
        const Correction& said = bench.corrections[c];
        ASSERT_EQ(said.sequence, ++sequence);
        ASSERT_GT(said.valid_for_ms, 0);
        if (said.kind == CorrectionKind::release) {
          ASSERT_EQ(said.feed_override, 1.0);
          continue;
        }
        ++asked;
        ASSERT_EQ(view.doubts, kNoDoubt);
        ASSERT_TRUE(seed % 2 == 0 || bench.in.controller_alive);
        ASSERT_GE(said.spindle_speed_rpm, min_rpm * (1.0 - 1e-12));
        ASSERT_LE(said.spindle_speed_rpm, max_rpm * (1.0 + 1e-12));
        ASSERT_GE(said.spindle_speed_target_rpm, min_rpm * (1.0 - 1e-12));
        ASSERT_LE(said.spindle_speed_target_rpm, max_rpm * (1.0 + 1e-12));
        ASSERT_TRUE(said.feed_override > 0.0 && said.feed_override < 100.0) << said.feed_override;
        ASSERT_FALSE(said.predicted_margin_after <= said.predicted_margin_before);
        if (chosen_now && bench.in.lobes != nullptr) {
          const double target = rpm_to_rad_s(said.spindle_speed_target_rpm);
          ASSERT_FALSE(margin_at(diagram, target, bench.in.axial_depth) <
                       margin_at(diagram, view.speed, bench.in.axial_depth));
        }
      }
    }
  }
  EXPECT_GT(asked, 1000);
}

}  // namespace
}  // namespace stillcut
