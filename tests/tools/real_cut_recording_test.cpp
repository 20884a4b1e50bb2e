// The main job on a real cut (ubc-milling, see its README): frames in, onset, end and a correction out; and the same
// cut with what can go wrong on a bus and in a sensor.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "drivers/can/candump_log.hpp"
#include "tools/event_csv.hpp"
#include "tools/pipeline.hpp"
#include "tools/predictor.hpp"

namespace stillcut {
namespace {

constexpr std::uint32_t kVibration = 0x120, kSpindle = 0x130;
constexpr int kSamples = 30;  // a frame: a counter, then 30 samples, all of 16 bits

const Cell& cell() {
  static const Cell cell = read_cell(RECORDINGS "/ubc-milling/cell.toml", {.bus = false});
  return cell;
}

const LobeDiagram& lobes() {
  static const LobeDiagram diagram = Predictor{cell()}.nominal().diagram;
  return diagram;
}

using Frames = std::vector<CanFrame>;

const Frames& recorded() {
  static const Frames frames = [] {
    CandumpReader log{RECORDINGS "/ubc-milling/cut.log"};
    Frames all;
    for (CanFrame frame; log.next(frame);) all.push_back(frame);
    return all;
  }();
  return frames;
}

struct Played {
  std::vector<Event> events;
  std::int64_t origin_ns = 0;

