#include "rt/compensator.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace stillcut {
namespace {

constexpr std::int32_t kValidFor_ms = 500;
constexpr std::int64_t kPublishMoving_ns = 10'000'000, kPublishHolding_ns = 100'000'000;
constexpr std::int64_t kUnknownKindWaits_ns = 150'000'000;  // a line on a spindle order may still prove to be forced
constexpr std::int64_t kAnswerWithin_ns = 1'000'000'000;
constexpr double kShadowRetarget = 0.03;  // in shadow nothing moves; follow the frequency in steps of this size
constexpr std::int64_t kShadowAct_ns = 150'000'000;

constexpr std::int64_t to_ns(double seconds) noexcept { return static_cast<std::int64_t>(seconds * 1e9); }

}  // namespace

void Compensator::acknowledge(const CorrectionAck& ack) noexcept {
  if (ack.sequence < first_sequence_ || ack.sequence > sequence_) return;  // no answer to what is asked now
  if (ack.accepted) {
    answered_ns_ = std::max(answered_ns_, ack.stamp_ns);
  } else {
    refused_ = true;
  }
}

// Why nothing may be asked of the controller now; nullptr when all conditions hold.
const char* Compensator::reason_to_hold_back(const CompensatorInputs& in) noexcept {
  if (in.monitor->doubts != kNoDoubt) return "the monitor cannot tell";
  if (settings_.mode != RuntimeMode::active) return nullptr;
  if (!in.controller_alive) return "controller silent";
  if (correcting_ && in.now_ns - answered_ns_ > kAnswerWithin_ns) refused_ = true;
  if (!in.monitor->chatter && !correcting_) refused_ = false;  // a new episode is a new question
  return refused_ ? "controller refused or did not answer" : nullptr;
}

void Compensator::step(const CompensatorInputs& in, OutputQueue& out) noexcept {
  if (settings_.mode == RuntimeMode::off) return;
  if (const char* reason = reason_to_hold_back(in)) {
    if (!held_back_) release(in, reason, out);
    held_back_ = true;
    chatter_since_ns_ = 0;
    said_none_ = said_none_ && in.monitor->chatter;
    return;
  }
  held_back_ = false;
  if (in.monitor->chatter) {
    if (chatter_since_ns_ == 0) chatter_since_ns_ = in.now_ns;
    consider(in, out);
  } else {
    chatter_since_ns_ = 0;
    said_none_ = false;
    const State state = in.monitor->state;
    if (correcting_ && (state == State::air || state == State::idle)) release(in, "cut is over", out);
  }
  if (correcting_ && in.now_ns >= next_publish_ns_) publish(in, out);
}

void Compensator::consider(const CompensatorInputs& in, OutputQueue& out) noexcept {
  const MonitorView& heard = *in.monitor;
  if (!heard.single_line) return;  // no frequency to put the teeth in step with
  if (heard.kind == ChatterKind::unknown && in.now_ns - chatter_since_ns_ < kUnknownKindWaits_ns) return;
  const bool fading = !(heard.indicator >= 1.0);
  if (said_none_ || fading || (correcting_ && in.now_ns < act_until_ns_)) return;

  SpeedQuestion question{
      heard.chatter_frequency_hz,   settings_.teeth, heard.speed, in.axial_depth, settings_.spindle, in.lobes,
      {tried_.data(), tried_count_}};
  if (correcting_ && settings_.mode == RuntimeMode::shadow) {
    question.tried = {};  // nothing was tried: nobody follows a shadow
    const SpeedChoice choice = choose_speed(question);
    if (choice.found && std::abs(choice.target - choice_.target) > kShadowRetarget * choice_.target)
      start(in, choice, out);
    return;
  }
  if (correcting_) {  // it had its time and did not help: the next one
    tried_[tried_count_++] = choice_.target;
    question.tried = {tried_.data(), tried_count_};
  }
  const SpeedChoice choice = choose_speed(question);
  if (choice.found && tried_count_ < kMaxTried) {
    start(in, choice, out);
  } else {
    say_none(in, choice, out);
  }
}

MotionState Compensator::setpoint(std::int64_t now_ns) const noexcept {
  return ramp_.at(static_cast<double>(now_ns - started_ns_) * 1e-9);
}

