#include "drivers/dds/diagnostics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "dsp/integrity.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000, kWhen = 1'700'000'000 * kSecond;
enum Part : std::uint8_t { monitor, sensors, bus, loop };

LatencyReport in_time() {
  LatencyReport report;
  report.stages = {{"tick", 1000, 20.0, 40.0, 80.0, 120.0}};
  return report;
}
HealthReport healthy() {
  HealthReport report;
  report.sensors = {{25600.0, 25599.0, 0, 0, 0, 0}};
  return report;
}
Status cutting() {
  Status status;
  status.state = State::cut;
  return status;
}
Diagnostics all_well(std::int64_t now_ns) {
  Diagnostics diagnostics{"cell", "cell.toml"};
  diagnostics.hear(cutting(), now_ns);
  diagnostics.hear(healthy(), now_ns);
  diagnostics.hear(in_time(), now_ns);
  return diagnostics;
}
int level(const DiagnosticsSample& sample, Part part) { return sample.status().at(part).level(); }
std::string message(const DiagnosticsSample& sample, Part part) { return sample.status().at(part).message(); }
std::string value(const DiagnosticsSample& sample, Part part, const std::string& key) {
  for (const auto& pair : sample.status().at(part).values())
    if (pair.key() == key) return pair.value();
  return "no such key";
}

TEST(Diagnostics, AllIsOkWhereNothingIsWrong) {
  Diagnostics diagnostics = all_well(kSecond);
  const DiagnosticsSample sample = diagnostics.sample(kSecond, kWhen);
  ASSERT_EQ(sample.status().size(), 4U);
  for (const Part part : {monitor, sensors, bus, loop}) {
    EXPECT_EQ(level(sample, part), 0) << message(sample, part);
    EXPECT_EQ(sample.status().at(part).hardware_id(), "cell.toml");
  }
  EXPECT_EQ(sample.status()[sensors].name(), "cell: sensors");
  EXPECT_EQ(sample.header().stamp().sec(), kWhen / kSecond);
  EXPECT_EQ(message(sample, monitor), "cut");
  EXPECT_EQ(value(sample, sensors, "accelerometer 0 rate (Hz)"), "25599");
  EXPECT_EQ(value(sample, loop, "tick p99 (us)"), "40");
}

TEST(Diagnostics, EverythingIsStaleBeforeAnythingIsHeardAndAfterSilence) {
  Diagnostics none{"cell", "cell.toml"};
  const DiagnosticsSample before = none.sample(kSecond, kWhen);
  for (const auto& item : before.status()) {
    EXPECT_EQ(item.level(), 3);
    EXPECT_THAT(item.message(), testing::HasSubstr("stillcutd"));
  }
  Diagnostics diagnostics = all_well(kSecond);
  for (const bool stale : {false, true}) {
    const DiagnosticsSample sample = diagnostics.sample(kSecond + kStaleAfter_ns + (stale ? 1 : 0), kWhen);
    for (const Part part : {monitor, sensors, bus, loop}) EXPECT_EQ(level(sample, part), stale ? 3 : 0);
  }
  diagnostics.hear(cutting(), 10 * kSecond);
  EXPECT_EQ(level(diagnostics.sample(10 * kSecond, kWhen), monitor), 0);
}

TEST(Diagnostics, StatesOfTheMonitorHaveTheirLevels) {
  for (int state = 0; state <= static_cast<int>(State::fault); ++state) {
    Diagnostics diagnostics = all_well(0);
    Status status = cutting();
    status.state = static_cast<State>(state);
    diagnostics.hear(status, 0);
    const DiagnosticsSample sample = diagnostics.sample(0, kWhen);
    const bool warns = status.state == State::chatter || status.state == State::cannot_tell;
    EXPECT_EQ(level(sample, monitor), status.state == State::fault ? 2 : warns ? 1 : 0) << message(sample, monitor);
    EXPECT_EQ(message(sample, monitor), describe(status.state));
  }
}

