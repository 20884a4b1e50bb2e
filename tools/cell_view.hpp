// What an onlooker is shown of a cell, put together from what the daemon tells: one large state with its reason, and
// the newest of everything. The page, the terminal and the metrics show the same. One thread; holds no clock.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "drivers/lcm/telemetry_messages.hpp"

namespace stillcut {

enum class Shown : std::uint8_t {
  no_daemon,
  not_cutting,
  stable,
  watch,  // near the alarm limit, or deeper than the lobes allow
  chatter,
  correcting,
  cannot_tell,
  fault
};
const char* shown_name(Shown shown) noexcept;  // "not cutting"

struct ShownState {
  Shown shown = Shown::no_daemon;
  std::string reason;  // one sentence
};

class CellView {
 public:
  static constexpr std::size_t kEventsKept = 200, kCorrectionsKept = 200;

  // received_ns: when it came, on any clock that only rises.
  void take(const TelemetryMessage& message, std::int64_t received_ns);

  // now_ns: on the clock of take().
  [[nodiscard]] ShownState state(std::int64_t now_ns) const;
  // How long ago anything was heard, s; infinite: never.
  [[nodiscard]] double silent_s(std::int64_t now_ns) const;
  // The correction that is asked for just now, followed or, in shadow, shown; nullptr: none.
  [[nodiscard]] const Correction* asked() const;

  // The newest; empty: none yet.
  [[nodiscard]] const std::optional<MonitorReport>& monitor() const { return monitor_; }
  [[nodiscard]] const std::optional<DiagramReport>& diagram() const { return diagram_; }
  [[nodiscard]] const std::optional<HealthReport>& health() const { return health_; }
  [[nodiscard]] const std::optional<LatencyReport>& latency() const { return latency_; }
  [[nodiscard]] const std::optional<HistogramReport>& histogram() const { return histogram_; }
  [[nodiscard]] const std::map<int, SpectrumReport>& spectra() const { return spectra_; }  // by sensor
  [[nodiscard]] const std::deque<Event>& events() const { return events_; }                // oldest first
  [[nodiscard]] const std::deque<Correction>& corrections() const {
    return corrections_;
  }  // those that began something
  [[nodiscard]] std::int64_t events_heard(EventType type) const;

 private:
  void take_one(const Status& status);
  void take_one(const Event& event);
  void take_one(const Correction& correction);
  void take_one(const MonitorReport& report);
  void take_one(const SpectrumReport& report);
  void take_one(const VibrationReport& /*report*/) {}
  void take_one(const DiagramReport& report) { diagram_ = report; }
  void take_one(const HealthReport& report) { health_ = report; }
  void take_one(const LatencyReport& report);
  void take_one(const HistogramReport& report) { histogram_ = report; }
  [[nodiscard]] std::optional<ShownState> nothing_comes(std::int64_t now_ns) const;
  [[nodiscard]] std::string why_fault() const;
  [[nodiscard]] ShownState in_the_cut() const;

  std::optional<std::int64_t> heard_ns_;
  std::optional<std::int64_t> report_heard_ns_;   // a monitor's report: status says less
  std::optional<std::int64_t> monitor_heard_ns_;  // either
  std::optional<std::int64_t> ticked_ns_;         // when the loop was last known to have ticked on
  std::optional<MonitorReport> monitor_;
  std::optional<std::int64_t> near_limit_ns_;  // data time at which the indicator was last near the alarm limit
  std::optional<DiagramReport> diagram_;
  std::optional<HealthReport> health_;
  std::optional<LatencyReport> latency_;
  std::optional<HistogramReport> histogram_;
  std::optional<Correction> correction_;  // the newest message
  std::map<int, SpectrumReport> spectra_;
  std::deque<Event> events_;
  std::deque<Correction> corrections_;
  std::array<std::int64_t, 8> event_counts_{};
};

// "regenerative chatter at 748.0 Hz, near mode 2 (741.2 Hz)"
std::string chatter_sentence(const MonitorReport& monitor);

}  // namespace stillcut
