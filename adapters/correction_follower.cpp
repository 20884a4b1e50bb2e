#include "adapters/correction_follower.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "models/machining.hpp"

namespace stillcut {
namespace {

constexpr std::int32_t kLongestValid_ms = 10'000;
constexpr double kHighestOverride = 10.0;  // beyond it a message is broken
constexpr double kForgetClock_s = 10.0;    // after such a silence the monitor's clock is learned anew
constexpr double kClockDrift = 1e-3;       // two clocks drift apart by less than this
constexpr double kSlowReturn = 0.2;        // of the rate at which a correction is followed
constexpr double kLongestStep_s = 0.1;     // a pause of the controller must not become a jump
constexpr double kStandingSpindle_rpm = 1.0;
constexpr double kVariationRises_s = 1.0;  // until the full amplitude
constexpr double kPathTurnsAway = 0.1;     // rad, beyond what we turn it ourselves
constexpr double kSameRelative = 1e-9;
constexpr double kSpeedHeldBack = 0.02;  // relative: a difference worth telling

template <class... Values>
ShortText reason(const char* format, Values... values) {
  ShortText text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text;
}

double toward(double from, double to, double step) {
  return std::abs(to - from) <= step ? to : from + std::copysign(step, to - from);
}

bool lies_within(double value, double min, double max) {  // false for NaN
  return value >= min * (1.0 - kSameRelative) && value <= max * (1.0 + kSameRelative);
}

}  // namespace

// The sequence is the monitor's from its start on: a lower one is an old message, or among the first ones of a monitor
// that was started again. The latter is believed only when nothing of the former is in force any more, and its clock
// has gone on or nothing was heard for long.
bool CorrectionFollower::is_new(const Correction& correction, std::int64_t now_ns) const {
  if (!heard_ || correction.sequence > sequence_) return true;
  if (static_cast<double>(now_ns - heard_ns_) * 1e-9 > kForgetClock_s) return true;
  return correction.sequence < sequence_ && !correction_ && correction.stamp_ns > stamp_ns_;
}

double CorrectionFollower::age_s(const Correction& correction, std::int64_t now_ns) {
  const double took = static_cast<double>(now_ns) * 1e-9 - static_cast<double>(correction.stamp_ns) * 1e-9;
  const double since = static_cast<double>(now_ns - heard_ns_) * 1e-9;
  if (!heard_ || since > kForgetClock_s) {
    quickest_s_ = took;
  } else {
    quickest_s_ = std::min(quickest_s_ + kClockDrift * since, took);
  }
  return took - quickest_s_;
}

std::optional<Answer> CorrectionFollower::receive(const Correction& correction, std::int64_t now_ns) {
  if (correction.mode != RuntimeMode::active) {
    ++counters_.shadow;
    return std::nullopt;
  }
  if (correction.sequence < 0 || !is_new(correction, now_ns)) {
    ++counters_.old;
    return std::nullopt;
  }
  if (heard_ && correction.sequence > sequence_) counters_.lost += correction.sequence - sequence_ - 1;
  const double age = age_s(correction, now_ns);
  heard_ = true;
  heard_ns_ = now_ns;
  sequence_ = correction.sequence;
  stamp_ns_ = correction.stamp_ns;

  Answer answer;
  answer.reason = reason_to_refuse(correction, age);
  answer.ack = {now_ns, correction.sequence, answer.reason[0] == '\0', speed_rpm_, feed_};
  if (!answer.ack.accepted) {
    ++counters_.refused;
    return answer;
  }
  ++counters_.accepted;
  if (correction.kind == CorrectionKind::release) {
    correction_.reset();
  } else if (correction.kind == CorrectionKind::stop_request) {
    correction_.reset();
    stopped_ = true;
  } else {
    if (correction.kind == CorrectionKind::feed_direction && !follows(CorrectionKind::feed_direction))
      path_direction_ = programmed_direction();
    correction_ = correction;
    expires_ns_ = now_ns + static_cast<std::int64_t>((1e-3 * correction.valid_for_ms - age) * 1e9);
    answer.reason = held_back_of(correction);
  }
  return answer;
}

// With a kind that says nothing of the speed, what a controller without speeds, or a spindle that stands, cannot follow
// is held at the program's.
bool CorrectionFollower::carries_speed(const Correction& c) const {
  if (c.kind == CorrectionKind::spindle_speed || c.kind == CorrectionKind::speed_variation) return true;
  const bool names_it = !std::isnan(c.spindle_speed_rpm) && c.spindle_speed_rpm != 0.0;
  return names_it && takes(CorrectionKind::spindle_speed) && program_.spindle_speed_rpm >= kStandingSpindle_rpm;
}

// What of an accepted correction is not followed as asked.
ShortText CorrectionFollower::held_back_of(const Correction& c) const {
  if (carries_speed(c)) {
    if (c.feed_override <= settings_.max_feed_override * (1.0 + kSameRelative)) return {};
    return reason("feed override %.2f is held at %.2f", c.feed_override, settings_.max_feed_override);
  }
  const bool other_speed = std::abs(c.spindle_speed_rpm - program_.spindle_speed_rpm) >
                           kSpeedHeldBack * program_.spindle_speed_rpm;  // false for NaN
  if (c.spindle_speed_rpm == 0.0 || !other_speed) return {};
  return reason("spindle speed %.0f is held at the program's %.0f", c.spindle_speed_rpm, program_.spindle_speed_rpm);
}

ShortText CorrectionFollower::reason_to_refuse(const Correction& c, double age) const {
  if (c.valid_for_ms < 1 || c.valid_for_ms > kLongestValid_ms)
    return reason("valid_for_ms is not from 1 to %d", kLongestValid_ms);
  if (age > 1e-3 * c.valid_for_ms) return reason("too late: %.0f ms on its way", 1e3 * age);
  if (const char* cannot = settings_.refusals.at(static_cast<std::size_t>(c.kind))) return short_text(cannot);
  if (c.kind == CorrectionKind::release || c.kind == CorrectionKind::stop_request) return {};
  if (held_back_ != nullptr) return short_text(held_back_);
  if (stopped_) return short_text("stopped; start the program again at the controller");
  ShortText against{};
  if (c.kind == CorrectionKind::feed_direction) against = reason_against_turn(c);
  if (c.kind == CorrectionKind::feed_override) against = reason_against_feed(c);
  if (against[0] != '\0' || !carries_speed(c)) return against;
  return reason_against_speed(c);
}

// More than the controller takes is asked for only beside a faster spindle, and is then held.
ShortText CorrectionFollower::reason_against_feed(const Correction& c) const {
  const double keeps_feed = carries_speed(c) ? c.spindle_speed_rpm / program_.spindle_speed_rpm : 0.0;
  const double highest = std::max(settings_.max_feed_override, keeps_feed);
  if (lies_within(c.feed_override, settings_.min_feed_override, highest)) return {};
  return reason("feed_override is not from %.2f to %.2f", settings_.min_feed_override, settings_.max_feed_override);
}

ShortText CorrectionFollower::reason_against_speed(const Correction& c) const {
  if (!(program_.spindle_speed_rpm >= kStandingSpindle_rpm)) return short_text("the program's spindle stands");
  if (!lies_within(c.spindle_speed_rpm, settings_.min_speed_rpm, settings_.max_speed_rpm))
    return reason("spindle_speed_rpm is not from %.0f to %.0f", settings_.min_speed_rpm, settings_.max_speed_rpm);
  if (!lies_within(c.feed_override, settings_.min_feed_override, kHighestOverride))
    return reason("feed_override is below %.2f, or no number", settings_.min_feed_override);
  // A variation whose mean is yet to be reached does not swing.
  if (c.kind != CorrectionKind::speed_variation || c.speed_variation_ratio == 0.0) return {};
  if (!(c.speed_variation_ratio > 0.0 && c.speed_variation_ratio <= settings_.max_variation_ratio))
    return reason("speed_variation_ratio is not above 0 and up to %.2f", settings_.max_variation_ratio);
  if (!(c.speed_variation_hz > 0.0 && c.speed_variation_hz <= settings_.max_variation_hz))
    return reason("speed_variation_hz is not above 0 and up to %.1f", settings_.max_variation_hz);
  const double amplitude = c.spindle_speed_rpm * c.speed_variation_ratio;
  if (!lies_within(c.spindle_speed_rpm - amplitude, settings_.min_speed_rpm, settings_.max_speed_rpm) ||
      !lies_within(c.spindle_speed_rpm + amplitude, settings_.min_speed_rpm, settings_.max_speed_rpm))
    return reason("the varied speed leaves %.0f to %.0f rpm", settings_.min_speed_rpm, settings_.max_speed_rpm);
  const double steepest = amplitude * kTwoPi * c.speed_variation_hz;
  constexpr double kRounding = 1e-6;
  if (steepest > settings_.speed_rate_rpm_per_s * (1.0 + kRounding))
    return reason("the variation takes %.0f rpm/s, the spindle has %.0f", steepest, settings_.speed_rate_rpm_per_s);
  return {};
}

double CorrectionFollower::turn_to(double direction) const {
  return std::remainder(direction - path_direction_, kTwoPi);
}

// The program's own direction: how the tool moves, less what was made of it here.
double CorrectionFollower::programmed_direction() const {
  const double share = program_.feed_rate_m_per_s > 0.0 ? aside_m_per_s_ / program_.feed_rate_m_per_s : 0.0;
  return program_.feed_direction - std::asin(std::clamp(share, -1.0, 1.0));
}

ShortText CorrectionFollower::reason_against_turn(const Correction& c) const {
  if (!std::isfinite(c.feed_direction)) return short_text("feed_direction_rad is no number");
  if (takes(CorrectionKind::feed_override) &&
      !lies_within(c.feed_override, settings_.min_feed_override, kHighestOverride))
    return reason("feed_override is below %.2f, or no number", settings_.min_feed_override);
  if (!(program_.feed_rate_m_per_s > 0.0)) return short_text("the tool does not move, its feed direction is not known");
  const bool goes_on = follows(CorrectionKind::feed_direction);
  const double turn =
      goes_on ? turn_to(c.feed_direction) : std::remainder(c.feed_direction - programmed_direction(), kTwoPi);
  if (std::abs(turn) > settings_.max_turn)
    return reason("a turn by %.0f deg; the path can be moved aside for %.0f deg at most", rad_to_deg(turn),
                  rad_to_deg(settings_.max_turn));
  if (std::abs(path_offset_) >= settings_.max_path_offset && turn * path_offset_ >= 0.0)
    return reason("the path stands at its limit, %.1f mm aside", 1e3 * settings_.max_path_offset);
  return {};
}

Setpoint CorrectionFollower::cycle(std::int64_t now_ns, const ProgramState& program) {
  const double step = cycled_ ? std::clamp(static_cast<double>(now_ns - cycle_ns_) * 1e-9, 0.0, kLongestStep_s) : 0.0;
  cycle_ns_ = now_ns;
  cycled_ = true;
  program_ = program;
  if (correction_ && now_ns > expires_ns_) {
    correction_.reset();
    ++counters_.lapsed;
  }
  if (held_back_ != nullptr) correction_.reset();
  move_spindle(step);
  move_feed(step);
  move_path(step);
  return {speed_rpm_, speed_rpm_ - program_.spindle_speed_rpm, feed_, path_offset_, stopped_};
}

void CorrectionFollower::move_spindle(double step) {
  const double programmed = program_.spindle_speed_rpm;
  if (!(programmed >= kStandingSpindle_rpm)) {  // the program stops its spindle: nothing may keep it turning
    if (moves_spindle()) correction_.reset();
    spindle_moved_ = false;
  }
  const bool follow = moves_spindle();
  if (!follow && !spindle_moved_) {
    mean_rpm_ = speed_rpm_ = programmed;
    variation_ratio_ = phase_ = 0.0;
    return;
  }
  spindle_moved_ = true;
  const double fastest = settings_.speed_rate_rpm_per_s * step;
  mean_rpm_ = follow ? toward(mean_rpm_, correction_->spindle_speed_rpm, fastest)
                     : toward(mean_rpm_, programmed, kSlowReturn * fastest);
  const bool varies = follows(CorrectionKind::speed_variation);
  if (varies) variation_hz_ = correction_->speed_variation_hz;
  variation_ratio_ = toward(variation_ratio_, varies ? correction_->speed_variation_ratio : 0.0,
                            settings_.max_variation_ratio * step / kVariationRises_s);
  phase_ = variation_ratio_ > 0.0 ? std::fmod(phase_ + kTwoPi * variation_hz_ * step, kTwoPi) : 0.0;
  speed_rpm_ = toward(speed_rpm_, mean_rpm_ * (1.0 + variation_ratio_ * std::sin(phase_)), fastest);
  spindle_moved_ = follow || speed_rpm_ != programmed || mean_rpm_ != programmed;
}

void CorrectionFollower::move_feed(double step) {
  double target = 1.0;
  if (moves_spindle() || (correction_ && takes(CorrectionKind::feed_override)))
    target = std::min(correction_->feed_override, settings_.max_feed_override);
  if (stopped_) target = 0.0;
  feed_ = toward(feed_, target, (target < feed_ ? settings_.feed_fall_per_s : settings_.feed_rise_per_s) * step);
  if (!spindle_moved_) return;
  // The spindle leaves and meets its target on its own time: until then the feed keeps to it.
  const double asked =
      moves_spindle() ? correction_->feed_override * program_.spindle_speed_rpm / correction_->spindle_speed_rpm : 1.0;
  feed_ = std::min(feed_, std::max(1.0, asked) * mean_rpm_ / program_.spindle_speed_rpm);
}

void CorrectionFollower::move_path(double step) {
  // Where the program's path itself has turned away, the direction asked for has lost its sense.
  if (follows(CorrectionKind::feed_direction) &&
      std::abs(turn_to(program_.feed_direction)) > settings_.max_turn + kPathTurnsAway)
    correction_.reset();
  const double before = path_offset_;
  const double farthest = settings_.path_speed_m_per_s * step;
  if (follows(CorrectionKind::feed_direction)) {
    const double aside = program_.feed_rate_m_per_s * std::sin(turn_to(correction_->feed_direction)) * step;
    path_offset_ = std::clamp(path_offset_ + std::clamp(aside, -farthest, farthest), -settings_.max_path_offset,
                              settings_.max_path_offset);
  } else {
    path_offset_ = toward(path_offset_, 0.0, kSlowReturn * farthest);
  }
  if (step > 0.0) aside_m_per_s_ = (path_offset_ - before) / step;
}

}  // namespace stillcut
