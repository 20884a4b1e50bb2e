#include "drivers/lcm/telemetry_listener.hpp"

#include <array>
#include <chrono>

namespace stillcut {
namespace {

constexpr int kListenForMs = 50;        // how long a wait for messages may delay the thread's end
constexpr int kQueuedOfAChannel = 256;  // a channel's queue: ten seconds of the most frequent one

using Decode = Received<TelemetryMessage> (*)(std::span<const std::uint8_t>);

template <auto decode>
Received<TelemetryMessage> any(std::span<const std::uint8_t> bytes) {
  auto message = decode(bytes);
  if (!message.ok()) return {{}, message.why_not};
  return {std::move(message.value)};
}

// In the order of TelemetryMessage's kinds.
struct Channel {
  const char* name;
  Decode decode;
};
constexpr std::array<Channel, std::variant_size_v<TelemetryMessage>> kChannels{
    {{kStatusChannel, any<decode_status>},
     {kEventChannel, any<decode_event>},
     {kCorrectionChannel, any<decode_correction>},
     {kMonitorChannel, any<decode_monitor>},
     {kSpectrumChannel, any<decode_spectrum>},
     {kVibrationChannel, any<decode_vibration>},
     {kDiagramChannel, any<decode_diagram>},
     {kHealthChannel, any<decode_health>},
     {kLatencyChannel, any<decode_latency>},
     {kHistogramChannel, any<decode_histogram>}}};

}  // namespace

const char* channel_of(const TelemetryMessage& message) noexcept { return kChannels[message.index()].name; }

Received<TelemetryMessage> decode_telemetry(std::string_view channel, std::span<const std::uint8_t> bytes) {
  for (const Channel& known : kChannels)
    if (channel == known.name) return known.decode(bytes);
  return {{}, "not a channel of Stillcut's"};
}

std::span<const char* const> telemetry_channels() noexcept {
  static constexpr auto kNames = [] {
    std::array<const char*, kChannels.size()> names{};
    for (std::size_t i = 0; i < names.size(); ++i) names[i] = kChannels[i].name;
    return names;
  }();
  return kNames;
}

TelemetryListener::TelemetryListener(LcmConnection connection, Handlers handlers)
    : connection_{std::move(connection)}, handlers_{std::move(handlers)} {
  for (const Channel& channel : kChannels) {
    subscriptions_.push_back(lcm_subscribe(connection_.get(), channel.name, &TelemetryListener::receive, this));
    lcm_subscription_set_queue_capacity(subscriptions_.back(), kQueuedOfAChannel);
  }
  thread_ = std::jthread{[this](const std::stop_token& stop) {
    while (!stop.stop_requested())
      if (lcm_handle_timeout(connection_.get(), kListenForMs) < 0)  // a broken link must not take the processor
        std::this_thread::sleep_for(std::chrono::milliseconds(kListenForMs));
  }};
}

TelemetryListener::~TelemetryListener() {
  thread_ = {};
  for (lcm_subscription_t* subscription : subscriptions_) lcm_unsubscribe(connection_.get(), subscription);
}

void TelemetryListener::receive(const lcm_recv_buf_t* buffer, const char* channel, void* listener) noexcept {
  auto& self = *static_cast<TelemetryListener*>(listener);
  const auto message = decode_telemetry(channel, {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
  if (message.ok() && self.handlers_.on_message) self.handlers_.on_message(message.value);
  if (!message.ok() && self.handlers_.on_bad) self.handlers_.on_bad(channel, message.why_not);
  (message.ok() ? self.received_ : self.bad_).fetch_add(1, std::memory_order_release);
}

}  // namespace stillcut
