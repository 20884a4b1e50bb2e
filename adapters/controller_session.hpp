// One controller as the adapters see it: its reports go in cycle by cycle, corrections in between; out come the
// setpoint of each cycle, the answers, and the robot's state for the monitor. Knows when a session starts anew, when
// reports are missing, old or repeated. A function of its inputs: times come with the calls.
#pragma once

#include <cstdint>
#include <optional>

#include "adapters/controller_report.hpp"
#include "adapters/correction_follower.hpp"
#include "adapters/feed_motion.hpp"

namespace stillcut {

struct SessionSettings {
  FollowerSettings follower;
  double nominal_speed_rpm = 0.0;       // where the controller does not tell what is programmed
  double nominal_feed_direction = 0.0;  // rad, until something moves
  std::int64_t counter_step = 1;        // of the report's counter from cycle to cycle
  std::int64_t cycle_ns = 4'000'000;
};

struct SessionCounters {
  std::int64_t cycles = 0;
  std::int64_t sessions = 0;  // the controller was started (again)
  std::int64_t old = 0;       // repeated or overtaken reports, not answered
  std::int64_t lost = 0;      // reports missing by the counter
};

class ControllerSession {
 public:
  explicit ControllerSession(const SessionSettings& settings);

  std::optional<Answer> receive(const Correction& correction, std::int64_t now_ns);
  // Nothing: the report is old and must not be answered.
  std::optional<Setpoint> cycle(const ControllerReport& report, std::int64_t now_ns);
  // The state to publish after a cycle; at most every 10 ms one.
  std::optional<RobotState> state_due(std::int64_t now_ns);
  void started_again() { follower_.started_again(); }
  // As the follower's; a controller that is silent, or has not spoken yet, is such a reason by itself.
  void hold_back(const char* reason) { held_back_ = reason; }

  [[nodiscard]] const SessionCounters& counters() const { return counters_; }
  [[nodiscard]] const FollowerCounters& follower_counters() const { return follower_.counters(); }

 private:
  SessionSettings settings_;
  CorrectionFollower follower_;
  const char* held_back_ = nullptr;
  FeedMotion motion_;
  RobotState state_;
  std::int64_t last_counter_ = 0, last_cycle_ns_ = 0, next_state_ns_ = 0;
  SessionCounters counters_;
};

}  // namespace stillcut
