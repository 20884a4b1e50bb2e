#include "rt/correction_ladder.hpp"

#include <algorithm>
#include <cmath>

#include "dsp/numbers.hpp"
#include "rt/direction_choice.hpp"
#include "rt/speed_choice.hpp"
#include "rt/variation_choice.hpp"

namespace stillcut {
namespace {

constexpr double kNearlyStable = -0.15;  // safe margin
constexpr int kMostSpeeds = 3;           // tried at a depth; chatter costs tool and part meanwhile
constexpr double kShallower = 0.9;       // of the depth at which something did not help: it may help there
constexpr double kLeastFeedGain = 0.05;  // less feed than now by this
constexpr double kSameSpeedAsRemembered = 0.005;

bool may(CorrectionKind kind, const Attempts& attempts, double depth, int most) noexcept {
  return !attempts.refused(kind) && attempts.count(kind, depth) < most;
}

struct Rung {
  Candidate candidate;
  bool stable = false;  // predicted so, or the best that can be said without a prediction
};

double depth_scatter(const Prediction& p) noexcept {
  double scatter = 0.0;
  for (const LobeDiagram* diagram : {p.here, p.ahead})
    if (diagram != nullptr) scatter = std::max(scatter, diagram->depth_scatter);
  return scatter;
}

Rung speed_rung(const ChatterSituation& s, const Attempts& attempts, const CompensationLimits& limits) noexcept {
  const double depth = s.prediction.axial_depth;
  if (!may(CorrectionKind::spindle_speed, attempts, depth, kMostSpeeds)) return {};
  const Attempts::Speeds tried = attempts.speeds(depth);
  SpeedQuestion question;
  question.chatter_frequency_hz = s.structural ? kNaN : s.chatter_frequency_hz;
  question.vibration_hz = s.vibration_hz;
  question.teeth = s.teeth;
  question.speed = s.present.speed;
  question.programmed_speed = s.programmed.speed;
  question.prediction = s.prediction;
  question.tried = {tried.speed.data(), tried.count};
  const SpeedChoice choice = choose_speed(question, limits);
  if (!choice.found()) return {};
  // What is only better chatters on. A tool near its limit does so much less; a structure is thrown as far by a faster
  // tool.
  const bool nearly_stable = !s.structural && choice.safe_margin > kNearlyStable;
  if (choice.grounds == SpeedGrounds::improved && !nearly_stable) return {};
  Rung rung;
  rung.candidate.kind = CorrectionKind::spindle_speed;
  rung.candidate.setting = s.programmed;
  rung.candidate.setting.speed = choice.target;
  rung.candidate.lobe = choice.lobe;
  rung.candidate.settle_s = choice.decay_s;
  rung.candidate.margin_before = choice.margin_before;
  rung.candidate.margin_after = choice.margin_after;
  rung.candidate.limited_by = choice.limited_by;
  rung.candidate.confidence_percent = choice.confidence_percent;
  rung.stable = choice.grounds > SpeedGrounds::improved;
  return rung;
}

Rung variation_rung(const ChatterSituation& s, const Attempts& attempts, const CompensationLimits& limits) noexcept {
  if (s.structural || !may(CorrectionKind::speed_variation, attempts, s.prediction.axial_depth, 1)) return {};
  const VariationChoice choice = choose_variation({s.present.speed, s.programmed.speed, s.prediction}, limits);
  if (!choice.found || choice.margin_after < kNearlyStable) return {};
  Rung rung;
  rung.candidate.kind = CorrectionKind::speed_variation;
  rung.candidate.setting = s.programmed;
  rung.candidate.setting.speed = choice.mean;
  rung.candidate.setting.variation_ratio = choice.ratio;
  rung.candidate.setting.variation_hz = choice.frequency_hz;
  rung.candidate.margin_before = choice.margin_before;
  rung.candidate.margin_after = choice.margin_after;
  rung.candidate.confidence_percent = 30;
  rung.stable = !((1.0 + choice.margin_after) * (1.0 - depth_scatter(s.prediction)) <= 1.0);
  return rung;
}

Rung direction_rung(const ChatterSituation& s, const Attempts& attempts, const CompensationLimits& limits) noexcept {
  if (!may(CorrectionKind::feed_direction, attempts, s.prediction.axial_depth, 1)) return {};
  const DirectionChoice choice = choose_direction({s.present.feed_direction, s.programmed.feed_direction,
                                                   s.programmed.speed, s.prediction.axial_depth, s.prediction.here},
                                                  limits);
  // The limits over direction hold at the programmed speed, to which this returns: what counts is the present setting.
  const double now = margin_at(s.prediction, s.present.speed);
  if (!choice.found || choice.margin_after <= now) return {};
  Rung rung;
  rung.candidate.kind = CorrectionKind::feed_direction;
  rung.candidate.setting = s.programmed;
  rung.candidate.setting.feed_direction = choice.direction;
  rung.candidate.margin_before = std::isnan(now) ? choice.margin_before : now;
  rung.candidate.margin_after = choice.margin_after;
  rung.candidate.confidence_percent = choice.stable ? 60 : 30;
  rung.stable = choice.stable;
  return rung;
}

// Why nothing better is left: no speed of the range, and where the path holds the feed no other direction.
std::int32_t what_limits(const CompensationLimits& limits) noexcept {
  return kNoStableSettingKnown | kLimitedBySpeedRange | (limits.free_turn > 0.0 ? 0 : kLimitedByPath);
}

// The speed as it is set; on the way through a dead zone that of the program, unless it is predicted worse.
double speed_to_stay_at(const ChatterSituation& s, const CompensationLimits& limits) noexcept {
  const double set = std::clamp(s.set_speed, limits.spindle.min_speed, limits.spindle.max_speed);
  const bool worse = margin_at(s.prediction, s.programmed.speed) < margin_at(s.prediction, s.present.speed);
  return may_stay_at(limits, set) || worse ? set : s.programmed.speed;
}

// Less feed does not move the limit; it makes the chips and with them the amplitude smaller, which a tool thrown about
// by its own chatter follows.
Rung feed_rung(const ChatterSituation& s, const Attempts& attempts, const CompensationLimits& limits) noexcept {
  if (!may(CorrectionKind::feed_override, attempts, s.prediction.axial_depth, 1)) return {};
  const double least_by_tool =
      limits.feed_per_tooth > 0.0 ? std::min(1.0, limits.min_feed_per_tooth / limits.feed_per_tooth) : 0.0;
  const double least_by_range = limits.min_feed_override * s.programmed.speed / s.present.speed;
  Rung rung;
  rung.candidate.kind = CorrectionKind::feed_override;
  rung.candidate.setting = s.present;
  rung.candidate.setting.feed_direction = s.programmed.feed_direction;  // no message of this kind keeps it turned
  rung.candidate.setting.variation_ratio = rung.candidate.setting.variation_hz = 0.0;
  rung.candidate.setting.speed = speed_to_stay_at(s, limits);
  rung.candidate.setting.feed_factor = std::max(least_by_tool, least_by_range);
  if (!(rung.candidate.setting.feed_factor < s.present.feed_factor - kLeastFeedGain)) return {};
  rung.candidate.limited_by = kLimitedByFeedRange | what_limits(limits);
  rung.candidate.margin_before = rung.candidate.margin_after = margin_at(s.prediction, s.present.speed);
  rung.candidate.confidence_percent = 20;
  return rung;
}

Candidate stop_candidate(const ChatterSituation& s, const Attempts& attempts,
                         const CompensationLimits& limits) noexcept {
  Candidate stop;
  stop.limited_by = what_limits(limits);
  stop.margin_before = stop.margin_after = margin_at(s.prediction, s.present.speed);
  if (!limits.may_stop || attempts.refused(CorrectionKind::stop_request)) return stop;
  stop.kind = CorrectionKind::stop_request;
  stop.setting = s.present;
  stop.setting.feed_direction = s.programmed.feed_direction;
  stop.setting.speed = speed_to_stay_at(s, limits);
  stop.setting.variation_ratio = stop.setting.variation_hz = 0.0;
  stop.setting.feed_factor = 0.0;
  stop.confidence_percent = 100;
  return stop;
}

Rung remembered_rung(const ChatterSituation& s, const Attempts& attempts, const CompensationLimits& limits) noexcept {
  if (s.remembered == nullptr) return {};
  const CutSetting& setting = s.remembered->setting;
  const Attempts::Speeds tried = attempts.speeds(s.prediction.axial_depth);
  const bool failed = was_tried({tried.speed.data(), tried.count}, setting.speed);
  const bool is_there = std::abs(setting.speed - s.present.speed) < kSameSpeedAsRemembered * s.present.speed;
  const double now = margin_at(s.prediction, s.present.speed), there = margin_at(s.prediction, setting.speed);
  const bool predicted_worse = !std::isnan(now) && !(there > now && there > 0.0);
  if (s.structural || s.deafened || failed || is_there || predicted_worse ||
      attempts.refused(CorrectionKind::spindle_speed) || !may_stay_at(limits, setting.speed) ||
      !keeps_feed_per_tooth(limits, setting.speed, s.programmed.speed))
    return {};
  Rung rung;
  rung.candidate.kind = CorrectionKind::spindle_speed;
  rung.candidate.setting = s.programmed;
  rung.candidate.setting.speed = setting.speed;
  rung.candidate.remembered = true;
  rung.candidate.margin_before = now;
  rung.candidate.margin_after = there;
  rung.candidate.confidence_percent = 90;
  rung.stable = true;
  return rung;
}

bool is_some(const Rung& rung) noexcept { return rung.candidate.kind != CorrectionKind::release; }

}  // namespace

void Attempts::add(const Candidate& candidate, double axial_depth) noexcept {
  const auto end = attempts_.begin() + static_cast<std::ptrdiff_t>(count_);
  const bool known = std::any_of(attempts_.begin(), end, [&](const Attempt& a) {
    return a.kind == candidate.kind && a.speed == candidate.setting.speed && !(axial_depth < a.axial_depth);
  });
  if (!known && count_ < kMost) attempts_[count_++] = {candidate.kind, candidate.setting.speed, axial_depth};
}

// Without a known depth what did not help does not help.
int Attempts::count(CorrectionKind kind, double axial_depth) const noexcept {
  if (count_ == kMost) return static_cast<int>(kMost);
  return static_cast<int>(
      std::count_if(attempts_.begin(), attempts_.begin() + static_cast<std::ptrdiff_t>(count_),
                    [&](const Attempt& a) { return a.kind == kind && !(axial_depth < kShallower * a.axial_depth); }));
}

Attempts::Speeds Attempts::speeds(double axial_depth) const noexcept {
  Speeds speeds;
  for (std::size_t i = 0; i < count_; ++i)
    if (attempts_[i].kind == CorrectionKind::spindle_speed && !(axial_depth < kShallower * attempts_[i].axial_depth))
      speeds.speed[speeds.count++] = attempts_[i].speed;
  return speeds;
}

Candidate next_candidate(const ChatterSituation& s, const Attempts& attempts,
                         const CompensationLimits& limits) noexcept {
  if (s.patience_is_out && !s.doubtful) return stop_candidate(s, attempts, limits);
  const Rung remembered = remembered_rung(s, attempts, limits);
  if (is_some(remembered)) return remembered.candidate;
  const Rung speed = speed_rung(s, attempts, limits);
  const Rung variation = variation_rung(s, attempts, limits);
  const Rung direction = direction_rung(s, attempts, limits);
  const std::array<const Rung*, 3> of_tool{&speed, &variation, &direction};
  const std::array<const Rung*, 3> of_structure{&direction, &speed, &variation};
  const auto& order = s.structural ? of_structure : of_tool;
  for (const Rung* rung : order)
    if (is_some(*rung) && rung->stable) return rung->candidate;
  if (s.deafened) return stop_candidate(s, attempts, limits);
  for (const Rung* rung : order)
    if (is_some(*rung)) return rung->candidate;
  if (s.doubtful) {
    Candidate nothing;
    nothing.limited_by = kNoStableSettingKnown;
    return nothing;
  }
  const Rung feed = feed_rung(s, attempts, limits);
  return is_some(feed) ? feed.candidate : stop_candidate(s, attempts, limits);
}

}  // namespace stillcut
