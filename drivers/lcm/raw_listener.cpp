#include "drivers/lcm/raw_listener.hpp"

#include <regex>
#include <stdexcept>
#include <utility>

namespace stillcut {
namespace {

constexpr int kQueuedRaw = 1024;  // a channel's queue

}  // namespace

// LCM leaves the process where it cannot read a pattern, so it gets only sound ones.
std::string why_no_pattern(const std::string& pattern) {
  try {
    const std::regex read{pattern};
    return {};
  } catch (const std::regex_error&) {
    return "'" + pattern + "' is neither a channel's name nor a pattern such as 'STILLCUT_.*'";
  }
}

RawListener::RawListener(LcmConnection connection, std::span<const std::string> patterns,
                         std::function<void(const RawMessage&)> on_message)
    : connection_{std::move(connection)}, on_message_{std::move(on_message)} {
  // One subscription for all: a channel that two patterns name is heard once.
  std::string all = "(";
  for (const std::string& pattern : patterns) {
    if (const std::string why_not = why_no_pattern(pattern); !why_not.empty()) throw std::invalid_argument(why_not);
    all += (all.size() == 1 ? "(" : "|(") + pattern + ")";
  }
  all += ")";
  subscription_ = lcm_subscribe(connection_.get(), all.c_str(), &RawListener::receive, this);
  if (subscription_ == nullptr) throw std::invalid_argument("LCM does not take the pattern " + all);
  lcm_subscription_set_queue_capacity(subscription_, kQueuedRaw);
}

RawListener::~RawListener() { lcm_unsubscribe(connection_.get(), subscription_); }

bool RawListener::wait(int milliseconds) { return lcm_handle_timeout(connection_.get(), milliseconds) >= 0; }

void RawListener::receive(const lcm_recv_buf_t* buffer, const char* channel, void* listener) noexcept {
  const auto& self = *static_cast<RawListener*>(listener);
  self.on_message_({channel, {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size}, buffer->recv_utime});
}

}  // namespace stillcut
