// The adapter's link to the monitor on one in-process connection (memq://).
#include "adapters/lcm_link.hpp"

#include <gtest/gtest.h>

#include <mutex>

#include "drivers/lcm/messages.hpp"
#include "tests/adapters/correction_messages.hpp"

// For the thread sanitizer: what LCM and GLib do among themselves, as in tests/drivers/lcm/publish_subscribe_test.cpp.
extern "C" const char* __tsan_default_suppressions() {
  return "called_from_lib:liblcm.so\ncalled_from_lib:libglib-2.0.so\n";
}

namespace stillcut {
namespace {

using namespace std::chrono_literals;

// What the monitor hears, on the thread that handles the connection.
struct Monitor {
  static std::span<const std::uint8_t> bytes_of(const lcm_recv_buf_t* buffer) {
    return {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size};
  }
  static void hear_state(const lcm_recv_buf_t* buffer, const char*, void* monitor) {
    auto& self = *static_cast<Monitor*>(monitor);
    const std::lock_guard lock(self.mutex);
    self.states.push_back(decode_robot_state(bytes_of(buffer), 0).value);
  }
  static void hear_ack(const lcm_recv_buf_t* buffer, const char*, void* monitor) {
    auto& self = *static_cast<Monitor*>(monitor);
    const std::lock_guard lock(self.mutex);
    self.acks.push_back(decode_correction_ack(bytes_of(buffer), 0).value);
  }
  std::size_t count() {
    const std::lock_guard lock(mutex);
    return states.size() + acks.size();
  }

  std::mutex mutex;
  std::vector<RobotState> states;
  std::vector<CorrectionAck> acks;
};

TEST(LcmLink, BringsCorrectionsInAndTakesAnswersAndStatesOut) {
  const LcmConnection connection = open_lcm("memq://");
  Monitor monitor;
  lcm_subscribe(connection.get(), kRobotStateChannel, Monitor::hear_state, &monitor);
  lcm_subscribe(connection.get(), kRobotAckChannel, Monitor::hear_ack, &monitor);
  LcmLink link{connection};  // its thread handles the connection: two must not
  Publisher publisher{connection};
  Correction correction = speed_correction(7380.0, 0.82);
  for (correction.sequence = 1; correction.sequence <= 50; ++correction.sequence) publisher.publish(Output{correction});
  for (std::int64_t expected = 1; expected <= 50;) {
    HeardCorrection heard;
    if (!link.next(heard)) {
      std::this_thread::sleep_for(1ms);
      continue;
    }
    EXPECT_EQ(heard.correction.sequence, expected++);
    EXPECT_EQ(heard.correction.spindle_speed_rpm, 7380.0);
    EXPECT_GT(heard.received_ns, 0);
    link.say(Answer{{0, heard.correction.sequence, true, 7400.0, 0.8}, short_text("held")});
    RobotState state;
    state.block = static_cast<std::int32_t>(heard.correction.sequence);
    link.say(state);
  }
  for (int i = 0; i < 2000 && monitor.count() < 100; ++i) std::this_thread::sleep_for(10ms);
  ASSERT_EQ(monitor.count(), 100U);
  const std::lock_guard lock(monitor.mutex);
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(monitor.states[i].block, static_cast<std::int32_t>(i + 1));
    EXPECT_EQ(monitor.acks[i].sequence, static_cast<std::int64_t>(i + 1));
    EXPECT_EQ(monitor.acks[i].spindle_speed_rpm, 7400.0);
  }
}

}  // namespace
}  // namespace stillcut