void Compensator::start(const CompensatorInputs& in, const SpeedChoice& choice, OutputQueue& out) noexcept {
  const MonitorView& heard = *in.monitor;
  const MotionState from = correcting_ ? setpoint(in.now_ns) : MotionState{0.0, heard.speed, 0.0};
  const VelocityPlan plan =
      plan_velocity(from, choice.target, 0.0, {settings_.spindle.acceleration, settings_.spindle.jerk});
  if (plan.error != TrajectoryError::none) return;
  if (!correcting_) {
    // A programmed speed that the spindle cannot turn is none.
    const bool programmed =
        in.nominal_speed >= settings_.spindle.min_speed && in.nominal_speed <= settings_.spindle.max_speed;
    base_speed_ = programmed ? in.nominal_speed
                             : std::clamp(heard.speed, settings_.spindle.min_speed, settings_.spindle.max_speed);
    answered_ns_ = in.now_ns;
    first_sequence_ = sequence_ + 1;
  }
  correcting_ = true;
  choice_ = choice;
  chatter_frequency_hz_ = heard.chatter_frequency_hz;
  ramp_ = plan.trajectory;
  started_ns_ = next_publish_ns_ = in.now_ns;
  act_until_ns_ = in.now_ns + (settings_.mode == RuntimeMode::shadow
                                   ? kShadowAct_ns
                                   : to_ns(ramp_.duration() + 4.0 * settings_.spindle_time_constant_s + 0.1));
  char note[96];
  std::snprintf(note, sizeof note, "%s k=%d from=%.0f margin_before=%.2f margin_after=%.2f",
                settings_.mode == RuntimeMode::active ? "active" : "shadow", choice.lobe, rad_s_to_rpm(heard.speed),
                choice.margin_before, choice.margin_after);
  out.put(Event{heard.stamp_ns, EventType::correction, ChatterKind::unknown, chatter_frequency_hz_, heard.indicator,
                rad_s_to_rpm(choice.target), short_text(note)});
}

void Compensator::say_none(const CompensatorInputs& in, const SpeedChoice& choice, OutputQueue& out) noexcept {
  choice_ = choice;
  choice_.limited_by |= kNoStableSettingKnown;  // also where there were speeds left, but enough were tried in vain
  release(in, "no stable speed known", out);
  said_none_ = true;
  out.put(Event{in.monitor->stamp_ns, EventType::correction, ChatterKind::unknown, in.monitor->chatter_frequency_hz,
                in.monitor->indicator, std::nan(""), short_text("no stable speed known inside the spindle's limits")});
}

void Compensator::publish(const CompensatorInputs& in, OutputQueue& out) noexcept {
  const MotionState now = setpoint(in.now_ns);
  const bool moving = static_cast<double>(in.now_ns - started_ns_) * 1e-9 < ramp_.duration();
  next_publish_ns_ = in.now_ns + (moving ? kPublishMoving_ns : kPublishHolding_ns);
  Correction c;
  c.stamp_ns = in.now_ns;
  c.sequence = ++sequence_;
  c.valid_for_ms = kValidFor_ms;
  c.mode = settings_.mode;
  c.kind = CorrectionKind::spindle_speed;
  c.spindle_speed_rpm =
      rad_s_to_rpm(std::clamp(now.velocity, settings_.spindle.min_speed, settings_.spindle.max_speed));
  c.spindle_speed_target_rpm = rad_s_to_rpm(choice_.target);
  c.feed_override = base_speed_ > 0.0 ? c.spindle_speed_rpm / rad_s_to_rpm(base_speed_) : 1.0;
  c.feed_direction = in.feed_direction;
  c.chatter_frequency_hz = chatter_frequency_hz_;
  c.predicted_margin_before = choice_.margin_before;
  c.predicted_margin_after = choice_.margin_after;
  c.limited_by = choice_.limited_by | (moving ? kLimitedByAcceleration : 0);
  c.confidence_percent = static_cast<std::int8_t>(choice_.confidence_percent);
  char reason[96];
  std::snprintf(reason, sizeof reason, "n = 60 f_c / (N k), k = %d", choice_.lobe);
  c.reason = short_text(reason);
  out.put(c);
}

void Compensator::release(const CompensatorInputs& in, const char* reason, OutputQueue& out) noexcept {
  correcting_ = false;
  tried_count_ = 0;
  Correction c;
  c.stamp_ns = in.now_ns;
  c.sequence = ++sequence_;
  c.valid_for_ms = kValidFor_ms;
  c.mode = settings_.mode;
  c.kind = CorrectionKind::release;
  const double nominal_rpm = rad_s_to_rpm(in.nominal_speed > 0.0 ? in.nominal_speed : in.monitor->speed);
  c.spindle_speed_rpm = c.spindle_speed_target_rpm = nominal_rpm;
  c.feed_direction = in.feed_direction;
  c.chatter_frequency_hz = in.monitor->chatter_frequency_hz;
  c.predicted_margin_before = c.predicted_margin_after = std::nan("");
  c.limited_by = choice_.limited_by;
  c.reason = short_text(reason);
  out.put(c);
  choice_ = {};
}

}  // namespace stillcut
