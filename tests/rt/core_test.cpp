#include "rt/core.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "tests/rt/core_script.hpp"

namespace stillcut {
namespace {

TEST(Core, ChatterBecomesOneOnsetAndACorrectionInStep) {
  SyntheticCut cut = chattering_cut();
  cut.duration_s = 3.5;  // a second of air ends the cut
  Heard heard{settings_of(cut)};
  heard.play(record(cut));
  const std::vector<Event> onsets = only(heard.events, EventType::chatter_onset);
  ASSERT_EQ(onsets.size(), 1U);
  EXPECT_NEAR(onsets[0].frequency_hz, 717.0, 3.0);
  const std::vector<Event> corrections = only(heard.events, EventType::correction);
  ASSERT_FALSE(corrections.empty());
  const double k = 60.0 * corrections[0].frequency_hz / (2 * corrections[0].spindle_speed_rpm);
  EXPECT_NEAR(k, std::round(k), 1e-9);
  ASSERT_FALSE(heard.corrections.empty());
  EXPECT_EQ(heard.corrections.back().kind, CorrectionKind::release);
  for (const Correction& c : heard.corrections) EXPECT_EQ(c.mode, RuntimeMode::shadow);
}

TEST(Core, SameInputsGiveTheSameOutputsToTheLastBit) {
  const SyntheticLog log = record(chattering_cut());
  std::string first;
  for (int run = 0; run < 2; ++run) {
    Heard heard{settings_of(chattering_cut())};
    heard.core.add_lobes(dated(0, 0));
    heard.play(log);
    if (run == 0) first = heard.all.str();
    EXPECT_EQ(heard.all.str(), first);
    EXPECT_NE(first.find("correction"), std::string::npos);
  }
}

TEST(Core, AStampThatGoesBackIsOneFaultARunAndDropsTheFrame) {
  Heard heard{settings_of(chattering_cut())};
  EXPECT_TRUE(heard.frame(kStart));
  EXPECT_TRUE(heard.frame(kStart + 10 * kMillisecond));
  EXPECT_FALSE(heard.frame(kStart + 9 * kMillisecond));
  EXPECT_FALSE(heard.frame(kStart + 8 * kMillisecond));
  EXPECT_EQ(only(heard.events, EventType::fault).size(), 1U);
  EXPECT_TRUE(heard.frame(kStart + 10 * kMillisecond));  // the same stamp does not go back
  EXPECT_FALSE(heard.frame(kStart));
  const std::vector<Event> faults = only(heard.events, EventType::fault);
  ASSERT_EQ(faults.size(), 2U);
  EXPECT_EQ(faults[1].stamp_ns, kStart + 10 * kMillisecond);
  EXPECT_STREQ(faults[1].note.data(), "stamp goes back by 0.010000 s; frame dropped");
  EXPECT_EQ(heard.core.counters().frames, 3);
  EXPECT_EQ(heard.core.counters().frames_out_of_order, 3);
}

TEST(Core, ALogMayBeginAtTimeZero) {
  Heard heard{settings_of(chattering_cut())};
  heard.frame(0);
  heard.frame(10 * kMillisecond);
  EXPECT_EQ(heard.core.origin_ns(), 0);
  heard.frame(150 * kMillisecond);
  ASSERT_EQ(heard.statuses.size(), 1U);
  EXPECT_EQ(heard.statuses[0].stamp_ns, 100 * kMillisecond);
}

TEST(Core, StatusComesTenTimesASecondOfDataTimeAlsoInSilence) {
  Heard heard{settings_of(chattering_cut())};
  SyntheticCut cut = chattering_cut();
  cut.duration_s = 1.0;
  heard.play(record(cut));
  heard.core.advance(kStart + 3 * kSecond + 50 * kMillisecond);
  heard.listen();
  ASSERT_EQ(heard.statuses.size(), 30U);
  for (std::size_t i = 0; i < 30; ++i) {
    EXPECT_EQ(heard.statuses[i].stamp_ns - heard.core.origin_ns(),
              static_cast<std::int64_t>(i + 1) * 100 * kMillisecond);
  }
  EXPECT_EQ(heard.statuses.back().state, State::cannot_tell);
  EXPECT_EQ(heard.statuses.back().mode, RuntimeMode::shadow);
  EXPECT_NEAR(heard.statuses[8].spindle_speed_rpm, 9000.0, 1.0);
}

TEST(Core, SilenceIsToldAlikeInOneStepOrInMany) {
  SyntheticCut cut = chattering_cut();
  cut.duration_s = 1.8;  // breaks off in the middle of chatter
  const SyntheticLog log = record(cut);
  std::mt19937_64 random{7};
  std::string one;
  for (int run = 0; run < 20; ++run) {
    Heard heard{settings_of(cut)};
    heard.play(log);
    const std::int64_t from = log.blocks.back().stamp_ns, to = from + 4 * kSecond;
    heard.core.add_lobes(dated(from + 1'234'567'890, from));
    if (run > 0) {
      std::uniform_int_distribution<std::int64_t> step(1, run * 20 * kMillisecond);
      for (std::int64_t now = from; now < to; now += step(random)) {
        heard.core.advance(now);
        heard.listen();
      }
    }
    heard.core.advance(to);
    heard.listen();
    heard.frame(to + kMillisecond);
    if (run == 0) one = heard.all.str();
    ASSERT_EQ(heard.all.str(), one) << "steps of up to " << run * 20 << " ms";
    EXPECT_EQ(heard.corrections.back().kind, CorrectionKind::release);
    EXPECT_EQ(heard.core.view().state, State::cannot_tell);
  }
}

TEST(Core, LobesComeIntoUseWhenDue) {
  Heard heard{settings_of(chattering_cut())};
  heard.frame(kStart);
  EXPECT_EQ(heard.core.lobes(), nullptr);
  heard.core.add_lobes(dated(kStart + kSecond, kStart));
  heard.frame(kStart + kSecond - 1);
  EXPECT_EQ(heard.core.lobes(), nullptr);
  heard.frame(kStart + kSecond);
  ASSERT_NE(heard.core.lobes(), nullptr);
  EXPECT_EQ(heard.core.lobes()->posture_stamp_ns, kStart);
}

// A new diagram comes ten times a second, each usable two seconds later: they must not push each other out.
TEST(Core, ARobotThatMovesOnDoesNotStarveTheLobes) {
  Heard heard{settings_of(chattering_cut())};
  heard.frame(kStart);
  int in_use = 0;
  for (int i = 1; i <= 100; ++i) {
    const std::int64_t now = kStart + i * 100 * kMillisecond;
    heard.core.add_lobes(dated(now + 2 * kSecond, now));
    heard.frame(now);
    in_use += heard.core.lobes() != nullptr ? 1 : 0;
  }
  EXPECT_GE(in_use, 75);
}

TEST(Core, LobesOfAnotherPostureCountAsNone) {
  Heard heard{settings_of(chattering_cut())};
  heard.core.add_lobes(dated(0, 0));
  heard.frame(kStart);
  EXPECT_NE(heard.core.lobes(), nullptr);  // the cell file's posture, as long as no robot tells its own
  heard.core.add_robot_state(state_at(kStart));
  EXPECT_EQ(heard.core.lobes(), nullptr);
  heard.core.add_lobes(dated(kStart, kStart));
  EXPECT_NE(heard.core.lobes(), nullptr);
  heard.core.add_robot_state(state_at(kStart + 10 * kSecond));
  EXPECT_EQ(heard.core.lobes(), nullptr);
  heard.frame(kStart + 10 * kSecond);
  EXPECT_TRUE(std::isnan(heard.statuses.back().margin));
  EXPECT_EQ(heard.statuses.back().lobes_stamp_ns, 0);
}

LobeDiagram along_the_path(std::int64_t usable_from_ns, std::int64_t usable_until_ns, double limit_mm) {
  LobeDiagram diagram = dated(usable_from_ns, 0, limit_mm);
  diagram.ahead = true;
  diagram.usable_until_ns = usable_until_ns;
  return diagram;
}

TEST(Core, ADiagramOfTheAnnouncedPathIsUsedUntilThatIsTravelledAndBesideThePresentOne) {
  Heard heard{settings_of(chattering_cut())};
  heard.core.add_lobes(dated(0, 0, 2.0));
  heard.frame(kStart);
  heard.core.add_lobes(along_the_path(kStart + kSecond, kStart + 3 * kSecond, 0.5));
  heard.frame(kStart + kSecond - 1);
  EXPECT_EQ(heard.core.lobes_ahead(), nullptr);
  for (const std::int64_t ns : {kSecond, 3 * kSecond - 1}) {
    heard.frame(kStart + ns);
    ASSERT_NE(heard.core.lobes_ahead(), nullptr);
    EXPECT_EQ(heard.core.lobes_ahead()->points[0].depth_limit, 0.5e-3);
    ASSERT_NE(heard.core.lobes(), nullptr);
    EXPECT_EQ(heard.core.lobes()->points[0].depth_limit, 2e-3);
  }
  heard.frame(kStart + 3 * kSecond);
  EXPECT_EQ(heard.core.lobes_ahead(), nullptr);
  EXPECT_NE(heard.core.lobes(), nullptr);
}

TEST(Core, APathTakenBackIsAheadNoMore) {
  Heard heard{settings_of(chattering_cut())};
  heard.frame(kStart);
  heard.core.add_lobes(along_the_path(kStart, kStart + 10 * kSecond, 0.5));
  EXPECT_NE(heard.core.lobes_ahead(), nullptr);
  EXPECT_EQ(heard.core.lobes(), nullptr);  // it stands in for nothing
  LobeDiagram none = along_the_path(kStart + kSecond, kStart + kSecond, 0.5);
  none.valid = false;
  heard.core.add_lobes(none);
  EXPECT_NE(heard.core.lobes_ahead(), nullptr);
  heard.frame(kStart + kSecond);
  EXPECT_EQ(heard.core.lobes_ahead(), nullptr);
}

// A pocket here that the path leaves is none: the other speed in step is asked for.
TEST(Core, WhatLiesAheadTurnsACorrectionAway) {
  const SyntheticCut cut = chattering_cut();  // 717 Hz, two teeth: 10755 and 7170 rpm are in step
  std::vector<double> here(61, 0.5), ahead(61, 5.0);
  for (std::size_t i = 8; i < 16; ++i) here[i] = 3.0, ahead[i] = 0.1;  // 6800 to 7500 rpm
  for (std::size_t i = 44; i < 53; ++i) here[i] = 1.2;                 // barely stable: 10400 to 11200 rpm
  std::vector<double> targets;
  for (const bool announced : {false, true}) {
    Heard heard{settings_of(cut)};
    LobeDiagram diagram = diagram_of(here, spindle_6000_to_12000());
    heard.core.add_lobes(diagram);
    diagram = diagram_of(ahead, spindle_6000_to_12000());
    diagram.ahead = true;
    diagram.usable_until_ns = kStart + 10 * kSecond;
    if (announced) heard.core.add_lobes(diagram);
    heard.play(record(cut));
    const std::vector<Event> corrections = only(heard.events, EventType::correction);
    ASSERT_FALSE(corrections.empty());
    targets.push_back(corrections[0].spindle_speed_rpm);
  }
  EXPECT_NEAR(targets[0], 7170.0, 100.0);
  EXPECT_NEAR(targets[1], 10755.0, 100.0);
}

TEST(Core, AnInvalidDiagramReplacesAValidOne) {  // the robot has left the measured postures
  Heard heard{settings_of(chattering_cut())};
  heard.core.add_lobes(dated(0, 0));
  heard.frame(kStart);
  LobeDiagram none = dated(kStart + kSecond, kStart);
  none.valid = false;
  heard.core.add_lobes(none);
  EXPECT_NE(heard.core.lobes(), nullptr);
  heard.frame(kStart + kSecond);
  EXPECT_EQ(heard.core.lobes(), nullptr);
}

TEST(Core, BusOffAndErrorPassiveAreOneFaultEachUntilTheBusIsWell) {
  constexpr std::uint32_t kErrorFrame = 0x20000000, kBusOff = 0x40, kController = 0x04, kRestarted = 0x100;
  const SyntheticLog log = record(chattering_cut());
  Heard heard{settings_of(chattering_cut())};
  const auto faults = [&] {
    heard.listen();
    return only(heard.events, EventType::fault).size();
  };
  heard.frame(log.blocks[0].stamp_ns);
  for (int i = 0; i < 5; ++i) heard.core.add_bus_error(kErrorFrame | kBusOff, 0);
  EXPECT_EQ(faults(), 1U);
  for (int i = 0; i < 5; ++i) heard.core.add_bus_error(kErrorFrame | kController, 0x10);
  EXPECT_EQ(faults(), 2U);
  heard.core.add_bus_error(kErrorFrame | kController, 0x04);  // a warning only
  heard.core.add_bus_error(kErrorFrame | 0x08, 0xFF);         // a protocol error of one frame
  EXPECT_EQ(faults(), 2U);
  heard.core.add_samples(log.blocks[0]);  // off no longer
  heard.core.add_bus_error(kErrorFrame | kBusOff, 0);
  EXPECT_EQ(faults(), 3U);
  heard.core.add_bus_error(kErrorFrame | kRestarted, 0);
  heard.core.add_bus_error(kErrorFrame | kBusOff, 0);
  EXPECT_EQ(faults(), 4U);
}

// An active core whose controller reports every 20 ms and takes every correction; at `late_s` the loop falls out of
// time, if ever.
Heard play_with_controller(double late_s) {
  Heard heard{settings_of(chattering_cut(), RuntimeMode::active)};
  std::int64_t told_ns = 0;
  std::size_t answered = 0;
  bool late_told = false;
  heard.play(record(chattering_cut()), [&](std::int64_t now_ns) {
    for (; answered < heard.corrections.size(); ++answered) {
      heard.core.add_ack({.stamp_ns = now_ns, .sequence = heard.corrections[answered].sequence, .accepted = true});
    }
    if (now_ns - told_ns >= 20 * kMillisecond) {
      RobotState state = state_at(told_ns = now_ns);
      state.spindle_speed_rpm = 9000.0;
      heard.core.add_robot_state(state);
    }
    if (!late_told && static_cast<double>(now_ns - kStart) * 1e-9 > late_s) {
      late_told = true;
      heard.core.add_timing({.stamp_ns = now_ns, .in_time = false, .longest_gap_ns = 40 * kMillisecond});
      heard.listen();
    }
  });
  return heard;
}

TEST(Core, OutOfTimeItTellsAFaultReleasesAndAsksForNothing) {
  const Heard in_time = play_with_controller(1e9);
  const auto asks = [](const Correction& c) { return c.kind != CorrectionKind::release; };
  ASSERT_TRUE(std::any_of(in_time.corrections.begin(), in_time.corrections.end(), asks));
  EXPECT_TRUE(only(in_time.events, EventType::fault).empty());
  const auto first = std::find_if(in_time.corrections.begin(), in_time.corrections.end(), asks);
  const double asked_s = static_cast<double>(first->stamp_ns - kStart) * 1e-9;

  const Heard late = play_with_controller(asked_s + 0.05);
  const std::vector<Event> faults = only(late.events, EventType::fault);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_STREQ(faults[0].note.data(), "the loop cannot keep time: stood still for 40.0 ms; see 'stillcut doctor'");
  EXPECT_TRUE(std::any_of(late.corrections.begin(), late.corrections.end(), asks));
  for (const Correction& c : late.corrections) {
    EXPECT_TRUE(c.stamp_ns <= faults[0].stamp_ns || c.kind == CorrectionKind::release) << c.stamp_ns - kStart;
  }
  EXPECT_STREQ(late.corrections.back().reason.data(), "the loop cannot keep time");
}

}  // namespace
}  // namespace stillcut
