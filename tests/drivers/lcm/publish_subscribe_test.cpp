// Publisher and subscriber on one in-process connection (memq://).
#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>

#include "drivers/files/input_error.hpp"
#include "drivers/lcm/publisher.hpp"
#include "drivers/lcm/subscriber.hpp"
#include "tests/drivers/lcm/random_messages.hpp"

// For the thread sanitizer. LCM hands a message from publisher to subscriber under a mutex of GLib's, which is a futex
// in a library that is not instrumented: the sanitizer takes the publisher's malloc and memcpy for a race with the
// reading of the message. What these two libraries do themselves is left out; all of our own accesses stay checked.
extern "C" const char* __tsan_default_suppressions() {
  return "called_from_lib:liblcm.so\ncalled_from_lib:libglib-2.0.so\n";
}

namespace stillcut {
namespace {

using namespace std::chrono_literals;

// What the subscriber's thread handed over, for the test's thread to wait for.
class Inbox {
 public:
  RobotHandlers handlers() {
    return {.on_state = [this](const RobotState& state) { add([&] { states.push_back(state); }); },
            .on_ack = [this](const CorrectionAck& ack) { add([&] { acks.push_back(ack); }); },
            .on_path = [this](const RobotPath& path) { add([&] { paths.push_back(path); }); },
            .on_bad = [this](std::string_view, const char* why_not) { add([&] { bad.emplace_back(why_not); }); }};
  }
  // False when fewer have come after ten seconds: a broken link, not a slow machine.
  bool wait_for(std::size_t messages) {
    std::unique_lock lock(mutex_);
    return arrived_.wait_for(lock, 10s,
                             [&] { return states.size() + acks.size() + paths.size() + bad.size() >= messages; });
  }

  std::vector<RobotState> states;
  std::vector<CorrectionAck> acks;
  std::vector<RobotPath> paths;
  std::vector<std::string> bad;

