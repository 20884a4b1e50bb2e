#include "dsp/cut_gate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stillcut {
namespace {

constexpr double kMustLast_s = 0.015;  // a single knock changes no state
constexpr double kRevolutionsToLearn = 6.0;
constexpr double kSameSpeed = 0.1;

}  // namespace

CutGate::Change CutGate::step(double level, double whole_level, double speed, double step_s) noexcept {
  const bool was_cutting = state_ == State::entry || state_ == State::cut;
  if (speed < settings_.idle_speed) {
    state_ = State::idle;
    beyond_s_ = 0.0;
    return was_cutting ? Change::left : Change::none;
  }
  if (state_ == State::idle) {
    state_ = State::air;
    revolutions_ = 0.0;
  }
  revolutions_ += speed * step_s / (2.0 * std::numbers::pi);
  // Another speed has another quiet level: hear it anew.
  if (!was_cutting && std::abs(speed - heard_speed_) > kSameSpeed * heard_speed_) {
    heard_speed_ = speed;
    air_ = revolutions_ = beyond_s_ = 0.0;
    state_ = State::air;
  }
  // The quiet level of the turning spindle: follows a fall soon, a rise only slowly (a warmer, louder spindle), and not
  // while the tool cuts.
  if (air_ > 0.0) {
    const double memory_s = level < air_ ? settings_.air_fall_s : settings_.air_rise_s;
    if (!was_cutting || level < air_) {
      const double share = std::min(1.0, step_s / memory_s);
      air_ += share * (level - air_);
      air_whole_ += share * (whole_level - air_whole_);
    }
  } else if (revolutions_ > kRevolutionsToLearn) {
    air_ = level;
    air_whole_ = whole_level;
  }
  if (air_ <= 0.0) return Change::none;

  const bool loud = level > settings_.entry_ratio * air_;
  level_tells_ = was_cutting && (level_tells_ || loud);
  whole_tells_ = was_cutting && (whole_tells_ || whole_level > settings_.entry_ratio * air_whole_);
  const bool quiet = (level_tells_ && level < settings_.exit_ratio * air_) ||
                     (whole_tells_ && whole_level < settings_.exit_ratio * air_whole_);
  // What repeats is learned anew after an exit: before that its level tells nothing.
  const bool beyond = was_cutting ? quiet : loud && revolutions_ > kRevolutionsToLearn;
  beyond_s_ = beyond ? beyond_s_ + step_s : 0.0;
  if (beyond_s_ >= kMustLast_s) {
    beyond_s_ = revolutions_ = 0.0;
    state_ = was_cutting ? State::exit : State::entry;
    return was_cutting ? Change::left : Change::entered;
  }
  if (state_ == State::entry && revolutions_ >= settings_.entry_revolutions) state_ = State::cut;
  if (state_ == State::exit && revolutions_ >= 2.0) state_ = State::air;
  return Change::none;
}

CutGate::Change CutGate::contact() noexcept {
  const bool was_cutting = state_ == State::entry || state_ == State::cut;
  state_ = State::cut;
  beyond_s_ = revolutions_ = 0.0;
  return was_cutting ? Change::none : Change::entered;
}

CutGate::Change CutGate::contact_over() noexcept {
  if (state_ != State::cut || level_tells_) return Change::none;
  state_ = State::exit;
  beyond_s_ = revolutions_ = 0.0;
  return Change::left;
}

}  // namespace stillcut
