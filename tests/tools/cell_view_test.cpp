#include "tools/cell_view.hpp"

#include <gtest/gtest.h>

#include "dsp/integrity.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kNow_ns = 1'000'000'000'000;

MonitorReport in_cut() {
  MonitorReport report;
  report.stamp_ns = kNow_ns;
  report.state = State::cut;
  report.indicator = 0.1;
  report.axial_depth = 0.15e-3;
  report.depth_limit = 0.4e-3;
  report.margin = 0.4 / 0.15 - 1.0;
  return report;
}
MonitorReport in_chatter() {
  MonitorReport report = in_cut();
  report.state = State::chatter;
  report.chatter = true;
  report.kind = ChatterKind::regenerative;
  report.chatter_frequency_hz = 748.0;
  report.chatter_mode = 2;
  report.chatter_mode_hz = 741.2;
  return report;
}
Correction asking(RuntimeMode mode, std::int64_t stamp_ns) {
  Correction correction;
  correction.stamp_ns = stamp_ns;
  correction.valid_for_ms = 500;
  correction.mode = mode;
  correction.kind = CorrectionKind::spindle_speed;
  correction.spindle_speed_target_rpm = 3412.0;
  correction.reason = short_text("n = 60 f_c / (N k), k = 2");
  return correction;
}
ShownState shown_after(std::initializer_list<TelemetryMessage> messages, double later_s = 0.0) {
  CellView view;
  for (const TelemetryMessage& message : messages) view.take(message, kNow_ns);
  return view.state(kNow_ns + static_cast<std::int64_t>(later_s * 1e9));
}

TEST(CellView, SaysThatNobodyTalksBeforeAndAfter) {
  EXPECT_EQ(shown_after({}).shown, Shown::no_daemon);
  EXPECT_EQ(shown_after({in_cut()}, 1.0).shown, Shown::stable);
  EXPECT_EQ(shown_after({in_cut()}, 2.0).shown, Shown::no_daemon);
  EXPECT_EQ(shown_after({in_cut()}, 2.0).reason, "nothing was heard of the daemon for 2 s");
}

TEST(CellView, ASoundCutIsStableUntilTheIndicatorOrTheLobesWarn) {
  EXPECT_EQ(shown_after({in_cut()}).shown, Shown::stable);
  MonitorReport near = in_cut();
  near.indicator = 0.7;
  EXPECT_EQ(shown_after({near}).shown, Shown::watch);
  MonitorReport deep = in_cut();
  deep.margin = -0.1;
  EXPECT_EQ(shown_after({deep}).shown, Shown::watch);
  MonitorReport air = in_cut();
  air.state = State::air;
  EXPECT_EQ(shown_after({air}).shown, Shown::not_cutting);
}

TEST(CellView, ChatterNamesKindFrequencyAndMode) {
  const ShownState state = shown_after({in_chatter()});
  EXPECT_EQ(state.shown, Shown::chatter);
  EXPECT_EQ(state.reason, "regenerative chatter at 748.0 Hz, nearest mode 2 (741.2 Hz)");
}

TEST(CellView, OnlyAnActiveCorrectionThatIsStillValidCorrects) {
  EXPECT_EQ(shown_after({in_chatter(), asking(RuntimeMode::active, kNow_ns)}).shown, Shown::correcting);
  EXPECT_EQ(shown_after({in_chatter(), asking(RuntimeMode::shadow, kNow_ns)}).shown, Shown::chatter);
  EXPECT_EQ(shown_after({in_chatter(), asking(RuntimeMode::active, kNow_ns - 600'000'000)}).shown, Shown::chatter);
  Correction release = asking(RuntimeMode::active, kNow_ns);
  release.kind = CorrectionKind::release;
  EXPECT_EQ(shown_after({in_cut(), asking(RuntimeMode::active, kNow_ns), release}).shown, Shown::stable);
}

TEST(CellView, DoubtComesBeforeEverythingThatItConcerns) {
  MonitorReport doubtful = in_chatter();
  doubtful.doubts = kSaturated;
  const ShownState state = shown_after({doubtful, asking(RuntimeMode::active, kNow_ns)});
  EXPECT_EQ(state.shown, Shown::cannot_tell);
  EXPECT_EQ(state.reason, describe(kSaturated));
}

