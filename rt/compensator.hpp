// Turns heard chatter into corrections for the controller: choose a speed, go there on a jerk-limited ramp, keep the
// feed per tooth, give it time to act, look again, release. Like the monitor it is a function of its inputs: no clock,
// no thread.
//
// Modes: off computes nothing; shadow computes and publishes everything as shown-only; active asks to be followed, and
// does so only while the controller is alive and has acknowledged. Every message carries its expiry, and every failure
// ends in release to nominal. docs/compensation.md.
#pragma once

#include <array>
#include <cstdint>

#include "dsp/monitor.hpp"
#include "models/lobe_diagram.hpp"
#include "models/machining.hpp"
#include "rt/output_queue.hpp"
#include "rt/signals.hpp"
#include "rt/speed_choice.hpp"
#include "rt/trajectory.hpp"

namespace stillcut {

struct CompensatorSettings {
  RuntimeMode mode = RuntimeMode::shadow;
  int teeth = 0;
  SpindleLimits spindle;
  double spindle_time_constant_s = 0.3;  // of the spindle behind the controller: how long a correction needs to act
};

struct CompensatorInputs {
  std::int64_t now_ns = 0;
  const MonitorView* monitor = nullptr;
  const LobeDiagram* lobes = nullptr;  // nullptr: none to be trusted
  double axial_depth = 0.0;            // m; NaN unknown
  double feed_direction = 0.0;         // rad, as programmed
  double nominal_speed = 0.0;          // rad/s, as programmed; 0: take the measured speed
  bool controller_alive = false;       // robot_state arrives
};

class Compensator {
 public:
  explicit Compensator(const CompensatorSettings& settings) noexcept : settings_{settings} {}

  // One step in data time; what is to be published goes to `out`.
  void step(const CompensatorInputs& in, OutputQueue& out) noexcept;
  void acknowledge(const CorrectionAck& ack) noexcept;

  [[nodiscard]] bool correcting() const noexcept { return correcting_; }

 private:
  static constexpr std::size_t kMaxTried = 4;

  void consider(const CompensatorInputs& in, OutputQueue& out) noexcept;
  void start(const CompensatorInputs& in, const SpeedChoice& choice, OutputQueue& out) noexcept;
  void say_none(const CompensatorInputs& in, const SpeedChoice& choice, OutputQueue& out) noexcept;
  void publish(const CompensatorInputs& in, OutputQueue& out) noexcept;
  void release(const CompensatorInputs& in, const char* reason, OutputQueue& out) noexcept;
  [[nodiscard]] const char* reason_to_hold_back(const CompensatorInputs& in) noexcept;
  [[nodiscard]] MotionState setpoint(std::int64_t now_ns) const noexcept;

  CompensatorSettings settings_;
  bool correcting_ = false;
  bool held_back_ = false;  // a condition failed; released until it holds again
  bool said_none_ = false;
  bool refused_ = false;                            // the controller refused or did not answer: no more in this episode
  std::int64_t sequence_ = 0, first_sequence_ = 0;  // of the last message, of the first of this correction
  std::int64_t chatter_since_ns_ = 0, started_ns_ = 0, act_until_ns_ = 0, next_publish_ns_ = 0;
  std::int64_t answered_ns_ = 0;  // last acknowledgement, or the first message of this correction
  SpeedChoice choice_;
  double base_speed_ = 0.0;  // rad/s at which the feed was programmed
  double chatter_frequency_hz_ = 0.0;
  VelocityTrajectory ramp_;
  std::array<double, kMaxTried> tried_{};
  std::size_t tried_count_ = 0;
};

}  // namespace stillcut
