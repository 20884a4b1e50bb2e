// Is the tool in the cut? From the level of vibration against the lowest level heard at a turning spindle: idle, air,
// entry, cut, exit. Entry holds for some revolutions, because the first teeth ring every mode.
#pragma once

#include <cstdint>

#include "dsp/signals.hpp"

namespace stillcut {

struct CutGateSettings {
  double entry_ratio = 1.6;  // level over air level at which the tool is in the cut
  double exit_ratio = 1.25;  // and at which it has left it
  double idle_speed = 6.3;   // rad/s (60 rpm): slower is standing still
  double entry_revolutions = 5.0;
  double air_fall_s = 0.3;   // how soon the air level follows a quieter spindle
  double air_rise_s = 60.0;  // and a louder one
};

class CutGate {
 public:
  explicit CutGate(const CutGateSettings& settings) : settings_{settings} {}

  enum class Change : std::uint8_t { none, entered, left };

  // One step of `step_s`: level of what repeats with the spindle, which is what tells of a cut (chatter does not
  // repeat, and must not pass for an entry), and of the whole vibration (both m/s^2, > 0); speed in rad/s.
  Change step(double level, double whole_level, double speed, double step_s) noexcept;

  // Chatter was heard: the tool must be in the cut, whatever the level says.
  Change contact() noexcept;
  // That chatter is over: where nothing but chatter told of the cut, so is the cut.
  Change contact_over() noexcept;

  [[nodiscard]] State state() const noexcept { return state_; }
  [[nodiscard]] double air_level() const noexcept { return air_; }
  // Is so loud a vibration that of a cut, for all that can be told without a turning spindle?
  [[nodiscard]] bool at_cutting_level(double whole_level) const noexcept {
    return air_ > 0.0 && whole_level > settings_.entry_ratio * air_whole_;
  }

 private:
  CutGateSettings settings_;
  State state_ = State::idle;
  // The level (the whole level) has been at a cutting level in this cut, so its fall will tell the exit.
  bool level_tells_ = false, whole_tells_ = false;
  double air_ = 0.0, air_whole_ = 0.0;  // 0: not heard yet
  double heard_speed_ = 0.0;            // to which the air level belongs
  double revolutions_ = 0.0;            // since the state was entered
  double beyond_s_ = 0.0;               // how long the level has been beyond the limit that would change the state
};

}  // namespace stillcut