  [[nodiscard]] std::vector<Event> of(EventType type) const {
    std::vector<Event> found;
    std::copy_if(events.begin(), events.end(), std::back_inserter(found),
                 [&](const Event& e) { return e.type == type; });
    return found;
  }
  [[nodiscard]] double seconds(const Event& event) const {
    return static_cast<double>(event.stamp_ns - origin_ns) * 1e-9;
  }
  [[nodiscard]] std::string csv() const {
    std::ostringstream text;
    for (const Event& event : events) write_event(text, event, origin_ns);
    return text.str();
  }
};

Played play(const Frames& frames) {
  Pipeline pipeline{cell()};
  pipeline.core().add_lobes(lobes());
  Played played;
  for (const CanFrame& frame : frames) {
    pipeline.feed(frame);
    for (const Output& output : pipeline.core().outputs()) {
      if (output.type == Output::Type::event) played.events.push_back(output.event);
    }
    pipeline.core().clear_outputs();
  }
  played.origin_ns = pipeline.core().origin_ns();
  return played;
}

double time_of(const CanFrame& frame) {
  return static_cast<double>(frame.stamp_ns - recorded().front().stamp_ns) * 1e-9;
}

// A copy of the cut in which `change` has had every frame in its hands; false leaves a frame out.
Frames changed(const std::function<bool(CanFrame&, double time_s)>& change) {
  Frames frames;
  for (CanFrame frame : recorded()) {
    if (change(frame, time_of(frame))) frames.push_back(frame);
  }
  return frames;
}

void set_speed(CanFrame& frame, double rpm) {
  const auto raw = static_cast<std::uint32_t>(std::llround(rpm * 10.0));
  std::memcpy(frame.data.data(), &raw, sizeof raw);
}

void set_sample(CanFrame& frame, int index, std::int16_t raw) {
  std::memcpy(frame.data.data() + 2 + 2 * static_cast<std::size_t>(index), &raw, sizeof raw);
}

// The chatter line's frequency, from the recording's README.
double track_hz(double time_s) {
  constexpr std::array<std::array<double, 2>, 9> kTrack{{{3.6, 749},
                                                         {3.75, 744},
                                                         {3.85, 738},
                                                         {3.95, 729},
                                                         {4.05, 708},
                                                         {4.15, 697},
                                                         {4.25, 688},
                                                         {4.45, 684},
                                                         {4.75, 684}}};
  for (std::size_t i = 1; i < kTrack.size(); ++i) {
    const auto [t0, f0] = kTrack[i - 1];
    const auto [t1, f1] = kTrack[i];
    if (time_s <= t1) return f0 + (f1 - f0) * (std::max(time_s, t0) - t0) / (t1 - t0);
  }
  return kTrack.back()[1];
}

// What must hold of the onset however the bus behaves, as long as the samples can be trusted.
void expect_one_episode(const Played& played) {
  const std::vector<Event> onsets = played.of(EventType::chatter_onset);
  ASSERT_FALSE(onsets.empty());
  for (std::size_t i = 0; i < onsets.size(); ++i) {
    EXPECT_GE(played.seconds(onsets[i]), 3.58);
    EXPECT_LE(played.seconds(onsets[i]), 3.80);
    if (i > 0) {
      EXPECT_EQ(onsets[i - 1].kind, ChatterKind::unknown) << "only what was unknown is refined";
    }
  }
  EXPECT_NEAR(onsets[0].frequency_hz, track_hz(played.seconds(onsets[0])), 5.0);
  const std::vector<Event> ends = played.of(EventType::chatter_end);
  ASSERT_EQ(ends.size(), 1U);
  EXPECT_GT(played.seconds(ends[0]), 4.75);
  EXPECT_LE(played.seconds(ends[0]), 5.2);
}

void expect_near_the_clean_one(const Frames& frames) {
  const Played clean = play(recorded()), other = play(frames);
  expect_one_episode(other);
  const std::vector<Event> onsets = clean.of(EventType::chatter_onset), others = other.of(EventType::chatter_onset);
  ASSERT_FALSE(onsets.empty() || others.empty());
  EXPECT_NEAR(other.seconds(others[0]), clean.seconds(onsets[0]), 0.020);
  EXPECT_NEAR(others[0].frequency_hz, onsets[0].frequency_hz, 2.0);
}

// With sensors or speed that cannot be trusted: a fault says so, and chatter is never heard where there is none.
void expect_fault_and_no_false_onset(const Frames& frames, double fault_from_s, double fault_to_s) {
  const Played played = play(frames);
  const std::vector<Event> faults = played.of(EventType::fault);
  EXPECT_TRUE(std::any_of(faults.begin(), faults.end(), [&](const Event& fault) {
    return played.seconds(fault) >= fault_from_s && played.seconds(fault) <= fault_to_s;
  })) << played.csv();
  for (const Event& onset : played.of(EventType::chatter_onset)) {
    EXPECT_GE(played.seconds(onset), 3.58);
    EXPECT_LE(played.seconds(onset), 4.90);
  }
}

TEST(RealCut, IsHeardBeforeThreePointSevenSecondsNamedAndFollowedToTwoHertz) {
  Pipeline pipeline{cell()};
  pipeline.core().add_lobes(lobes());
  std::vector<Event> onsets;
  int followed = 0;
  for (const CanFrame& frame : recorded()) {
    pipeline.feed(frame);
    for (const Output& output : pipeline.core().outputs()) {
      if (output.type == Output::Type::event && output.event.type == EventType::chatter_onset)
        onsets.push_back(output.event);
    }
    pipeline.core().clear_outputs();
    if (const double t = time_of(frame); t >= 4.45 && t <= 4.75) {
      EXPECT_NEAR(pipeline.core().view().chatter_frequency_hz, 684.0, 2.0) << t;
      ++followed;
    }
  }
  EXPECT_GT(followed, 50);
  ASSERT_FALSE(onsets.empty());
  const auto seconds = [&](const Event& event) {
    return static_cast<double>(event.stamp_ns - pipeline.core().origin_ns()) * 1e-9;
  };
  EXPECT_GE(seconds(onsets.front()), 3.58);
  EXPECT_LE(seconds(onsets.front()), 3.70);
  EXPECT_EQ(onsets.back().kind, ChatterKind::regenerative);
  EXPECT_LE(seconds(onsets.back()), 3.85);
}

TEST(RealCut, ChatterIsHeardInTimeAtItsFrequencyAndOnlyThere) { expect_one_episode(play(recorded())); }

TEST(RealCut, ACorrectionGoesToASpeedInStepInsideTheLimits) {
  const Played played = play(recorded());
  const std::vector<Event> corrections = played.of(EventType::correction);
  ASSERT_FALSE(corrections.empty());
  for (const Event& correction : corrections) {
    const double first_lobe_rpm = 60.0 * correction.frequency_hz / 2.0;
    const double k = std::round(first_lobe_rpm / correction.spindle_speed_rpm);
    // In step, or at the safe speed beside that the error of the frequency leaves open.
    const double off = &correction == corrections.data() ? 1e-6 : 0.0101;
    EXPECT_NEAR(correction.spindle_speed_rpm, first_lobe_rpm / k, off * correction.spindle_speed_rpm);
    EXPECT_GE(correction.spindle_speed_rpm, 6000.0);
    EXPECT_LE(correction.spindle_speed_rpm, 12000.0);
  }
  EXPECT_GE(played.seconds(corrections[0]), 3.58);
  EXPECT_LE(played.seconds(corrections[0]), 4.0);
}

TEST(RealCut, TwoPlaybacksGiveTheSameBytes) {
  const std::string first = play(recorded()).csv();
  EXPECT_EQ(play(recorded()).csv(), first);
  EXPECT_FALSE(first.empty());
}

TEST(RealCut, EveryHundredthFrameLostChangesLittle) {
  int count = 0;
  expect_near_the_clean_one(changed([&](const CanFrame&, double) { return ++count % 100 != 0; }));
}

TEST(RealCut, LateStampsChangeLittle) {
  std::mt19937_64 random{3};
  std::uniform_int_distribution<std::int64_t> late_ns(0, 3'000'000);
  std::int64_t last_ns = 0;
  expect_near_the_clean_one(changed([&](CanFrame& frame, double) {
    last_ns = frame.stamp_ns = std::max(last_ns, frame.stamp_ns + late_ns(random) / 1000 * 1000);
    return true;
  }));
}

TEST(RealCut, ForeignFramesChangeNothing) {
  std::mt19937_64 random{4};
  Frames frames;
  for (const CanFrame& frame : recorded()) {
    CanFrame foreign = frame;
    foreign.id = 0x121 + random() % 8;  // never 0x120 or 0x130
    for (auto& byte : foreign.data) byte = static_cast<std::uint8_t>(random());
    frames.push_back(frame);
    frames.push_back(foreign);
  }
  EXPECT_EQ(play(frames).csv(), play(recorded()).csv());
}

TEST(RealCut, SaturatedSamplesAreAFault) {
  expect_fault_and_no_false_onset(changed([](CanFrame& frame, double t) {
                                    for (int i = 0; i < kSamples && frame.id == kVibration && t > 2.0 && t < 2.2; ++i) {
                                      set_sample(frame, i, (i / 5) % 2 == 0 ? 32767 : -32768);
                                    }
                                    return true;
                                  }),
                                  2.0, 2.3);
}

TEST(RealCut, AStuckSensorIsAFault) {
  expect_fault_and_no_false_onset(changed([](CanFrame& frame, double t) {
                                    for (int i = 0; i < kSamples && frame.id == kVibration && t > 2.0 && t < 2.1; ++i) {
                                      set_sample(frame, i, 1234);
                                    }
                                    return true;
                                  }),
                                  2.0, 2.2);
}

TEST(RealCut, AGapOfTwoTenthsIsAFault) {
  expect_fault_and_no_false_onset(
      changed([](const CanFrame& frame, double t) { return frame.id != kVibration || t < 2.0 || t > 2.2; }), 2.0, 2.4);
}

TEST(RealCut, AGapInsideTheChatterIsAFault) {
  expect_fault_and_no_false_onset(
      changed([](const CanFrame& frame, double t) { return frame.id != kVibration || t < 4.0 || t > 4.2; }), 4.0, 4.4);
}

TEST(RealCut, SpeedZeroWhileItCutsIsAFault) {
  expect_fault_and_no_false_onset(changed([](CanFrame& frame, double t) {
                                    if (frame.id == kSpindle && t > 2.0) set_speed(frame, 0.0);
                                    return true;
                                  }),
                                  2.0, 4.3);  // the light cut before 3.5 s is no louder than air
}

TEST(RealCut, AnImplausibleSpeedIsAFault) {  // a negative one looks like this in an unsigned signal: 429 million rpm
  for (const double rpm : {60000.0, 4294967295.0 / 10.0}) {
    expect_fault_and_no_false_onset(changed([&](CanFrame& frame, double t) {
                                      if (frame.id == kSpindle && t > 2.0) set_speed(frame, rpm);
                                      return true;
                                    }),
                                    2.0, 2.2);
  }
}

TEST(RealCut, SpeedThatStopsComingIsAFault) {
  expect_fault_and_no_false_onset(
      changed([](const CanFrame& frame, double t) { return frame.id != kSpindle || t < 2.0; }), 2.0, 2.5);
}

TEST(RealCut, SpeedThatNeverComesIsAFaultAndNoOnset) {
  const Frames frames = changed([](const CanFrame& frame, double) { return frame.id != kSpindle; });
  const Played played = play(frames);
  EXPECT_FALSE(played.of(EventType::fault).empty());
  EXPECT_TRUE(played.of(EventType::chatter_onset).empty());
  EXPECT_TRUE(played.of(EventType::correction).empty());
}

TEST(RealCut, AStampThatGoesBackIsAFaultAndLittleElse) {
  Frames frames = recorded();
  const auto at = std::find_if(frames.begin(), frames.end(),
                               [](const CanFrame& f) { return f.id == kVibration && time_of(f) > 2.0; });
  at->stamp_ns -= 500'000'000;
  const Played played = play(frames);
  const std::vector<Event> faults = played.of(EventType::fault);
  EXPECT_TRUE(std::any_of(faults.begin(), faults.end(), [](const Event& fault) {
    return std::string(fault.note.data()).starts_with("stamp goes back");
  }));
  expect_one_episode(played);
}

}  // namespace
}  // namespace stillcut
