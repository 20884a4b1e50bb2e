// The robot's controller and spindle as a simulated machine has them: the controller hears corrections in its cycle,
// acts on them after its lag, answers each, returns to the program when they expire; the spindle follows its setpoint
// as a first-order lag with limited acceleration, the feed its override and direction at limited rates. A stop request
// holds the program until somebody starts it again, which nobody does here. A function of its inputs: time comes with
// the calls.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "drivers/files/scenario.hpp"
#include "drivers/lcm/lcm_log.hpp"
#include "rt/signals.hpp"

namespace stillcut {

struct ControllerMessage {
  RobotMessage message;
  std::string_view reason;  // of an acknowledgement
};

class VirtualController {
 public:
  static constexpr double kFullFeedIn = 0.2;  // s, from a standing feed to the programmed one and back

  // The spindle already turns with `speed` (rad/s); times are s from `origin_ns` on.
  VirtualController(ControllerScript script, const SpindleLimits& limits, double speed, std::int64_t origin_ns);

  // A correction arrives.
  void receive(const Correction& correction, double time);

  // Moves on to `time`, where the program commands `program` (its stamp is filled in here; spindle_speed_rpm is the
  // programmed speed). Returns what the controller says meanwhile, valid until the next call: robot states tell the
  // programmed speed, and the feed as it is.
  std::span<const ControllerMessage> advance(double time, const RobotState& program);

  [[nodiscard]] double spindle_speed() const { return speed_; }  // actual, rad/s
  [[nodiscard]] double feed_override() const { return feed_; }   // actual
  [[nodiscard]] double feed_turn() const { return turn_; }       // rad, how far the feed is turned from the program's
  // A correction, or its end, turns or changes the feed by much just now.
  [[nodiscard]] bool feed_moves() const { return feed_moves_; }
  [[nodiscard]] bool stopped() const { return stopped_; }  // by a stop request; stays
  [[nodiscard]] bool corrected() const { return correction_.has_value(); }
  [[nodiscard]] int refused() const { return refused_; }

 private:
  struct Heard {
    Correction correction;
    double acts_from = 0.0, expires = 0.0;
  };
  void cycle(double time, const RobotState& program);
  void act_on(const Heard& heard, double time, const RobotState& program);
  void take(const Heard& heard, double time);
  void move_drives(double time, const RobotState& program);
  [[nodiscard]] bool has(ControllerFaultKind kind, double time) const;
  [[nodiscard]] std::string_view reason_to_refuse(const Heard& heard, double time) const;
  [[nodiscard]] double mean_speed(const RobotState& program) const;
  [[nodiscard]] double feed_asked() const;
  [[nodiscard]] std::int64_t stamp(double time) const;

  ControllerScript script_;
  SpindleLimits limits_;
  std::int64_t origin_ns_;
  std::int64_t cycles_ = 0, last_sequence_ = -1, last_stamp_ns_ = 0;
  double time_ = 0.0, speed_, feed_ = 1.0, turn_ = 0.0;
  std::vector<Heard> inbox_;
  std::optional<Correction> correction_;  // in force
  double expires_ = 0.0;
  double variation_began_ = 0.0;  // s
  bool stopped_ = false, feed_moves_ = false;
  int refused_ = 0;
  std::vector<ControllerMessage> said_;
};

}  // namespace stillcut
