// The adapter's link to the monitor on one in-process connection (memq://).
#include "adapters/lcm_link.hpp"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>

#include "drivers/lcm/subscriber.hpp"
#include "tests/adapters/correction_messages.hpp"

// For the thread sanitizer: what LCM and GLib do among themselves, as in tests/drivers/lcm/publish_subscribe_test.cpp.
extern "C" const char* __tsan_default_suppressions() {
  return "called_from_lib:liblcm.so\ncalled_from_lib:libglib-2.0.so\n";
}

namespace stillcut {
namespace {

using namespace std::chrono_literals;

TEST(LcmLink, BringsCorrectionsInAndTakesAnswersAndStatesOut) {
  const LcmConnection connection = open_lcm("memq://");
  std::mutex mutex;
  std::condition_variable came;
  std::vector<RobotState> states;
  std::vector<CorrectionAck> acks;
  const auto keep = [&](auto& list, const auto& message) {
    const std::lock_guard lock(mutex);
    list.push_back(message);
    came.notify_all();
  };
  LcmLink link{connection};  // its thread handles the connection for the subscriber below as well
  const Subscriber monitor{connection, [] { return 0; },
                           RobotHandlers{.on_state = [&](const RobotState& state) { keep(states, state); },
                                         .on_ack = [&](const CorrectionAck& ack) { keep(acks, ack); },
                                         .on_bad = {}}};
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
  std::unique_lock lock(mutex);
  ASSERT_TRUE(came.wait_for(lock, 20s, [&] { return states.size() == 50 && acks.size() == 50; }));
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(states[i].block, static_cast<std::int32_t>(i + 1));
    EXPECT_EQ(acks[i].sequence, static_cast<std::int64_t>(i + 1));
    EXPECT_EQ(acks[i].spindle_speed_rpm, 7400.0);
  }
}

}  // namespace
}  // namespace stillcut
