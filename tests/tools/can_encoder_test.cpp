#include "tools/can_encoder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "drivers/can/decoder.hpp"
#include "models/machining.hpp"

namespace stillcut {
namespace {

constexpr const char* kDbc = R"(VERSION ""
BO_ 288 Vibration: 20 SENSOR
 SG_ Counter : 0|4@1+ (1,0) [0|15] "" MONITOR
 SG_ X0 : 16|16@1- (0.01,0) [0|0] "m/s^2" MONITOR
 SG_ X1 : 32|16@1- (0.01,0) [0|0] "m/s^2" MONITOR
 SG_ Y0 : 55|16@0- (0.01,0) [0|0] "m/s^2" MONITOR
 SG_ Y1 : 71|16@0- (0.01,0) [0|0] "m/s^2" MONITOR
 SG_ Z0 : 80|32@1- (1,0) [0|0] "m/s^2" MONITOR
 SG_ Z1 : 112|32@1- (1,0) [0|0] "m/s^2" MONITOR
BO_ 304 Spindle: 8 DRIVE
 SG_ Speed : 0|32@1+ (0.1,0) [0|60000] "rpm" MONITOR
SIG_VALTYPE_ 288 Z0 : 1;
SIG_VALTYPE_ 288 Z1 : 1;
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_ "GenMsgCycleTime" BO_ 304 10;
)";
constexpr double kRate = 8000.0;
constexpr std::int64_t kOrigin = 1'700'000'000'000'000'000;

CanSettings settings() {
  CanSettings can;
  AccelerometerSettings sensor;
  sensor.sample_rate_hz = kRate;
  sensor.axis = {"Vibration.X{0..1}", "Vibration.Y{0..1}", "Vibration.Z{0..1}"};
  sensor.counter = "Vibration.Counter";
  sensor.rotation = {0.0, 0.0, deg_to_rad(90)};
  can.accelerometers.push_back(sensor);
  can.spindle_speed = "Spindle.Speed";
  return can;
}

constexpr double kAmplitude = 50.0, kFrequency = 120.0;  // m/s^2, Hz
Eigen::Vector3d velocity_at(double t) {                  // of an acceleration (A cos wt, 2 A sin wt, A/2 cos wt)
  const double w = kTwoPi * kFrequency, a = kAmplitude;
  return {a / w * std::sin(w * t), -2 * a / w * (std::cos(w * t) - 1.0), 0.5 * a / w * std::sin(w * t)};
}

std::vector<CanFrame> frames_of(CanEncoder& encoder, double seconds, double step, double scale = 1.0) {
  std::vector<CanFrame> frames;
  for (int i = 0; i * step <= seconds + 1e-12; ++i) {
    const auto due = encoder.advance(i * step, scale * velocity_at(i * step), rpm_to_rad_s(9000 - 1000 * i * step));
    frames.insert(frames.end(), due.begin(), due.end());
  }
  return frames;
}

TEST(CanEncoder, TheDecoderReadsBackTheMotion) {
  const Dbc dbc = parse_dbc(kDbc, "test.dbc");
  CanEncoder encoder(dbc, settings(), "cell.toml", {}, kOrigin);
  const std::vector<CanFrame> frames = frames_of(encoder, 0.1, 1.0 / 40e3);
  Decoder decoder(dbc, settings(), "cell.toml");
  Decoded decoded;
  int blocks = 0, speeds = 0;
  std::int64_t last_stamp = 0;
  for (const CanFrame& frame : frames) {
    EXPECT_GE(frame.stamp_ns, last_stamp);
    last_stamp = frame.stamp_ns;
    decoded = {};
    ASSERT_TRUE(decoder.decode(frame, decoded));
    ASSERT_FALSE(decoded.bad);
    if (decoded.has_speed) {
      const double t = static_cast<double>(frame.stamp_ns - kOrigin) * 1e-9;
      EXPECT_NEAR(rad_s_to_rpm(decoded.spindle.speed), 9000 - 1000 * t, 0.051);
      ++speeds;
    }
    if (decoded.blocks == 0) continue;
    const SampleBlock& block = decoded.block[0];
    ASSERT_EQ(block.samples, 2);
    for (int i = 0; i < 2; ++i) {
      const double t = (2 * blocks + i + 1) / kRate, w = kTwoPi * kFrequency;
      if (i == 1) {
        EXPECT_NEAR(static_cast<double>(block.stamp_ns - kOrigin) * 1e-9, t, 0.6e-6);
      }
      const double middle = w * (t - 0.5 / kRate);  // a sample is the mean over its interval
      const auto n = static_cast<std::size_t>(i);
      ASSERT_NEAR(block.acceleration[0][n], kAmplitude * std::cos(middle), 0.1);
      ASSERT_NEAR(block.acceleration[1][n], 2 * kAmplitude * std::sin(middle), 0.2);
      ASSERT_NEAR(block.acceleration[2][n], 0.5 * kAmplitude * std::cos(middle), 0.05);
    }
    ++blocks;
  }
  EXPECT_EQ(blocks, 400);
  EXPECT_EQ(speeds, 11);  // every 10 ms, time 0 included
  EXPECT_EQ(decoder.counters().frames_lost, 0);
  EXPECT_EQ(encoder.saturated(), 0);
}

TEST(CanEncoder, SaturatesLikeASensorAndTheDecoderSeesIt) {
  const Dbc dbc = parse_dbc(kDbc, "test.dbc");
  CanEncoder encoder(dbc, settings(), "cell.toml", {}, kOrigin);
  const std::vector<CanFrame> frames = frames_of(encoder, 0.05, 1.0 / 40e3, 5.0);  // y up to 500 m/s^2, range 327
  Decoder decoder(dbc, settings(), "cell.toml");
  Decoded decoded;
  std::int64_t full = 0;
  for (const CanFrame& frame : frames) {
    decoded = {};
    decoder.decode(frame, decoded);
    if (decoded.blocks == 0) continue;
    for (const std::size_t axis : {0U, 1U, 2U}) {
      full += __builtin_popcountll(decoded.block[0].full_scale[axis]);
      for (int i = 0; i < 2; ++i) {
        ASSERT_LE(std::abs(decoded.block[0].acceleration[axis][static_cast<std::size_t>(i)]), 327.681);
      }
    }
  }
  EXPECT_GT(encoder.saturated(), 100);
  EXPECT_EQ(full, encoder.saturated());
}

TEST(CanEncoder, NoiseHasTheAskedSizeAndFollowsTheSeed) {
  const Dbc dbc = parse_dbc(kDbc, "test.dbc");
  const auto frames = [&](std::uint64_t seed) {
    CanEncoder encoder(dbc, settings(), "cell.toml", {2.0, seed}, kOrigin);
    return frames_of(encoder, 1.0, 1.0 / 8e3, 0.0);
  };
  const std::vector<CanFrame> first = frames(1), again = frames(1), other = frames(2);
  ASSERT_EQ(first.size(), again.size());
  bool differs = false;
  double sum = 0.0, count = 0.0;
  Decoder decoder(dbc, settings(), "cell.toml");
  Decoded decoded;
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_EQ(first[i].data, again[i].data);
    differs = differs || first[i].data != other[i].data;
    decoded = {};
    decoder.decode(first[i], decoded);
    if (decoded.blocks == 0) continue;
    for (std::size_t k = 0; k < 2; ++k, ++count) sum += std::pow(decoded.block[0].acceleration[0][k], 2);
  }
  EXPECT_TRUE(differs);
  EXPECT_NEAR(std::sqrt(sum / count), 2.0, 0.1);
}

}  // namespace
}  // namespace stillcut
