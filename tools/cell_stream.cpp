#include "tools/cell_stream.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "tools/cell_json.hpp"

namespace stillcut {
namespace {

// Bytes that are not UTF-8 (a controller's own words) must not cost the message.
std::string text_of_json(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::int64_t stamp_of(const TelemetryMessage& message) {
  return std::visit([](const auto& m) { return m.stamp_ns; }, message);
}

}  // namespace

Chunk server_sent_event(const char* name, const std::string& json) {
  return std::make_shared<const std::string>(std::string("event: ") + name + "\ndata: " + json + "\n\n");
}

void CellStream::take(const TelemetryMessage& message, std::int64_t received_ns) {
  view_.take(message, received_ns);
  const std::int64_t stamp_ns = stamp_of(message);
  const auto emit = [&](const char* name, std::string newest_of, const nlohmann::ordered_json& json) {
    emit_({std::move(newest_of), stamp_ns, server_sent_event(name, text_of_json(json))});
  };
  if (const auto* spectrum = std::get_if<SpectrumReport>(&message))
    return emit("spectrum", "spectrum " + std::to_string(spectrum->sensor), spectrum_json(*spectrum, origin_ns_));
  if (const auto* diagram = std::get_if<DiagramReport>(&message))
    return emit("lobes", "lobes", lobes_json(*diagram, origin_ns_));
  if (std::holds_alternative<MonitorReport>(message)) return tell_state(received_ns, stamp_ns);
  if (const auto* health = std::get_if<HealthReport>(&message))
    emit("health", "health", health_json(*health, origin_ns_));
  if (std::holds_alternative<LatencyReport>(message) || std::holds_alternative<HistogramReport>(message)) {
    const auto& histogram = view_.histogram();
    if (view_.latency())
      emit("latency", "latency", latency_json(*view_.latency(), histogram ? &*histogram : nullptr, origin_ns_));
  }
  if (const auto* event = std::get_if<Event>(&message)) emit("event", {}, event_json(*event, origin_ns_));
  if (std::holds_alternative<Correction>(message)) {
    const Correction& newest = view_.corrections().back();
    // A daemon that starts again counts from the beginning.
    const std::pair<std::int64_t, std::int64_t> which{newest.sequence, newest.stamp_ns};
    if (std::exchange(correction_told_, which) != which) emit("correction", {}, correction_json(newest, origin_ns_));
  }
  tell_news(received_ns);
}

// What another message than the monitor's changes is told at once.
void CellStream::tell_news(std::int64_t received_ns) {
  const ShownState state = view_.state(received_ns);
  if (state.shown == shown_ && state.reason == reason_) return;
  tell_state(received_ns, view_.monitor() ? view_.monitor()->stamp_ns : origin_ns_);
}

void CellStream::tell_state(std::int64_t now_ns, std::int64_t time_ns) {
  const ShownState state = view_.state(now_ns);
  shown_ = state.shown;
  reason_ = state.reason;
  emit_({"state", time_ns, server_sent_event("state", text_of_json(state_json(view_, state, time_ns, origin_ns_)))});
}

}  // namespace stillcut
