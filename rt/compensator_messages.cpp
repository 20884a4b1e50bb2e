// What the compensator says: the start of a candidate, its setpoints, the release, and that nothing is known.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "dsp/numbers.hpp"
#include "rt/compensator.hpp"

namespace stillcut {
namespace {

constexpr std::int32_t kValidFor_ms = 500;
constexpr const char* kNothingKnown = "no stable setting known";
constexpr std::int64_t kPublishMoving_ns = 10'000'000, kPublishHolding_ns = 100'000'000;

const char* mode_text(RuntimeMode mode) noexcept { return mode == RuntimeMode::active ? "active" : "shadow"; }

// One line that says what is done and on what grounds.
ShortText describe_candidate(const Candidate& c) noexcept {
  std::array<char, 96> text{};
  switch (c.kind) {
    case CorrectionKind::spindle_speed:
      if (c.remembered) return short_text("speed that worked here before");
      if (c.lobe == 0) return short_text("speed of a predicted pocket");
      std::snprintf(text.data(), text.size(), "n = 60 f_c / (N k), k = %d", c.lobe);
      break;
    case CorrectionKind::speed_variation:
      std::snprintf(text.data(), text.size(), "no stable speed in reach: speed varies by %.0f %% at %.2f Hz",
                    100.0 * c.setting.variation_ratio, c.setting.variation_hz);
      break;
    case CorrectionKind::feed_direction:
      std::snprintf(text.data(), text.size(), "feed turned to %.0f deg", rad_to_deg(c.setting.feed_direction));
      break;
    case CorrectionKind::feed_override:
      std::snprintf(text.data(), text.size(), "no stable setting known: feed per tooth reduced to %.0f %%",
                    100.0 * c.setting.feed_factor);
      break;
    case CorrectionKind::stop_request:
      return short_text("no stable setting known: stop");
    case CorrectionKind::release:
      break;
  }
  return text;
}

}  // namespace

void Compensator::start(const CompensatorInputs& in, const Candidate& candidate, OutputQueue& out) noexcept {
  const MonitorView& heard = *in.monitor;
  if (!correcting()) {
    begin_motion(in);
    loudest_ = 0.0;
    answered_ns_ = in.now_ns;
    chatter_depth_ = in.axial_depth;
    chatter_margin_ = margin_at(coming_prediction(in), programmed_.speed);
  }
  before_ = motion_.at(motion_time(in.now_ns)).now;
  if (!motion_.move_to(candidate.setting, motion_time(in.now_ns), settings_.limits, 1.0)) return;
  first_sequence_ = sequence_ + 1;
  candidate_ = candidate;
  asked_ = candidate.kind;
  taken_ = false;
  checked_ = kInfinity;
  tolerated_ = 0.0;
  believed_since_ns_ = believed_since_ns_ == 0 ? in.now_ns : believed_since_ns_;
  nominal_speed_ = in.nominal_speed;
  remembered_ = candidate.remembered;
  phase_ = candidate.kind == CorrectionKind::stop_request ? Phase::stopped : Phase::acting;
  const double of_tool = frequency_of_chatter(in);
  chatter_frequency_hz_ = !heard.chatter        ? heard.structural_frequency_hz
                          : std::isnan(of_tool) ? heard.chatter_frequency_hz
                                                : of_tool;
  next_publish_ns_ = in.now_ns;
  act_until_ns_ = in.now_ns + time_to_act_ns(in);
  ShortText note{};
  if (candidate.kind == CorrectionKind::spindle_speed && candidate.lobe > 0) {
    std::snprintf(note.data(), note.size(), "%s k=%d from=%.0f margin_before=%.2f margin_after=%.2f",
                  mode_text(settings_.mode), candidate.lobe, rad_s_to_rpm(heard.speed), candidate.margin_before,
                  candidate.margin_after);
  } else {
    std::snprintf(note.data(), note.size(), "%s %.80s", mode_text(settings_.mode),
                  describe_candidate(candidate).data());
  }
  const bool has_speed = candidate.kind != CorrectionKind::stop_request;
  out.put(Event{heard.stamp_ns, EventType::correction, ChatterKind::unknown, chatter_frequency_hz_, heard.indicator,
                has_speed ? rad_s_to_rpm(candidate.setting.speed) : kNaN, note});
}

void Compensator::say_none(const CompensatorInputs& in, const Candidate& candidate, OutputQueue& out) noexcept {
  candidate_.limited_by = candidate.limited_by | kNoStableSettingKnown;
  const bool refused = refusal_[0] != '\0';
  release(in, refused ? with_refusal("nothing is left that the controller takes").data() : kNothingKnown, out);
  said_none_ = true;
  const MonitorView& heard = *in.monitor;
  out.put(Event{heard.stamp_ns, EventType::correction, ChatterKind::unknown,
                heard.chatter ? heard.chatter_frequency_hz : heard.structural_frequency_hz, heard.indicator, kNaN,
                short_text(kNothingKnown)});
}

void Compensator::publish(const CompensatorInputs& in, OutputQueue& out) noexcept {
  const CompensationLimits& limits = settings_.limits;
  const auto [now, moving] = motion_.at(motion_time(in.now_ns));
  const bool returning = phase_ == Phase::returning;
  next_publish_ns_ = in.now_ns + (moving ? kPublishMoving_ns : kPublishHolding_ns);
  Correction c;
  c.stamp_ns = in.now_ns;
  c.sequence = last_asked_sequence_ = ++sequence_;
  c.valid_for_ms = kValidFor_ms;
  c.mode = settings_.mode;
  // A variation ends at once; a direction, a feed or a speed goes back as what it is: that the controller takes.
  const bool varied = candidate_.kind == CorrectionKind::speed_variation;
  c.kind = returning && varied ? CorrectionKind::spindle_speed : candidate_.kind;
  const double speed = std::clamp(now.speed, limits.spindle.min_speed, limits.spindle.max_speed);
  c.spindle_speed_rpm = rad_s_to_rpm(speed);
  c.spindle_speed_target_rpm = rad_s_to_rpm(motion_.target().speed);
  c.speed_variation_ratio = now.variation_ratio;
  c.speed_variation_hz = now.variation_hz;
  const double keeps_feed = override_for(limits, speed, programmed_.speed);
  c.feed_override = c.kind == CorrectionKind::stop_request
                        ? keeps_feed * std::max(now.feed_factor, 0.0)
                        : std::clamp(keeps_feed * now.feed_factor, limits.min_feed_override, limits.max_feed_override);
  c.feed_direction = c.kind == CorrectionKind::feed_direction ? now.feed_direction : in.feed_direction;
  c.chatter_frequency_hz = chatter_frequency_hz_;
  c.predicted_margin_before = candidate_.margin_before;
  c.predicted_margin_after = candidate_.margin_after;
  if (returning) {
    c.predicted_margin_before = margin_at(prediction(in), speed);
    c.predicted_margin_after = margin_at(prediction(in), programmed_.speed);
  }
  c.limited_by = candidate_.limited_by | (moving ? kLimitedByAcceleration : 0);
  c.confidence_percent = static_cast<std::int8_t>(candidate_.confidence_percent);
  c.reason = returning ? short_text("reason is gone: slowly back to the program") : describe_candidate(candidate_);
  out.put(c);
}

void Compensator::release(const CompensatorInputs& in, const char* reason, OutputQueue& out) noexcept {
  const CutSetting nominal = programmed(in);
  const double measured = in.monitor->speed;
  Correction c;
  c.stamp_ns = in.now_ns;
  c.sequence = ++sequence_;
  c.valid_for_ms = kValidFor_ms;
  c.mode = settings_.mode;
  c.kind = CorrectionKind::release;
  const double speed = in.nominal_speed > 0.0 ? in.nominal_speed : correcting() ? nominal.speed : measured;
  c.spindle_speed_rpm = c.spindle_speed_target_rpm = rad_s_to_rpm(speed);
  c.feed_direction = nominal.feed_direction;
  c.chatter_frequency_hz = in.monitor->chatter_frequency_hz;
  c.predicted_margin_before = c.predicted_margin_after = kNaN;
  c.limited_by = candidate_.limited_by;
  c.reason = short_text(reason);
  out.put(c);
  if (correcting()) begin_turn_back(in);
  phase_ = Phase::none;
  act_until_ns_ = 0;
  believed_since_ns_ = 0;
  candidate_ = {};
}

}  // namespace stillcut
