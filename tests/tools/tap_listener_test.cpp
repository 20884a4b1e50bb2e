// Taps heard on a CAN bus: samples of hammer and accelerometer side by side, and every hit judged.
#include "tools/tap_listener.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "drivers/files/input_error.hpp"
#include "models/tap_estimate.hpp"
#include "tests/tools/tapped_cell.hpp"

namespace stillcut {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr HammerDirection kAlongX{0, 1.0};

std::vector<HeardTap> heard_of(const std::vector<CanFrame>& frames, const Cell& cell,
                               const TapSettings& settings = {}) {
  TapListener listener(cell, 0, settings);
  std::vector<HeardTap> heard;
  for (const CanFrame& frame : frames)
    if (auto tap = listener.add(frame)) heard.push_back(std::move(*tap));
  return heard;
}

double worst_of(const std::vector<HeardTap>& heard, const TapSettings& settings = {}) {
  std::vector<TapRecording> recordings;
  for (const HeardTap& tap : heard) recordings.push_back(tap.recording);
  return off_at_resonances(estimate_taps(recordings, settings).h1, home_modes(), 0, kAlongXResonances);
}

// The whole way but the terminal. Breaks with a sample too early or late: 1 of 25600 Hz is 10 degrees at 750 Hz.
TEST(TapListener, GivesTheClosedFormOfTheStructure) {
  const std::vector<SimulatedTap> taps(2, {.hammer = kAlongX});
  const std::vector<HeardTap> heard = heard_of(frames_of_taps(tapped_demo_cell(), taps), tapped_demo_cell());
  ASSERT_EQ(heard.size(), 2U);
  for (const HeardTap& tap : heard) {
    EXPECT_EQ(tap.refusal, "");
    EXPECT_NEAR(tap.peak_n, 800.0, 10.0);
  }
  EXPECT_LT(worst_of(heard), 0.01);
}

// Frames of the hammer come behind those of the accelerometer, now and then very late, and its first ones are not
// there: the bus has one wire, and somebody switches on first.
TEST(TapListener, DoesNotMindHowLateFramesAre) {
  const std::vector<SimulatedTap> taps(2, {.hammer = kAlongX});
  std::vector<CanFrame> frames = frames_of_taps(tapped_demo_cell(), taps);
  const std::uint32_t hammer_id = 320;
  std::mt19937_64 random(5);
  std::size_t hammers = 0;
  std::erase_if(frames, [&](const CanFrame& frame) { return frame.id == hammer_id && hammers++ < 7; });
  std::int64_t newest_ns = 0;
  for (CanFrame& frame : frames) {
    if (frame.id != hammer_id) continue;
    const std::int64_t late_us = static_cast<std::int64_t>(100 + random() % 60 + (random() % 20 == 0 ? 3000 : 0));
    newest_ns = frame.stamp_ns = std::max(frame.stamp_ns + 1000 * late_us, newest_ns + 1000);
  }
  std::ranges::stable_sort(frames, {}, &CanFrame::stamp_ns);
  const std::vector<HeardTap> heard = heard_of(frames, tapped_demo_cell());
  ASSERT_EQ(heard.size(), 2U);
  EXPECT_LT(worst_of(heard), 0.01);
}

TEST(TapListener, RefusesEachBadHitAndHearsTheNextOne) {
  const std::vector<SimulatedTap> taps{{.hammer = kAlongX, .rebound_n = 200.0}, {.hammer = kAlongX, .peak_n = 60.0},
                                       {.hammer = kAlongX, .peak_n = 1500.0},   {.hammer = kAlongX, .peak_n = -500.0},
                                       {.hammer = kAlongX, .duration_s = 0.06}, {.hammer = kAlongX}};
  Cell cell = tapped_demo_cell();
  cell.can->hammer->full_scale_n = 1400.0;
  const std::vector<HeardTap> heard = heard_of(frames_of_taps(cell, taps), cell);
  std::vector<std::string> refusals;
  for (const HeardTap& tap : heard) refusals.push_back(tap.refusal);
  EXPECT_THAT(refusals, testing::ElementsAre(HasSubstr("double hit: let the hammer rebound freely"),
                                             HasSubstr("too little force: hit harder"), HasSubstr("force overload"),
                                             HasSubstr("turn the hammer's sign"), HasSubstr("force lasts longer"), ""));
}

// The end of the sensor's own range, which nobody told: 16 bits of 0.06 m/s^2.
TEST(TapListener, SeesASensorThatIsBeyondItsRange) {
  const std::vector<SimulatedTap> taps{{.hammer = kAlongX, .peak_n = 3000.0, .duration_s = 0.0008}};
  const std::vector<HeardTap> heard = heard_of(frames_of_taps(tapped_demo_cell(), taps), tapped_demo_cell());
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_THAT(heard[0].refusal, HasSubstr("acceleration overload"));
  Cell cell = tapped_demo_cell();
  cell.can->accelerometers[0].full_scale_m_per_s2 = 100.0;
  const std::vector<HeardTap> told =
      heard_of(frames_of_taps(cell, std::vector<SimulatedTap>{{.hammer = kAlongX}}), cell);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_THAT(told[0].refusal, HasSubstr("acceleration overload"));
}

TEST(TapListener, RefusesAHitInWhichFramesAreLostAndOneThatIsCutOff) {
  const std::vector<SimulatedTap> taps(3, {.hammer = kAlongX});
  const std::vector<CanFrame> all = frames_of_taps(tapped_demo_cell(), taps);
  const auto seconds = [&](const CanFrame& frame) {
    return 1e-9 * static_cast<double>(frame.stamp_ns - all.front().stamp_ns);
  };
  std::vector<CanFrame> frames;
  for (const CanFrame& frame : all) {
    // Heard from the first pulse on, and not for 3 ms within the record of the second hit.
    if (seconds(frame) < 1.0005 || (seconds(frame) > 3.4 && seconds(frame) < 3.403)) continue;
    frames.push_back(frame);
  }
  const std::vector<HeardTap> heard = heard_of(frames, tapped_demo_cell());
  ASSERT_EQ(heard.size(), 3U);
  EXPECT_THAT(heard[0].refusal, HasSubstr("cut off"));
  EXPECT_THAT(heard[1].refusal, HasSubstr("frames were lost"));
  EXPECT_THAT(heard[2].refusal, IsEmpty());
}

// One of the two is switched on long after the other: what came before is let go, and the hit is heard all the same.
TEST(TapListener, HearsAHitAfterOneSideWasSilent) {
  const std::vector<SimulatedTap> taps{{.hammer = kAlongX}};
  const TapSettings settings{.record_s = 0.2};
  const std::vector<CanFrame> all = frames_of_taps(tapped_demo_cell(), taps, {.spacing_s = 6.0});
  for (const std::uint32_t silent : {288U, 320U}) {
    std::vector<CanFrame> frames = all;
    std::erase_if(frames, [&](const CanFrame& frame) {
      return frame.id == silent && frame.stamp_ns < all.front().stamp_ns + 2'500'000'000;
    });
    const std::vector<HeardTap> heard = heard_of(frames, tapped_demo_cell(), settings);
    ASSERT_EQ(heard.size(), 1U) << silent;
    EXPECT_EQ(heard[0].refusal, "");
    const TapRecording& recording = heard[0].recording;
    EXPECT_EQ(recording.force.size(), record_samples(settings, 25600.0));
    // The tool's point is moved by the hammer's first samples, not before.
    const auto moves = [](const std::vector<double>& values, double from) {
      return std::ranges::find_if(values, [&](double value) { return std::abs(value) > from; }) - values.begin();
    };
    EXPECT_NEAR(moves(recording.force, 5.0), moves(recording.acceleration[0], 5.0), 5) << silent;
  }
}

TEST(TapListener, RefusesACellThatCannotBeTapped) {
  const auto message = [](auto spoil, std::size_t sensor = 0) {
    Cell cell = tapped_demo_cell();
    spoil(cell);
    return message_of<InputError>([&] { (void)TapListener(cell, sensor, {}); });
  };
  const std::string line = std::to_string(tapped_demo_cell().can->hammer->line);
  EXPECT_THAT(message([](Cell& c) { c.can->hammer.reset(); }), HasSubstr("can.hammer: is missing; add [can.hammer]"));
  EXPECT_THAT(message([](Cell& c) { c.can.reset(); }), HasSubstr("[can] is missing"));
  EXPECT_THAT(message([](Cell&) {}, 1), HasSubstr("there are 1, number 2 is asked for"));
  EXPECT_THAT(message([](Cell& c) { c.can->hammer->sample_rate_hz = 12800.0; }),
              HasSubstr("cell.toml:" + line + ": can.hammer.sample_rate_hz: 12800, but the accelerometer's is 25600"));
  EXPECT_THAT(message([](Cell& c) { c.can->hammer->force = "Hammer.Force{0..19}"; }),
              HasSubstr("cell.toml:" + line + ": can.hammer.force_n: "));
}

}  // namespace
}  // namespace stillcut
