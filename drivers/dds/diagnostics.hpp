// What the monitor tells of itself, in the words of ROS 2's diagnostics: four names, each with a level, a message for
// people and the figures beneath it.
#pragma once

#include <optional>
#include <string>

#include "drivers/dds/samples.hpp"

namespace stillcut {

inline constexpr std::int64_t kStaleAfter_ns = 3'000'000'000;  // of what comes once a second and oftener

class Diagnostics {
 public:
  // `name` heads the four names ("stillcut: sensors"); `hardware_id` says which machine.
  Diagnostics(std::string name, std::string hardware_id)
      : name_{std::move(name)}, hardware_id_{std::move(hardware_id)} {}

  // Times of any one clock that never goes back.
  void hear(const TelemetryMessage& message, std::int64_t heard_ns);

  // Levels OK 0, WARN 1, ERROR 2, STALE 3. A count that rose since the last call warns.
  DiagnosticsSample sample(std::int64_t now_ns, std::int64_t stamp_ns);

 private:
  template <class T>
  struct Heard {
    std::optional<T> now;  // newest
    T reported{};          // as of the last sample
    std::int64_t heard_ns = 0;

    void hear(const T& value, std::int64_t ns) {
      if (!now) reported = value;
      now = value;
      heard_ns = ns;
    }
    [[nodiscard]] bool stale(std::int64_t now_ns) const { return !now || now_ns - heard_ns > kStaleAfter_ns; }
  };

  std::string name_, hardware_id_;
  Heard<Status> status_;
  Heard<HealthReport> health_;
  Heard<LatencyReport> latency_;
  std::optional<MonitorReport> monitor_;
};

// In words: "chatter", "cannot tell".
const char* describe(State state) noexcept;

}  // namespace stillcut
