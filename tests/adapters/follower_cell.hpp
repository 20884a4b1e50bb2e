// A correction follower at a controller of 4 ms that can do everything, for its tests.
#pragma once

#include <optional>
#include <string>

#include "adapters/correction_follower.hpp"
#include "tests/adapters/correction_messages.hpp"

namespace stillcut {

inline constexpr std::int64_t kCycle_ns = 4'000'000;
inline constexpr ProgramState kProgram{9000.0, 0.03, 0.0};

inline FollowerSettings any_controller() {
  FollowerSettings settings;
  settings.min_speed_rpm = 6000.0;
  settings.max_speed_rpm = 12000.0;
  settings.speed_rate_rpm_per_s = 4000.0;
  settings.max_feed_override = 1.2;
  settings.max_path_offset = 1e-3;
  return settings;
}

// A follower at a controller of 4 ms, and the times that go with it.
class FollowerCell {
 public:
  explicit FollowerCell(const FollowerSettings& settings = any_controller()) : follower{settings} { run(1); }

  std::optional<Answer> say(const Correction& correction) { return follower.receive(correction, now_ns); }
  std::string refused(const Correction& correction) {
    const auto answer = say(correction);
    if (!answer) return "not answered";
    return answer->ack.accepted ? "accepted" : answer->reason.data();
  }
  Setpoint run(int cycles, const ProgramState& program = kProgram) {
    for (int i = 0; i < cycles; ++i) setpoint = follower.cycle(now_ns += kCycle_ns, program);
    return setpoint;
  }
  // Says it again before it lapses, as the monitor does.
  Setpoint hold(const Correction& correction, int cycles, const ProgramState& program = kProgram) {
    for (int i = 0; i < cycles; ++i) {
      if (i % 25 == 0) say(next(correction));
      run(1, program);
    }
    return setpoint;
  }
  Correction next(Correction correction) {
    correction.sequence = ++sequence;
    correction.stamp_ns = now_ns + 1'000'000'000'000;  // the monitor's clock is another
    return correction;
  }

  std::int64_t now_ns = 50'000'000'000;
  std::int64_t sequence = 0;
  CorrectionFollower follower;
  Setpoint setpoint;
};

}  // namespace stillcut
