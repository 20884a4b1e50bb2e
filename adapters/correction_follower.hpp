// What becomes of Stillcut's corrections at a controller: which are followed, which are refused and why, and what to
// ask of spindle and feed at each cycle of the controller.
//
// A feed direction or a feed override carries the spindle speed with which it was chosen, 0 or no number for the
// programmed one: a speed that is in force stays.
//
// A correction is followed until valid_for_ms after its receipt, then the setpoint returns to the program by itself.
// Setpoints move at bounded rates: the feed falls fast and rises slowly, the spindle follows as fast as the cell says
// and comes back at a fifth of that, and the feed per tooth never exceeds both the programmed one and the one asked
// for. A stop request stays until the controller is started again. A function of its inputs: times come with the calls.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "rt/signals.hpp"

namespace stillcut {

struct FollowerSettings {
  // By correction kind: why this controller cannot do it; nullptr: it can.
  std::array<const char*, 6> refusals{};
  double min_speed_rpm = 0.0, max_speed_rpm = 0.0;
  double speed_rate_rpm_per_s = 0.0;
  double min_feed_override = 0.3, max_feed_override = 1.0;
  double feed_fall_per_s = 2.0, feed_rise_per_s = 0.4;  // shares of the programmed feed
  double max_variation_ratio = 0.3, max_variation_hz = 10.0;
  double max_turn = 0.175;            // rad, of the feed direction, made by moving the path sideways
  double max_path_offset = 0.0;       // m
  double path_speed_m_per_s = 0.005;  // sideways; back to the program's path at a fifth of it
};

// What the program asks at present, as the controller tells it.
struct ProgramState {
  double spindle_speed_rpm = 0.0;
  double feed_rate_m_per_s = 0.0;  // as it moves now
  double feed_direction = 0.0;     // rad, workpiece XY
};

// What to ask of the controller in this cycle.
struct Setpoint {
  double spindle_speed_rpm = 0.0;
  double spindle_change_rpm = 0.0;  // against the program; 0: as programmed
  double feed_override = 1.0;       // 1: as programmed
  double path_offset = 0.0;         // m, to the left of the feed; 0: on the program's path
  bool stop = false;

  // Back at the program, or stopped: nothing moves any more because of a correction.
  [[nodiscard]] bool settled() const {
    return spindle_change_rpm == 0.0 && path_offset == 0.0 && (feed_override == 1.0 || stop);
  }
};

struct Answer {
  CorrectionAck ack;
  ShortText reason{};  // why it was refused, or what of it is held back; empty: followed as asked
};

struct FollowerCounters {
  std::int64_t accepted = 0, refused = 0;
  std::int64_t shadow = 0;  // shown only, not answered
  std::int64_t old = 0;     // repeated or overtaken, not answered
  std::int64_t lost = 0;    // missing in the sequence
  std::int64_t lapsed = 0;  // ended because no further message came in time
};

class CorrectionFollower {
 public:
  explicit CorrectionFollower(const FollowerSettings& settings) : settings_{settings} {}

  // A correction that came at now_ns, on the clock of cycle(). Nothing: it is not to be answered.
  std::optional<Answer> receive(const Correction& correction, std::int64_t now_ns);

  // The setpoint of the controller's cycle at now_ns.
  Setpoint cycle(std::int64_t now_ns, const ProgramState& program);

  // A person has started the controller again: an earlier stop request is done with.
  void started_again() { stopped_ = false; }

  // While there is a reason (its text must outlive this): nothing is followed, what is in force is dropped, and every
  // message but a release or a stop is refused with it. nullptr: none any more.
  void hold_back(const char* reason) { held_back_ = reason; }

  [[nodiscard]] const FollowerCounters& counters() const { return counters_; }

 private:
  [[nodiscard]] bool is_new(const Correction& correction, std::int64_t now_ns) const;
  double age_s(const Correction& correction, std::int64_t now_ns);
  [[nodiscard]] ShortText reason_to_refuse(const Correction& correction, double age) const;
  [[nodiscard]] ShortText reason_against_speed(const Correction& correction) const;
  [[nodiscard]] ShortText reason_against_feed(const Correction& correction) const;
  [[nodiscard]] ShortText reason_against_turn(const Correction& correction) const;
  [[nodiscard]] double turn_to(double direction) const;  // rad, from the program's path
  [[nodiscard]] double programmed_direction() const;
  void move_spindle(double step);
  void move_feed(double step);
  void move_path(double step);
  [[nodiscard]] bool follows(CorrectionKind kind) const { return correction_ && correction_->kind == kind; }
  [[nodiscard]] bool takes(CorrectionKind kind) const {
    return settings_.refusals.at(static_cast<std::size_t>(kind)) == nullptr;
  }
  [[nodiscard]] bool carries_speed(const Correction& correction) const;
  [[nodiscard]] bool moves_spindle() const { return correction_ && carries_speed(*correction_); }
  [[nodiscard]] ShortText held_back_of(const Correction& correction) const;

  FollowerSettings settings_;
  ProgramState program_;
  std::optional<Correction> correction_;  // in force
  std::int64_t expires_ns_ = 0, cycle_ns_ = 0;
  bool stopped_ = false, cycled_ = false;
  const char* held_back_ = nullptr;

  // Of the stream of messages. The monitor's clock is not ours: an age is how much later than the quickest one it came.
  bool heard_ = false;
  std::int64_t sequence_ = 0, stamp_ns_ = 0, heard_ns_ = 0;
  double quickest_s_ = 0.0;

  // Of the setpoint: the spindle's mean, the variation around it, and what comes out of both.
  bool spindle_moved_ = false;  // false: as programmed, whatever that is
  double mean_rpm_ = 0.0, speed_rpm_ = 0.0, variation_ratio_ = 0.0, variation_hz_ = 0.0, phase_ = 0.0;
  double feed_ = 1.0, path_offset_ = 0.0, aside_m_per_s_ = 0.0;
  double path_direction_ = 0.0;  // rad, of the program's path when a feed direction was first asked for
  FollowerCounters counters_;
};

}  // namespace stillcut