 private:
  template <class Action>
  void add(Action action) {
    const std::lock_guard lock(mutex_);
    action();
    arrived_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable arrived_;
};

TEST(PublishSubscribe, CarriesRobotMessagesInOrderAndUnchanged) {
  RandomMessages random(5);
  const LcmConnection connection = open_lcm("memq://");
  Inbox inbox;
  std::int64_t now = 1'000'000'999;
  Subscriber subscriber(
      connection, [&] { return now += 1'000'000; }, inbox.handlers());
  Publisher publisher(connection);
  std::vector<RobotState> states;
  std::vector<CorrectionAck> acks;
  for (int i = 0; i < 100; ++i) {
    states.push_back(random.state());
    acks.push_back(random.ack());
    EXPECT_TRUE(publisher.publish(states.back()));
    EXPECT_TRUE(publisher.publish(acks.back(), "running"));
  }
  ASSERT_TRUE(inbox.wait_for(200));
  EXPECT_EQ(publisher.sent(), 200);
  EXPECT_EQ(publisher.failed(), 0);
  EXPECT_EQ(subscriber.received(), 200);
  EXPECT_EQ(subscriber.bad(), 0);
  ASSERT_EQ(inbox.states.size(), 100U);
  ASSERT_EQ(inbox.acks.size(), 100U);
  std::int64_t last_stamp_ns = 0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    // The stamp is the receiver's, in whole microseconds.
    EXPECT_EQ(inbox.states[i].stamp_ns % 1000, 0);
    EXPECT_GT(inbox.states[i].stamp_ns, last_stamp_ns);
    last_stamp_ns = inbox.states[i].stamp_ns;
    inbox.states[i].stamp_ns = states[i].stamp_ns;
    inbox.acks[i].stamp_ns = acks[i].stamp_ns;
    EXPECT_EQ(encode(inbox.states[i]), encode(states[i]));
    EXPECT_EQ(encode(inbox.acks[i]), encode(acks[i]));
  }
}

TEST(PublishSubscribe, CountsAndReportsWhatCannotBeTrusted) {
  const LcmConnection connection = open_lcm("memq://");
  Inbox inbox;
  Subscriber subscriber(
      connection, [] { return 0; }, inbox.handlers());
  Publisher publisher(connection);
  RobotState bad_state;
  bad_state.feed_rate = std::numeric_limits<double>::quiet_NaN();
  publisher.publish(bad_state);
  const char garbage[] = "not a message";
  lcm_publish(connection.get(), kRobotAckChannel, garbage, sizeof garbage);
  lcm_publish(connection.get(), kRobotStateChannel, garbage, 0);
  publisher.publish(RobotState{});
  ASSERT_TRUE(inbox.wait_for(4));
  EXPECT_EQ(subscriber.bad(), 3);
  EXPECT_EQ(subscriber.received(), 1);
  EXPECT_EQ(inbox.states.size(), 1U);
  EXPECT_EQ(inbox.bad.at(0), "feed_rate_m_per_s is not a number from 0 to 100");
}

TEST(PublishSubscribe, CarriesTheAnnouncedPathAndReportsABadOne) {
  RandomMessages random(8);
  const LcmConnection connection = open_lcm("memq://");
  Inbox inbox;
  Subscriber subscriber(
      connection, [] { return 7'000'500; }, inbox.handlers());
  Publisher publisher(connection);
  RobotPath path = random.path();
  while (path.count < 2) path = random.path();
  EXPECT_TRUE(publisher.publish(path));
  RobotPath bad = path;
  bad.points[1].feed_direction = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(publisher.publish(bad));
  const MessageBytes whole = encode(path);
  lcm_publish(connection.get(), kRobotPathChannel, whole.data(), static_cast<unsigned>(whole.size() - 1));
  ASSERT_TRUE(inbox.wait_for(3));
  ASSERT_EQ(inbox.paths.size(), 1U);
  EXPECT_EQ(inbox.paths[0].stamp_ns, 7'000'000);  // of receipt, in whole microseconds
  inbox.paths[0].stamp_ns = path.stamp_ns;
  EXPECT_EQ(encode(inbox.paths[0]), encode(path));
  EXPECT_EQ(subscriber.received(), 1);
  EXPECT_EQ(subscriber.bad(), 2);
  EXPECT_EQ(inbox.bad.at(0), "feed_direction_rad is no angle");
}

// What the daemon publishes, received with LCM's own means.
using Inbound = std::vector<std::pair<std::string, MessageBytes>>;

void receive(const lcm_recv_buf_t* buffer, const char* channel, void* received) {
  const auto* bytes = static_cast<const std::uint8_t*>(buffer->data);
  static_cast<Inbound*>(received)->emplace_back(channel, MessageBytes(bytes, bytes + buffer->data_size));
}

TEST(PublishSubscribe, SendsEachOutputOnItsChannel) {
  RandomMessages random(6);
  const LcmConnection connection = open_lcm("memq://");
  Inbound received;
  lcm_subscribe(connection.get(), "STILLCUT_.*", receive, &received);
  Publisher publisher(connection);
  const Event event = random.event();
  const Correction correction = random.correction();
  const Status status = random.status();
  EXPECT_TRUE(publisher.publish(Output(event)));
  EXPECT_TRUE(publisher.publish(Output(correction)));
  EXPECT_TRUE(publisher.publish(Output(status)));
  while (received.size() < 3) ASSERT_GT(lcm_handle_timeout(connection.get(), 10000), 0);
  EXPECT_EQ(publisher.sent(), 3);
  EXPECT_EQ(received[0], std::pair(std::string("STILLCUT_EVENT"), encode(event)));
  EXPECT_EQ(received[1], std::pair(std::string("STILLCUT_CORRECTION"), encode(correction)));
  EXPECT_EQ(received[2], std::pair(std::string("STILLCUT_STATUS"), encode(status)));
}

TEST(PublishSubscribe, StopsWithoutMessagesAndLeavesTheConnectionUsable) {
  const LcmConnection connection = open_lcm("memq://");
  for (int i = 0; i < 3; ++i) {
    Inbox inbox;
    const Subscriber subscriber(
        connection, [] { return 0; }, inbox.handlers());
    Publisher publisher(connection);
    EXPECT_TRUE(publisher.publish(RobotState{}));
    EXPECT_TRUE(inbox.wait_for(1));
  }
  Publisher publisher(connection);
  EXPECT_TRUE(publisher.publish(RobotState{}));  // nobody listens any more: no handler of the past is called
}

TEST(PublishSubscribe, NamesTheCommandsThatMendAMissingRoute) {
  std::string message;
  try {
    open_lcm("udpm://no-address:0");
  } catch (const ComponentError& error) {
    message = error.what();
  }
  EXPECT_NE(message.find("LCM cannot be reached at udpm://no-address:0"), std::string::npos) << message;
  EXPECT_NE(message.find("ip route add 224.0.0.0/4 dev lo"), std::string::npos) << message;
}

}  // namespace
}  // namespace stillcut