TEST(CellView, FaultsOfBusAndLoopAreShownAndPass) {
  HealthReport health;
  health.frames = 1;
  health.bus_state = 1;
  EXPECT_EQ(shown_after({in_cut(), health}).shown, Shown::fault);
  LatencyReport latency;
  latency.in_time = false;
  EXPECT_EQ(shown_after({in_cut(), latency}).shown, Shown::fault);
  Event fault;
  fault.stamp_ns = kNow_ns - 1'000'000'000;
  fault.note = short_text("stamp goes back by 0.1 s; frame dropped");
  EXPECT_EQ(shown_after({in_cut(), fault}).reason, "stamp goes back by 0.1 s; frame dropped");
  fault.stamp_ns -= 4'000'000'000;
  EXPECT_EQ(shown_after({in_cut(), fault}).shown, Shown::stable);
  health = {};
  EXPECT_EQ(shown_after({in_cut(), health}).shown, Shown::cannot_tell);  // no frame yet
}

TEST(CellView, StatusAloneDoesWhereNoTelemetryComes) {
  Status status;
  status.stamp_ns = kNow_ns;
  status.state = State::chatter;
  status.chatter_frequency_hz = 500.0;
  EXPECT_EQ(shown_after({status}).shown, Shown::chatter);
  EXPECT_EQ(shown_after({in_cut(), status}).shown, Shown::stable) << "the fuller report counts";
}

// Threads beside the loop go on telling of health and latency when the loop hangs.
TEST(CellView, ALoopThatSaysNothingIsAFaultHoweverMuchTheDaemonTells) {
  CellView view;
  view.take(in_cut(), kNow_ns);
  LatencyReport latency;
  for (int i = 1; i <= 5; ++i) {
    HealthReport health;
    health.frames = 1;
    view.take(health, kNow_ns + i * 1'000'000'000LL);
    view.take(latency, kNow_ns + i * 1'000'000'000LL);
  }
  EXPECT_EQ(view.state(kNow_ns + 1'000'000'000).shown, Shown::stable);
  EXPECT_EQ(view.state(kNow_ns + 5'000'000'000).shown, Shown::fault);
  latency.ticks = 1000;  // without telemetry, before the first frame
  view.take(latency, kNow_ns + 6'000'000'000LL);
  EXPECT_EQ(view.state(kNow_ns + 6'000'000'000).shown, Shown::cannot_tell);
}

TEST(CellView, ADaemonThatComesBackWithoutTelemetryIsShownByItsStatus) {
  CellView view;
  view.take(in_cut(), kNow_ns);
  Status status;
  status.state = State::chatter;
  view.take(status, kNow_ns + 10'000'000'000);
  EXPECT_EQ(view.state(kNow_ns + 10'000'000'000).shown, Shown::chatter);
}

// A daemon that starts again after its host's clock was set back.
TEST(CellView, WhatIsStampedLongAfterThePresentIsNoLongerShown) {
  const std::int64_t future_ns = kNow_ns + 3'600'000'000'000;
  EXPECT_EQ(shown_after({in_chatter(), asking(RuntimeMode::active, future_ns)}).shown, Shown::chatter);
  Event fault;
  fault.stamp_ns = future_ns;
  fault.note = short_text("stamp goes back by 0.1 s; frame dropped");
  EXPECT_EQ(shown_after({in_cut(), fault}).shown, Shown::stable);
  MonitorReport near = in_cut();
  near.stamp_ns = future_ns;
  near.indicator = 0.7;
  EXPECT_EQ(shown_after({near, in_cut()}).shown, Shown::stable);
}

TEST(CellView, ABusThatIsDownIsNamedRatherThanTheSilenceThatFollowsFromIt) {
  MonitorReport silent = in_cut();
  silent.doubts = kSensorSilent;
  HealthReport health;
  health.frames = 1;
  health.bus_state = 1;
  EXPECT_EQ(shown_after({silent, health}).shown, Shown::fault);
}

TEST(CellView, CountsWhatIsAskedForNotItsSetpointsAndKeepsABoundedPast) {
  CellView view;
  for (int i = 0; i < 50; ++i) {
    Correction setpoint = asking(RuntimeMode::active, kNow_ns + i);
    setpoint.spindle_speed_rpm = 3330.0 + i;
    view.take(setpoint, kNow_ns);
  }
  EXPECT_EQ(view.corrections().size(), 1U);
  for (int i = 0; i < 1000; ++i) view.take(Event{}, kNow_ns);
  EXPECT_EQ(view.events().size(), CellView::kEventsKept);
  EXPECT_EQ(view.events_heard(EventType::fault), 1000);
}

}  // namespace
}  // namespace stillcut
