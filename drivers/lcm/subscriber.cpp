#include "drivers/lcm/subscriber.hpp"

#include <chrono>

namespace stillcut {
namespace {

constexpr int kWaitMs = 50;            // how long a wait for messages may delay the thread's end
constexpr int kQueuedMessages = 1024;  // a channel's; LCM's own 30 lose messages in a burst

std::span<const std::uint8_t> bytes_of(const lcm_recv_buf_t& buffer) {
  return {static_cast<const std::uint8_t*>(buffer.data), buffer.data_size};
}

}  // namespace

Subscriber::Subscriber(LcmConnection connection, Clock clock, RobotHandlers handlers)
    : connection_{std::move(connection)}, clock_{std::move(clock)}, handlers_{std::move(handlers)} {
  subscriptions_ = {lcm_subscribe(connection_.get(), kRobotStateChannel, &Subscriber::receive_state, this),
                    lcm_subscribe(connection_.get(), kRobotAckChannel, &Subscriber::receive_ack, this),
                    lcm_subscribe(connection_.get(), kRobotPathChannel, &Subscriber::receive_path, this)};
  for (lcm_subscription_t* subscription : subscriptions_) {
    lcm_subscription_set_queue_capacity(subscription, kQueuedMessages);
  }
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

Subscriber::~Subscriber() {
  thread_.request_stop();
  thread_.join();
  for (lcm_subscription_t* subscription : subscriptions_) lcm_unsubscribe(connection_.get(), subscription);
}

void Subscriber::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    if (lcm_handle_timeout(connection_.get(), kWaitMs) >= 0) continue;
    link_errors_.fetch_add(1, std::memory_order_relaxed);
    std::this_thread::sleep_for(std::chrono::milliseconds(kWaitMs));  // a broken link must not take the processor
  }
}

void Subscriber::receive_state(const lcm_recv_buf_t* buffer, const char* channel, void* subscriber) noexcept {
  auto& self = *static_cast<Subscriber*>(subscriber);
  self.hand_over(channel, decode_robot_state(bytes_of(*buffer), self.stamp()), self.handlers_.on_state);
}

void Subscriber::receive_ack(const lcm_recv_buf_t* buffer, const char* channel, void* subscriber) noexcept {
  auto& self = *static_cast<Subscriber*>(subscriber);
  self.hand_over(channel, decode_correction_ack(bytes_of(*buffer), self.stamp()), self.handlers_.on_ack);
}

void Subscriber::receive_path(const lcm_recv_buf_t* buffer, const char* channel, void* subscriber) noexcept {
  auto& self = *static_cast<Subscriber*>(subscriber);
  self.hand_over(channel, decode_robot_path(bytes_of(*buffer), self.stamp()), self.handlers_.on_path);
}

template <class T>
void Subscriber::hand_over(const char* channel, const Received<T>& message,
                           const std::function<void(const T&)>& handler) {
  if (message.ok()) {
    received_.fetch_add(1, std::memory_order_relaxed);
    if (handler) handler(message.value);
  } else {
    bad_.fetch_add(1, std::memory_order_relaxed);
    if (handlers_.on_bad) handlers_.on_bad(channel, message.why_not);
  }
}

std::int64_t Subscriber::stamp() const {
  const std::int64_t now = clock_();
  return now - now % 1000;
}

}  // namespace stillcut