TEST(Diagnostics, ADoubtWarnsAndASilentSensorIsAnError) {
  for (int bit = 0; bit < kDoubtCount; ++bit) {
    const auto doubt = static_cast<Doubt>(1U << static_cast<unsigned>(bit));
    Diagnostics diagnostics = all_well(0);
    HealthReport health = healthy();
    health.doubts = doubt;
    diagnostics.hear(health, 0);
    const DiagnosticsSample sample = diagnostics.sample(0, kWhen);
    EXPECT_EQ(level(sample, sensors), doubt == kSensorSilent ? 2 : 1);
    EXPECT_EQ(message(sample, sensors), describe(doubt));
  }
}

TEST(Diagnostics, ACountThatRoseWarnsOnceAndTellsByHowMuch) {
  Diagnostics diagnostics = all_well(0);
  HealthReport health = healthy();
  health.kernel_dropped = 100;  // before the first sample: nobody knows when
  diagnostics.hear(health, 0);
  EXPECT_EQ(level(diagnostics.sample(0, kWhen), bus), 1) << "it rose since the first report";
  EXPECT_EQ(level(diagnostics.sample(0, kWhen), bus), 0);
  health.kernel_dropped = 103;
  health.sensors[0].lost = 2;
  diagnostics.hear(health, 0);
  health.kernel_dropped = 107;
  diagnostics.hear(health, 0);
  const DiagnosticsSample sample = diagnostics.sample(0, kWhen);
  EXPECT_EQ(level(sample, bus), 1);
  EXPECT_EQ(message(sample, bus), "dropped by the kernel rose by 7");
  EXPECT_EQ(value(sample, bus, "dropped by the kernel"), "107");
  EXPECT_EQ(message(sample, sensors), "accelerometer 0 lost frames rose by 2");
  EXPECT_EQ(level(diagnostics.sample(0, kWhen), bus), 0);
}

TEST(Diagnostics, ADaemonThatBeganAnewDoesNotWarn) {
  Diagnostics diagnostics = all_well(0);
  HealthReport health = healthy();
  health.frames_lost = 50;
  diagnostics.hear(health, 0);
  (void)diagnostics.sample(0, kWhen);
  diagnostics.hear(healthy(), 0);  // counts from 0 again, with sensors that may be others
  health = healthy();
  health.sensors.resize(2);
  diagnostics.hear(health, 0);
  const DiagnosticsSample sample = diagnostics.sample(0, kWhen);
  EXPECT_EQ(level(sample, bus), 0);
  EXPECT_EQ(level(sample, sensors), 0);
}

TEST(Diagnostics, ABusThatIsLostAndALoopOutOfTimeAreErrors) {
  const std::array levels{0, 2, 2, 0, 0, 0};
  const std::array words{"up", "down", "gone", "ended", "unknown", "unknown"};
  for (std::size_t i = 0; i < levels.size(); ++i) {
    Diagnostics diagnostics = all_well(0);
    HealthReport health = healthy();
    health.bus_state = i == 5 ? -1 : static_cast<int>(i);  // a message may hold any number
    diagnostics.hear(health, 0);
    const DiagnosticsSample sample = diagnostics.sample(0, kWhen);
    EXPECT_EQ(level(sample, bus), levels.at(i)) << health.bus_state;
    EXPECT_EQ(value(sample, bus, "state"), words.at(i));
  }
  Diagnostics diagnostics = all_well(0);
  LatencyReport late = in_time();
  late.in_time = false;
  late.overruns = 5;
  diagnostics.hear(late, 0);
  EXPECT_EQ(level(diagnostics.sample(0, kWhen), loop), 2);
  HealthReport health = healthy();
  health.record_dropped = 4;
  diagnostics.hear(health, 0);
  diagnostics.hear(in_time(), 0);
  EXPECT_EQ(message(diagnostics.sample(0, kWhen), loop), "records dropped rose by 4");
}

}  // namespace
}  // namespace stillcut
