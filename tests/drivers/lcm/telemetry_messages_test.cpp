#include "drivers/lcm/telemetry_messages.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "drivers/lcm/connection.hpp"
#include "drivers/lcm/telemetry_listener.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kWhen_ns = 1'795'000'000'123'456'000;

SpectrumReport some_spectrum() {
  SpectrumReport report{kWhen_ns, 1, 3, 0.16, 9.77, 55.5, -80.0, 0.5, {}};
  for (int i = 0; i < 512; ++i) report.levels.push_back(static_cast<std::uint8_t>(i % 251));
  return report;
}
VibrationReport some_vibration() {
  VibrationReport report{kWhen_ns, 0, 200.0, {}};
  for (int i = 0; i < 10; ++i) report.samples.push_back({static_cast<float>(i), -1.5F, 9.81F});
  return report;
}
DiagramReport some_diagram() {
  DiagramReport report{kWhen_ns, kWhen_ns - 1000, true, 2800, 3800, 0.01, 0.1, {12.5F, 400.0F}, {0.03F, 0.02F}, {}};
  for (int i = 0; i < 201; ++i) report.depth_limit_mm.push_back(0.01F * static_cast<float>(i));
  return report;
}
HealthReport some_health() {
  HealthReport report;
  report.stamp_ns = kWhen_ns;
  report.bus_state = 1;
  report.doubts = 5;
  report.frames = 1000;
  report.publish_failed = 7;
  report.sensors = {{25600, 25598.5, 3, 1, 4, 0}, {10000, kNaN, 0, 0, 0, 9}};
  return report;
}
HistogramReport some_histogram() {
  LoopTimes times;
  for (int i = 1; i < 2000; ++i) times.loop.execution.record(std::int64_t{i} * 1000);
  times.decision.record(3'000'000'000);
  return histogram_report(times, kWhen_ns);
}
MessageBytes some_latency() {
  LoopTimes times;
  times.loop.wakeup.record(21'000);
  return encode(latency_report(times, kWhen_ns));
}

struct Named {
  const char* channel;
  MessageBytes bytes;
};
std::vector<Named> one_of_each() {
  MonitorReport monitor;
  monitor.stamp_ns = kWhen_ns;
  monitor.state = State::chatter;
  monitor.chatter = true;
  monitor.kind = ChatterKind::structural;
  monitor.chatter_mode = 2;
  return {{kMonitorChannel, encode(monitor)},
          {kSpectrumChannel, encode(some_spectrum())},
          {kVibrationChannel, encode(some_vibration())},
          {kDiagramChannel, encode(some_diagram())},
          {kHealthChannel, encode(some_health())},
          {kHistogramChannel, encode(some_histogram())},
          {kLatencyChannel, some_latency()},
          {kStatusChannel, encode(Status{})},
          {kEventChannel, encode(Event{})},
          {kCorrectionChannel, encode(Correction{})}};
}

TEST(TelemetryMessages, EveryReportComesBackAsItWas) {
  const auto spectrum = decode_spectrum(encode(some_spectrum()));
  ASSERT_TRUE(spectrum.ok());
  EXPECT_EQ(spectrum.value.levels, some_spectrum().levels);
  EXPECT_EQ(spectrum.value.stamp_ns, kWhen_ns);
  EXPECT_EQ(spectrum.value.spindle_hz, 55.5);
  const auto vibration = decode_vibration(encode(some_vibration()));
  ASSERT_TRUE(vibration.ok());
  EXPECT_EQ(vibration.value.samples, some_vibration().samples);
  const auto diagram = decode_diagram(encode(some_diagram()));
  ASSERT_TRUE(diagram.ok());
  EXPECT_EQ(diagram.value.depth_limit_mm, some_diagram().depth_limit_mm);
  EXPECT_EQ(diagram.value.mode_damping, some_diagram().mode_damping);
  const auto health = decode_health(encode(some_health()));
  ASSERT_TRUE(health.ok());
  ASSERT_EQ(health.value.sensors.size(), 2U);
  EXPECT_EQ(health.value.sensors[0].rate_hz, 25598.5);
  EXPECT_TRUE(std::isnan(health.value.sensors[1].rate_hz));
  EXPECT_EQ(health.value.sensors[1].not_finite, 9);
  EXPECT_EQ(health.value.publish_failed, 7);
  const auto histogram = decode_histogram(encode(some_histogram()));
  ASSERT_TRUE(histogram.ok());
  EXPECT_EQ(histogram.value.tick, some_histogram().tick);
  const auto latency = decode_latency(some_latency());
  ASSERT_TRUE(latency.ok());
  ASSERT_EQ(latency.value.stages.size(), kNamedLatencies);
  EXPECT_EQ(latency.value.stages[0].name, "wake-up");
  EXPECT_EQ(latency.value.stages[0].max_us, 21.0);
}

TEST(TelemetryMessages, AHistogramHoldsEveryTimeInItsBucket) {
  const HistogramReport report = some_histogram();
  std::int64_t all = 0;
  for (const std::int64_t count : report.tick) all += count;
  EXPECT_EQ(all, 1999);
  EXPECT_EQ(report.decision.back(), 1);  // beyond the last bucket
  // 1000 to 1999 us lie in the octave from 2^10 us on and in the last bucket below it.
  std::int64_t above = 0;
  for (std::size_t i = 10 * HistogramReport::kPerOctave; i < report.tick.size(); ++i) above += report.tick[i];
  EXPECT_NEAR(static_cast<double>(above), 976.0, 32.0);
}

TEST(TelemetryMessages, MessagesFitOnePacketOfAnEthernet) {
  for (const Named& message : one_of_each()) EXPECT_LT(message.bytes.size(), 1400U) << message.channel;
}

TEST(TelemetryMessages, SpoiltBytesAreRefusedOrDecodedButNeverCrash) {
  std::mt19937 random{11};
  int refused = 0;
  for (const Named& message : one_of_each()) {
    ASSERT_TRUE(decode_telemetry(message.channel, message.bytes).ok()) << message.channel;
    for (std::size_t length = 0; length < message.bytes.size(); length += 1 + length / 16)
      EXPECT_FALSE(decode_telemetry(message.channel, std::span{message.bytes}.first(length)).ok());
    for (int round = 0; round < 400; ++round) {
      MessageBytes spoilt = message.bytes;
      for (unsigned hits = 1 + random() % 4; hits > 0; --hits)
        spoilt[random() % std::min<std::size_t>(spoilt.size(), 160)] = static_cast<std::uint8_t>(random());
      refused += decode_telemetry(message.channel, spoilt).ok() ? 0 : 1;
    }
  }
  EXPECT_GT(refused, 100);
  EXPECT_FALSE(decode_telemetry("SOMEBODY_ELSES", one_of_each()[0].bytes).ok());
}

TEST(TelemetryListener, HearsWhatIsPublishedAndCountsWhatItCannotRead) {
  const LcmConnection lcm = open_lcm("memq://");
  std::atomic<int> spectra{0}, bad{0};
  const TelemetryListener listener{
      lcm,
      {.on_message = [&](const TelemetryMessage& m) { spectra += std::holds_alternative<SpectrumReport>(m) ? 1 : 0; },
       .on_bad = [&](std::string_view, const char*) { ++bad; }}};
  const auto send = [&](const char* channel, const MessageBytes& bytes) {
    lcm_publish(lcm.get(), channel, bytes.data(), static_cast<unsigned>(bytes.size()));
  };
  for (const Named& message : one_of_each()) send(message.channel, message.bytes);
  send(kSpectrumChannel, {1, 2, 3});
  while (listener.received() < 10 || listener.bad() < 1) std::this_thread::yield();
  EXPECT_EQ(spectra, 1);
  EXPECT_EQ(bad, 1);
}

}  // namespace
}  // namespace stillcut
