// Values of the core become samples of the ROS 2 types: times, levels, what is unknown. That every member arrives is
// shown beside another DDS implementation, in tests/system/dds.
#include "drivers/dds/samples.hpp"

#include <gtest/gtest.h>
#include <telemetryPubSubTypes.h>

#include <cmath>
#include <random>

namespace stillcut {
namespace {

TEST(DdsSamples, ATimeIsWholeSecondsAndTheRestOverTheWholeRange) {
  std::mt19937_64 random{1};
  constexpr std::int64_t kLimit_s = std::int64_t{1} << 31;
  std::uniform_int_distribution<std::int64_t> stamps{-kLimit_s * 1'000'000'000, kLimit_s * 1'000'000'000 - 1};
  for (int i = 0; i < 10'000; ++i) {
    const std::int64_t stamp = stamps(random);
    const TimeSample time = time_sample(stamp);
    EXPECT_LT(time.nanosec(), 1'000'000'000U);
    EXPECT_EQ(std::int64_t{time.sec()} * 1'000'000'000 + time.nanosec(), stamp);
  }
  EXPECT_EQ(time_sample(-1).sec(), -1);
  EXPECT_EQ(time_sample(-1).nanosec(), 999'999'999U);
  EXPECT_EQ(time_sample(INT64_MAX).sec(), INT32_MAX) << "what the type cannot say is its end";
  EXPECT_EQ(time_sample(INT64_MIN).sec(), INT32_MIN);
}

TEST(DdsSamples, LevelsOfASpectrumAreAmplitudes) {
  SpectrumReport report;
  report.low_db = -40.0;
  report.step_db = 20.0;
  report.levels = {0, 1, 2, 3};
  const SpectrumSample sample = sample_of(report);
  ASSERT_EQ(sample.amplitude_m_per_s2().size(), 4U);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_FLOAT_EQ(sample.amplitude_m_per_s2()[i], std::pow(10.0F, static_cast<float>(i) - 2.0F));
}

TEST(DdsSamples, EachVibrationHasItsOwnTimeAndTheLastTheReports) {
  VibrationReport report;
  report.stamp_ns = 1'700'000'000'040'000'000;
  report.rate_hz = 200.0;
  for (int i = 0; i < 10; ++i) report.samples.push_back({static_cast<float>(i), -1.0F, std::nanf("")});
  const std::vector<ImuSample> samples = samples_of(report);
  ASSERT_EQ(samples.size(), 10U);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::int64_t stamp_ns = report.stamp_ns - static_cast<std::int64_t>(9 - i) * 5'000'000;
    EXPECT_EQ(samples[i].header().stamp().sec(), stamp_ns / 1'000'000'000);
    EXPECT_EQ(samples[i].header().stamp().nanosec(), stamp_ns % 1'000'000'000);
    EXPECT_EQ(samples[i].linear_acceleration().x(), static_cast<double>(i));
    EXPECT_TRUE(std::isnan(samples[i].linear_acceleration().z())) << "an axis that is not measured";
    EXPECT_EQ(samples[i].orientation_covariance()[0], -1.0);
    EXPECT_EQ(samples[i].angular_velocity_covariance()[0], -1.0);
    EXPECT_EQ(samples[i].header().frame_id(), "tool");
  }
  report.sensor = 2;
  EXPECT_EQ(samples_of(report).front().header().frame_id(), "tool_2");
}

TEST(DdsSamples, WithoutARateOnlyTheLastVibrationHasATime) {
  for (const double rate_hz : {0.0, -200.0, kNaN, 1e-300}) {
    VibrationReport report;
    report.stamp_ns = 5'000'000'000;
    report.rate_hz = rate_hz;
    report.samples = {{1.0F, 1.0F, 1.0F}, {2.0F, 2.0F, 2.0F}};
    const std::vector<ImuSample> samples = samples_of(report);
    ASSERT_EQ(samples.size(), 1U) << rate_hz;
    EXPECT_EQ(samples[0].linear_acceleration().x(), 2.0);
    EXPECT_EQ(samples[0].header().stamp().sec(), 5);
    report.samples.clear();
    EXPECT_TRUE(samples_of(report).empty());
  }
}

TEST(DdsSamples, TypesHaveTheNamesThatRos2GivesThem) {
  EXPECT_STREQ(stillcut_msgs::msg::dds_::Status_PubSubType{}.getName(), "stillcut_msgs::msg::dds_::Status_");
  EXPECT_STREQ(sensor_msgs::msg::dds_::Imu_PubSubType{}.getName(), "sensor_msgs::msg::dds_::Imu_");
  EXPECT_STREQ(diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType{}.getName(),
               "diagnostic_msgs::msg::dds_::DiagnosticArray_");
}

// The classic common data representation by hand: 4 bytes that say little endian, then each member at a multiple of its
// size; a string is its length with the zero, and its characters.
TEST(DdsSamples, OnTheWireAnEventIsClassicCdr) {
  Event event;
  event.stamp_ns = 3'000'000'004;
  event.type = EventType::chatter_onset;
  event.kind = ChatterKind::structural;
  event.frequency_hz = 700.0;
  event.indicator = 1.5;
  event.spindle_speed_rpm = 9000.0;
  event.note = short_text("abc");
  std::vector<std::uint8_t> expected{0, 1, 0, 0};
  const auto put = [&](const auto value) {
    while ((expected.size() - 4) % sizeof value != 0) expected.push_back(0);
    std::array<std::uint8_t, sizeof value> bytes{};
    std::memcpy(bytes.data(), &value, sizeof value);
    expected.insert(expected.end(), bytes.begin(), bytes.end());
  };
  put(std::int32_t{3});
  put(std::uint32_t{4});
  put(std::uint32_t{1});  // the empty frame's zero
  put(std::uint8_t{0});
  put(std::uint8_t{3});
  put(std::uint8_t{2});
  put(700.0);
  put(1.5);
  put(9000.0);
  put(std::uint32_t{4});
  for (const char c : {'a', 'b', 'c', '\0'}) put(static_cast<std::uint8_t>(c));

  stillcut_msgs::msg::dds_::Event_PubSubType type;
  EventSample sample = sample_of(event);
  eprosima::fastrtps::rtps::SerializedPayload_t payload{type.getSerializedSizeProvider(&sample)()};
  ASSERT_TRUE(type.serialize(&sample, &payload));
  EXPECT_EQ(std::vector<std::uint8_t>(payload.data, payload.data + payload.length), expected);
}

}  // namespace
}  // namespace stillcut
