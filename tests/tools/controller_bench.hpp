// A simulated controller that is moved on in small steps and keeps what it says, and corrections to ask of it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/virtual_controller.hpp"

namespace stillcut {

inline constexpr double kControllerStep = 1e-4;  // s
inline constexpr double kProgrammedRpm = 8000.0;

inline SpindleLimits controller_limits() {
  return {rpm_to_rad_s(6000), rpm_to_rad_s(14000), rpm_to_rad_s(4000), rpm_to_rad_s(40000)};
}

inline Correction ask_for(double rpm, std::int64_t sequence, RuntimeMode mode = RuntimeMode::active,
                          CorrectionKind kind = CorrectionKind::spindle_speed) {
  Correction c;
  c.sequence = sequence;
  c.valid_for_ms = 500;
  c.mode = mode;
  c.kind = kind;
  c.spindle_speed_rpm = c.spindle_speed_target_rpm = rpm;
  c.feed_override = rpm / kProgrammedRpm;
  return c;
}

// A controller that is moved on in small steps; keeps what it says.
struct ControllerBench {
  explicit ControllerBench(const ControllerScript& script = {})
      : controller{script, controller_limits(), rpm_to_rad_s(kProgrammedRpm), 0} {
    program.spindle_speed_rpm = kProgrammedRpm;
    program.feed_rate = 0.02;
  }
  void run_until(double end, const std::function<void(double)>& each = {}) {
    for (; time < end; time += kControllerStep) {
      for (const ControllerMessage& said : controller.advance(time, program)) {
        if (const auto* ack = std::get_if<CorrectionAck>(&said.message)) {
          acks.push_back(*ack);
          reasons.emplace_back(said.reason);
        } else {
          states.push_back(std::get<RobotState>(said.message));
        }
      }
      if (each) each(time);
    }
  }
  void keep_asking(double rpm, double end) {  // a message every 0.1 s, as the monitor sends while it holds
    for (std::int64_t n = 1; time < end; ++n) {
      controller.receive(ask_for(rpm, n), time);
      run_until(std::min(end, time + 0.1));
    }
  }
  [[nodiscard]] double rpm() const { return rad_s_to_rpm(controller.spindle_speed()); }

  VirtualController controller;
  RobotState program;
  std::vector<CorrectionAck> acks;
  std::vector<std::string> reasons;
  std::vector<RobotState> states;
  double time = 0.0;
};

inline Correction with_validity(Correction c, int ms) {
  c.valid_for_ms = ms;
  return c;
}
inline Correction with_override(Correction c, double feed) {
  c.feed_override = feed;
  return c;
}
inline Correction of_kind(CorrectionKind kind, std::int64_t sequence) {  // at the programmed speed and feed
  Correction c = ask_for(0, sequence, RuntimeMode::active, kind);
  c.feed_override = 1.0;
  return c;
}
inline Correction vary(double rpm, std::int64_t sequence, double ratio, double hz) {
  Correction c = ask_for(rpm, sequence, RuntimeMode::active, CorrectionKind::speed_variation);
  c.feed_override = 1.0;
  c.speed_variation_ratio = ratio;
  c.speed_variation_hz = hz;
  return c;
}
inline Correction turn_to(double direction, std::int64_t sequence) {
  Correction c = of_kind(CorrectionKind::feed_direction, sequence);
  c.feed_direction = direction;
  return c;
}

}  // namespace stillcut
