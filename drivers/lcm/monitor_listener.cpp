#include "drivers/lcm/monitor_listener.hpp"

#include <chrono>

#include "drivers/lcm/messages.hpp"

namespace stillcut {
namespace {

constexpr int kListenMs = 50;         // how long a wait for messages may delay the thread's end
constexpr int kHeardMessages = 1024;  // a channel's queue

std::span<const std::uint8_t> data_of(const lcm_recv_buf_t& buffer) {
  return {static_cast<const std::uint8_t*>(buffer.data), buffer.data_size};
}

}  // namespace

MonitorListener::MonitorListener(LcmConnection connection, Handlers handlers, Thread thread)
    : connection_{std::move(connection)}, handlers_{std::move(handlers)} {
  subscriptions_ = {lcm_subscribe(connection_.get(), kCorrectionChannel, &MonitorListener::receive_correction, this),
                    lcm_subscribe(connection_.get(), kEventChannel, &MonitorListener::receive_event, this)};
  for (lcm_subscription_t* subscription : subscriptions_)
    lcm_subscription_set_queue_capacity(subscription, kHeardMessages);
  if (thread == Thread::none) return;
  thread_.emplace([this](const std::stop_token& stop) {
    while (!stop.stop_requested())
      if (lcm_handle_timeout(connection_.get(), kListenMs) < 0)
        std::this_thread::sleep_for(std::chrono::milliseconds(kListenMs));  // a broken link must not take the processor
  });
}

MonitorListener::~MonitorListener() {
  thread_.reset();
  for (lcm_subscription_t* subscription : subscriptions_) lcm_unsubscribe(connection_.get(), subscription);
}

void MonitorListener::receive_correction(const lcm_recv_buf_t* buffer, const char* /*channel*/,
                                         void* listener) noexcept {
  const auto& self = *static_cast<MonitorListener*>(listener);
  const Received<Correction> message = decode_correction(data_of(*buffer));
  if (message.ok() && self.handlers_.on_correction) self.handlers_.on_correction(message.value);
}

void MonitorListener::receive_event(const lcm_recv_buf_t* buffer, const char* /*channel*/, void* listener) noexcept {
  const auto& self = *static_cast<MonitorListener*>(listener);
  const Received<Event> message = decode_event(data_of(*buffer));
  if (message.ok() && self.handlers_.on_event) self.handlers_.on_event(message.value);
}

}  // namespace stillcut
