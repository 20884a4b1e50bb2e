#include "drivers/can/decoder.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/drivers/can/triaxial_cell.hpp"

namespace stillcut {
namespace {

constexpr double kScale = 0.0047884;

// A frame of the triaxial layout: counter, number of samples, flags, then x, y, z of each sample.
CanFrame vibration_frame(int counter, const std::array<std::array<std::int16_t, 10>, 3>& raw) {
  CanFrame frame;
  frame.id = 288;
  frame.fd = true;
  frame.length = 64;
  frame.stamp_ns = counter * 375'000LL;
  frame.data[0] = static_cast<std::uint8_t>(counter);
  frame.data[1] = static_cast<std::uint8_t>(counter >> 8);
  frame.data[2] = 10;
  for (std::size_t i = 0; i < 10; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto bits = static_cast<std::uint16_t>(raw[axis][i]);
      frame.data[4 + 6 * i + 2 * axis] = static_cast<std::uint8_t>(bits);
      frame.data[5 + 6 * i + 2 * axis] = static_cast<std::uint8_t>(bits >> 8);
    }
  }
  return frame;
}

CanFrame vibration_frame(int counter) { return vibration_frame(counter, {}); }

CanFrame spindle_frame(std::uint32_t tenth_rpm) {
  CanFrame frame;
  frame.id = 0x18FEF100U | CanFrame::kExtended;
  frame.length = 8;
  frame.stamp_ns = 7'000;
  for (int i = 0; i < 3; ++i)
    frame.data[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(tenth_rpm >> (16 - 8 * i));
  return frame;
}

class TriaxialDecoder : public testing::Test {
 protected:
  Decoder decoder(const CanSettings& can) { return Decoder(dbc_, can, "cell.toml"); }
  Dbc dbc_ = read_dbc(TEST_DATA "/triaxial.dbc");
  CanSettings can_ = triaxial_cell();
  Decoded out_;
};

TEST_F(TriaxialDecoder, DecodesEveryAxisOldestFirst) {
  std::mt19937_64 random(7);
  Decoder decode = decoder(can_);
  for (int n = 0; n < 200; ++n) {
    std::array<std::array<std::int16_t, 10>, 3> raw{};
    for (auto& axis : raw) {
      for (std::int16_t& value : axis) value = static_cast<std::int16_t>(random());
    }
    ASSERT_TRUE(decode.decode(vibration_frame(n, raw), out_));
    ASSERT_EQ(out_.blocks, 1);
    const SampleBlock& block = out_.block[0];
    EXPECT_EQ(block.stamp_ns, n * 375'000LL);
    EXPECT_EQ(block.samples, 10);
    EXPECT_EQ(block.axes_present, 7);
    EXPECT_EQ(block.frames_lost, 0U);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t i = 0; i < 10; ++i) {
        ASSERT_EQ(block.acceleration[axis][i], static_cast<float>(raw[axis][i] * kScale));
      }
    }
  }
  EXPECT_FALSE(out_.has_speed);
  EXPECT_EQ(decode.counters().frames_bad, 0);
}

TEST_F(TriaxialDecoder, ConvertsTheUnit) {
  can_.accelerometers[0].unit_m_per_s2 = 9.80665;
  Decoder decode = decoder(can_);
  decode.decode(vibration_frame(0, {{{1000}}}), out_);
  EXPECT_FLOAT_EQ(out_.block[0].acceleration[0][0], static_cast<float>(1000 * kScale * 9.80665));
}

TEST_F(TriaxialDecoder, MarksSamplesAtTheEndOfTheirRange) {
  Decoder decode = decoder(can_);
  std::array<std::array<std::int16_t, 10>, 3> raw{};
  raw[0][2] = 32767;
  raw[0][3] = 32766;
  raw[1][9] = -32768;
  raw[2][0] = -32767;
  decode.decode(vibration_frame(0, raw), out_);
  EXPECT_EQ(out_.block[0].full_scale[0], 1U << 2);
  EXPECT_EQ(out_.block[0].full_scale[1], 1U << 9);
  EXPECT_EQ(out_.block[0].full_scale[2], 0U);
}

TEST_F(TriaxialDecoder, MarksSamplesOutsideTheRangeTheDbcTells) {
  Dbc narrow = dbc_;
  for (DbcSignal& signal : narrow.messages[0].signals) {
    signal.minimum = -100.0;
    signal.maximum = 100.0;
  }
  Decoder decode(narrow, can_, "cell.toml");
  decode.decode(vibration_frame(0, {{{20'800, 20'900, -20'800, -20'900}}}), out_);  // 99.6 and 100.08 m/s^2
  EXPECT_EQ(out_.block[0].full_scale[0], 0b1010U);
}

TEST_F(TriaxialDecoder, CountsLostFramesAcrossTheCountersWrap) {
  Decoder decode = decoder(can_);
  const std::array<int, 7> counters = {65'530, 65'531, 65'535, 0, 1, 5, 65'535};
  const std::array<std::uint32_t, 7> lost = {0, 0, 3, 0, 0, 3, 65'529};
  std::int64_t total = 0;
  for (std::size_t i = 0; i < counters.size(); ++i) {
    decode.decode(vibration_frame(counters[i]), out_);
    ASSERT_EQ(out_.blocks, 1);
    EXPECT_EQ(out_.block[0].frames_lost, lost[i]) << i;
    total += lost[i];
  }
  EXPECT_EQ(decode.counters().frames_lost, total);
}

TEST_F(TriaxialDecoder, DropsADoubledFrameAndGoesOn) {
  Decoder decode = decoder(can_);
  decode.decode(vibration_frame(4), out_);
  EXPECT_TRUE(decode.decode(vibration_frame(4), out_));
  EXPECT_EQ(out_.blocks, 0);
  EXPECT_TRUE(out_.bad);
  decode.decode(vibration_frame(5), out_);
  ASSERT_EQ(out_.blocks, 1);
  EXPECT_FALSE(out_.bad);
  EXPECT_EQ(out_.block[0].frames_lost, 0U);
  EXPECT_EQ(decode.counters().frames_bad, 1);
  EXPECT_EQ(decode.counters().duplicates, 1);
}

TEST_F(TriaxialDecoder, CallsAShortFrameBadAndItsSamplesLost) {
  Decoder decode = decoder(can_);
  decode.decode(vibration_frame(0), out_);
  CanFrame cut = vibration_frame(1);
  cut.length = 62;
  EXPECT_TRUE(decode.decode(cut, out_));
  EXPECT_TRUE(out_.bad);
  EXPECT_EQ(out_.blocks, 0);
  decode.decode(vibration_frame(2), out_);
  EXPECT_EQ(out_.block[0].frames_lost, 1U);

  can_.accelerometers[0].counter.clear();  // known to be missing also without a counter
  Decoder without_counter = decoder(can_);
  without_counter.decode(vibration_frame(0), out_);
  without_counter.decode(cut, out_);
  without_counter.decode(vibration_frame(0), out_);
  ASSERT_EQ(out_.blocks, 1);
  EXPECT_EQ(out_.block[0].frames_lost, 1U);
  without_counter.decode(vibration_frame(0), out_);
  EXPECT_EQ(out_.block[0].frames_lost, 0U);
}

TEST_F(TriaxialDecoder, PassesOverFramesOfOthers) {
  Decoder decode = decoder(can_);
  CanFrame frame = vibration_frame(0);
  for (const std::uint32_t flag : {CanFrame::kExtended, CanFrame::kRemote, CanFrame::kError}) {
    frame.id = 288 | flag;
    EXPECT_FALSE(decode.decode(frame, out_));
  }
  frame.id = 289;
  EXPECT_FALSE(decode.decode(frame, out_));
  EXPECT_FALSE(out_.bad);
}

TEST_F(TriaxialDecoder, ReadsTheSpindleSpeed) {
  Decoder decode = decoder(can_);
  EXPECT_TRUE(decode.decode(spindle_frame(33'300), out_));
  ASSERT_TRUE(out_.has_speed);
  EXPECT_EQ(out_.blocks, 0);
  EXPECT_EQ(out_.spindle.stamp_ns, 7'000);
  EXPECT_NEAR(out_.spindle.speed, 3330.0 * 2.0 * std::numbers::pi / 60.0, 1e-9);
  decode.decode(spindle_frame(0xFFFFFF), out_);  // -0.1 rpm: passed on as it is
  EXPECT_NEAR(out_.spindle.speed, -0.1 * 2.0 * std::numbers::pi / 60.0, 1e-12);

  CanFrame cut = spindle_frame(33'300);
  cut.length = 2;
  EXPECT_TRUE(decode.decode(cut, out_));
  EXPECT_TRUE(out_.bad);
  ASSERT_TRUE(out_.has_speed);
  EXPECT_TRUE(std::isnan(out_.spindle.speed));
}

TEST_F(TriaxialDecoder, NamesTheIdentifiersItUses) {
  EXPECT_EQ(decoder(can_).ids_used(), (std::vector<std::uint32_t>{288, 0x18FEF100U | CanFrame::kExtended}));
}

TEST_F(TriaxialDecoder, ReadsMultiplexedSignalsOnlyWhenTheirValueIsSent) {
  can_.spindle_speed = "Status.Temperature";  // a float, sent when Page is 1
  Decoder decode = decoder(can_);
  CanFrame frame;
  frame.id = 512;
  frame.length = 8;
  frame.data[0] = 0;
  EXPECT_FALSE(decode.decode(frame, out_));
  frame.data[0] = 1;
  const auto bits = std::bit_cast<std::uint32_t>(60.0F);
  for (std::size_t i = 0; i < 4; ++i) frame.data[1 + i] = static_cast<std::uint8_t>(bits >> (8 * i));
  EXPECT_TRUE(decode.decode(frame, out_));
  EXPECT_NEAR(out_.spindle.speed, 2.0 * std::numbers::pi, 1e-12);
  for (const float bad : {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    const auto bad_bits = std::bit_cast<std::uint32_t>(bad);
    for (std::size_t i = 0; i < 4; ++i) frame.data[1 + i] = static_cast<std::uint8_t>(bad_bits >> (8 * i));
    decode.decode(frame, out_);
    EXPECT_TRUE(std::isnan(out_.spindle.speed));
  }
}

TEST_F(TriaxialDecoder, ServesSeveralSensorsAndTheSpeedFromOneFrame) {
  can_.accelerometers.push_back(can_.accelerometers[0]);
  can_.accelerometers[1].axis = {"Vibration.Z9", "", ""};
  can_.spindle_speed = "Vibration.Flags";
  Decoder decode = decoder(can_);
  CanFrame frame = vibration_frame(0, {{{}, {}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 1000}}});
  frame.data[3] = 60;
  EXPECT_TRUE(decode.decode(frame, out_));
  ASSERT_EQ(out_.blocks, 2);
  EXPECT_EQ(out_.block[0].sensor, 0);
  EXPECT_EQ(out_.block[1].sensor, 1);
  EXPECT_EQ(out_.block[1].axes_present, 1);
  EXPECT_EQ(out_.block[1].acceleration[0][0], static_cast<float>(1000 * kScale));
  ASSERT_TRUE(out_.has_speed);
  EXPECT_NEAR(out_.spindle.speed, 2.0 * std::numbers::pi, 1e-12);
}

TEST_F(TriaxialDecoder, TurnsQuarterTurnsExactly) {
  can_.accelerometers[0].rotation = {0.0, 0.0, std::numbers::pi / 2};  // sensor x is tool y
  can_.accelerometers[0].axis = {"Vibration.X{0..9}", "", ""};
  Decoder decode = decoder(can_);
  decode.decode(vibration_frame(0, {{{32767}}}), out_);
  EXPECT_EQ(out_.block[0].axes_present, 2);
  EXPECT_EQ(out_.block[0].acceleration[1][0], static_cast<float>(32767 * kScale));
  EXPECT_EQ(out_.block[0].full_scale[0], 0U);
  EXPECT_EQ(out_.block[0].full_scale[1], 1U);
}

TEST_F(TriaxialDecoder, RotatesAboutXThenYThenZ) {
  const std::array<double, 3> angles = {0.3, -0.7, 1.9};
  can_.accelerometers[0].rotation = angles;
  Decoder decode = decoder(can_);
  decode.decode(vibration_frame(0, {{{1000}, {-2000}, {32767}}}), out_);
  std::array<double, 3> v = {1000 * kScale, -2000 * kScale, 32767 * kScale};
  const auto turn = [](double& a, double& b, double angle) {  // each turn by itself, from a to b
    const double a0 = a;
    a = std::cos(angle) * a0 - std::sin(angle) * b;
    b = std::sin(angle) * a0 + std::cos(angle) * b;
  };
  turn(v[1], v[2], angles[0]);
  turn(v[2], v[0], angles[1]);
  turn(v[0], v[1], angles[2]);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(out_.block[0].acceleration[axis][0], v[axis], 1e-4);
    EXPECT_EQ(out_.block[0].full_scale[axis], 1U) << "z contributes to every tool axis";
  }
}

}  // namespace
}  // namespace stillcut
