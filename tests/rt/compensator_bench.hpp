// A compensator at the bench, for tests: stepped in time, its words kept.
#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

#include "rt/compensator.hpp"
#include "tests/rt/monitor_script.hpp"

namespace stillcut {

// A compensator with its inputs, stepped every 2 ms as the monitor's hops would; keeps all that it says.
class Bench {
 public:
  explicit Bench(RuntimeMode mode)
      : Bench{{mode, 2, {.spindle = spindle_6000_to_12000(), .spindle_time_constant_s = 0.05}}} {}
  explicit Bench(const CompensatorSettings& settings) : compensator_{settings} {
    in.axial_depth = 1e-3;
    in.nominal_speed = rpm_to_rad_s(9000);
  }

  void step(MonitorView view) {
    now_ns += 2 * kMillisecond;
    view.stamp_ns = now_ns;
    in.now_ns = now_ns;
    in.monitor = &view;
    in.coming_depth = in.axial_depth;
    compensator_.step(in, queue_);
    for (const Output& output : queue_.items()) {
      if (output.type == Output::Type::correction) corrections.push_back(output.correction);
      if (output.type == Output::Type::event) events.push_back(output.event);
    }
    queue_.clear();
  }
  void run(double seconds, const MonitorView& view) {
    for (const std::int64_t end = now_ns + static_cast<std::int64_t>(seconds * 1e9); now_ns < end;) step(view);
  }
  // The same with a controller that says yes to every message.
  void run_acknowledged(double seconds, const MonitorView& view) {
    for (const std::int64_t end = now_ns + static_cast<std::int64_t>(seconds * 1e9); now_ns < end;) {
      step(view);
      acknowledge(true);
    }
  }
  void acknowledge(bool accepted, std::string_view reason = {}) {
    if (corrections.empty()) return;
    compensator_.acknowledge({now_ns, corrections.back().sequence, accepted, 0.0, 1.0, short_text(reason)});
  }
  [[nodiscard]] Compensator& compensator() { return compensator_; }
  [[nodiscard]] int releases() const {
    return static_cast<int>(std::count_if(corrections.begin(), corrections.end(),
                                          [](const Correction& c) { return c.kind == CorrectionKind::release; }));
  }
  [[nodiscard]] std::vector<double> targets_rpm() const {
    std::vector<double> targets;
    for (const Correction& c : corrections) {
      if (c.kind != CorrectionKind::spindle_speed) continue;
      if (targets.empty() || targets.back() != c.spindle_speed_target_rpm)
        targets.push_back(c.spindle_speed_target_rpm);
    }
    return targets;
  }

  CompensatorInputs in;
  std::int64_t now_ns = 1'700'000'000 * kSecond;
  std::vector<Correction> corrections;
  std::vector<Event> events;

 private:
  Compensator compensator_;
  OutputQueue queue_;
};

// What was asked for, one entry a start: kinds in order.
inline std::vector<CorrectionKind> asked_for(const Bench& bench) {
  std::vector<CorrectionKind> kinds;
  double target = 0.0;
  for (const Correction& c : bench.corrections) {
    if (!kinds.empty() && kinds.back() == c.kind && target == c.spindle_speed_target_rpm) continue;
    kinds.push_back(c.kind);
    target = c.spindle_speed_target_rpm;
  }
  return kinds;
}

// A machine that follows every correction and chatters on whatever is done.
inline void run_following(Bench& bench, double seconds, double frequency_hz = 738.0) {
  double speed_rpm = 9000.0;
  for (int i = 0; i < static_cast<int>(seconds / 0.002); ++i) {
    bench.step(chattering(0, frequency_hz, speed_rpm));
    bench.acknowledge(true);
    if (!bench.corrections.empty()) speed_rpm = bench.corrections.back().spindle_speed_rpm;
  }
}

}  // namespace stillcut
