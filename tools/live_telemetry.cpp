#include "tools/live_telemetry.hpp"

#include <chrono>
#include <cstdlib>

namespace stillcut {
namespace {

constexpr std::chrono::milliseconds kPollWatched{5};
constexpr std::int64_t kHealthEvery_ns = 1'000'000'000;

}  // namespace

TelemetryThread::TelemetryThread(const Cell& cell, const Decoder& decoder, LoopChannels& channels,
                                 const LcmConnection& lcm, std::function<LiveLosses()> losses)
    : channels_{channels},
      decoder_{decoder},
      publisher_{lcm},
      telemetry_{cell, [this](const TelemetryMessage& message) { publisher_.publish(message); }},
      losses_{std::move(losses)},
      thread_{[this](const std::stop_token& stop) { run(stop); }} {}

void TelemetryThread::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    drain();
    if (std::abs(realtime_ns() - health_told_ns_) >= kHealthEvery_ns) tell_health();  // clocks are set back, too
    std::this_thread::sleep_for(kPollWatched);
  }
}

void TelemetryThread::drain() {
  CanFrame frame;
  while (channels_.watched.pop(frame)) {
    if (!decoder_.decode(frame, decoded_)) continue;
    for (int b = 0; b < decoded_.blocks; ++b) telemetry_.add(decoded_.block[static_cast<std::size_t>(b)]);
  }
  channels_.shown_lobes.update();
  if (!channels_.view.update()) return;
  LoopView view = channels_.view.value();
  if (view.now_ns == 0) view.now_ns = realtime_ns();  // no frame yet: onlookers are to see that the daemon lives
  telemetry_.add(view, &channels_.shown_lobes.value());
}

void TelemetryThread::tell_health() {
  health_told_ns_ = realtime_ns();
  const LiveLosses losses = losses_();
  HealthReport report = telemetry_.health(health_told_ns_);
  report.bus_state = static_cast<int>(losses.bus_state);
  report.kernel_dropped = losses.bus.dropped;
  report.error_frames = losses.bus.error_frames;
  report.bus_off = losses.bus.bus_off;
  report.reopened = losses.bus.reopened;
  report.frames_bad += losses.bus.frames_bad;
  report.outputs_dropped = losses.outputs_dropped;
  report.record_dropped = losses.record_dropped;
  report.telemetry_dropped = losses.telemetry_dropped;
  report.messages_bad = losses.messages_bad;
  report.publish_failed = losses.publish_failed + publisher_.failed();
  publisher_.publish(TelemetryMessage{report});
  publisher_.publish(TelemetryMessage{histogram_report(channels_.times, health_told_ns_)});
}

}  // namespace stillcut
