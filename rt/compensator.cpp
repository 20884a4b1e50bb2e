#include "rt/compensator.hpp"

#include <algorithm>
#include <cmath>

#include "dsp/integrity.hpp"
#include "dsp/numbers.hpp"
#include "rt/watch.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kQuietHasWorked_ns = 500'000'000;  // after which a correction is remembered
constexpr std::int64_t kQuietMayReturn_ns = 2'000'000'000;
constexpr std::int64_t kSafeMayReturn_ns = 1'000'000'000;  // the way out of the part is none
constexpr double kShadowRetarget = 0.03;  // in shadow nothing moves; follow the frequency in steps of this size
constexpr std::int64_t kShadowAct_ns = 150'000'000;
constexpr double kLastsTimeConstants = 4.0, kLasts_s = 0.1;                // until the effect is there
constexpr double kMostSettling_s = 0.5, kMostSettlingOfStructure_s = 2.5;  // and until the vibration has died out
constexpr double kFallen = 0.1, kTolerated = 2.0;                          // of the loudest; of what was left
constexpr double kFalls = 0.7;                                             // from one look to the next
constexpr std::int64_t kLookAgain_ns = 300'000'000, kDoubtLooksAgain_ns = 1'000'000'000;
constexpr double kSwingsToAct = 2.0;

}  // namespace

void Compensator::step(const CompensatorInputs& in, OutputQueue& out) noexcept {
  if (settings_.mode == RuntimeMode::off) return;
  meet_controller(in);
  follow_turn_back(in);
  tell_refusal(in, out);
  const State state = in.monitor->state;
  run_watch(air_since_ns_, state == State::air || state == State::idle, in.now_ns);
  run_watch(unheard_since_ns_, !is_heard(in), in.now_ns);
  run_watch(saturated_since_ns_, in.monitor->doubts == kSaturated && air_since_ns_ == 0, in.now_ns);
  if (const char* reason = reason_to_hold_back(in)) {
    // Where the sensor is beyond its range at the new setting as well, that is no second time the answer.
    const bool at_setting = phase_ == Phase::acting || phase_ == Phase::holding;
    if (at_setting && in.monitor->doubts == kSaturated) give_up_candidate(in);
    if (!held_back_) release(in, reason, out);
    held_back_ = true;
    chatter_since_ns_ = quiet_since_ns_ = 0;
    said_none_ = said_none_ && in.monitor->chatter;
    return;
  }
  held_back_ = false;
  const bool chatter = is_heard(in);
  run_watch(chatter_since_ns_, chatter, in.now_ns);
  run_watch(quiet_since_ns_, !chatter, in.now_ns);
  if (!chatter || phase_ == Phase::holding) believed_since_ns_ = 0;  // patience is for what was answered and goes on
  if (correcting() && program_changed(in)) return release(in, "the program changed", out);
  if (phase_ == Phase::stopped) {
    follow_stop(in, out);
  } else if (correcting() && attempts_.refused(candidate_.kind)) {
    leave_what_is_refused(in, out);
  } else if (chatter) {
    hear_chatter(in, out);
  } else {
    hear_nothing(in, out);
  }
  if (correcting() && in.now_ns >= next_publish_ns_) publish(in, out);
}

void Compensator::hear_nothing(const CompensatorInputs& in, OutputQueue& out) noexcept {
  said_none_ = false;
  if (has_run(air_since_ns_, in.now_ns, kAirEndsCut_ns)) {
    if (correcting()) release(in, "cut is over", out);
    attempts_.end_cut();
    return_failed_ = false;
    return;
  }
  if (phase_ == Phase::acting && in.now_ns >= act_until_ns_) phase_ = Phase::holding;
  const bool in_cut = in.monitor->state == State::cut;
  if (phase_ == Phase::holding && in_cut && has_run(quiet_since_ns_, in.now_ns, kQuietHasWorked_ns)) remember(in);
  const bool may_return = phase_ == Phase::holding && in_cut && has_run(quiet_since_ns_, in.now_ns, kQuietMayReturn_ns);
  run_watch(safe_since_ns_, may_return && reason_is_gone(in), in.now_ns);
  if (has_run(safe_since_ns_, in.now_ns, kSafeMayReturn_ns)) start_return(in);
  if (phase_ == Phase::returning && motion_time(in.now_ns) >= motion_.arrives_at())
    release(in, "back at the program", out);
}

void Compensator::hear_chatter(const CompensatorInputs& in, OutputQueue& out) noexcept {
  const MonitorView& heard = *in.monitor;
  if (said_none_) return;
  if (phase_ == Phase::returning) {  // back to what worked, and no second try
    return_failed_ = true;
    return start(in, Candidate{candidate_}, out);
  }
  loudest_ = std::max(loudest_, heard.chatter ? heard.chatter_amplitude : 0.0);
  const bool acting = has_its_time(in);
  const bool looked_in_vain = phase_ == Phase::none && in.now_ns < act_until_ns_;
  if (acting || looked_in_vain) return;
  if (!tool_chatters(in) && !structure_chatters(in)) return;
  if (correcting() && settings_.mode == RuntimeMode::shadow) return retarget_shadow(in, out);
  if (correcting() && gives_more_time(in)) return;
  if (correcting()) give_up_candidate(in);  // it had its time and did not help: the next one
  ask_next(in, out);
}

void Compensator::ask_next(const CompensatorInputs& in, OutputQueue& out) noexcept {
  const ChatterSituation now = situation(in);
  const Candidate next = next_candidate(now, attempts_, settings_.limits);
  if (next.kind == CorrectionKind::release && now.doubtful) {  // what is set is predicted stable: it stays
    if (correcting() && attempts_.refused(candidate_.kind))
      release(in, with_refusal("the controller refuses").data(), out);
    if (correcting()) phase_ = Phase::acting;
    act_until_ns_ = in.now_ns + kDoubtLooksAgain_ns;
    return;
  }
  next.kind == CorrectionKind::release ? say_none(in, next, out) : start(in, next, out);
}

// What falls goes on falling, and what has fallen to a tenth and stays there, where no chatter is predicted, is the
// forced vibration of the new speed or an echo of it: both are the success that was asked for.
bool Compensator::gives_more_time(const CompensatorInputs& in) noexcept {
  const MonitorView& heard = *in.monitor;
  if (!heard.chatter || !tool_chatters(in) || !heard.single_line || candidate_.kind == CorrectionKind::stop_request)
    return false;
  const double amplitude = heard.chatter_amplitude;
  const bool predicted_unstable = margin_at(coming_prediction(in), heard.speed) < 0.0;
  if (!predicted_unstable && amplitude > 0.0 && amplitude <= std::max(kFallen * loudest_, kTolerated * tolerated_)) {
    if (amplitude <= kFallen * loudest_) tolerated_ = std::max(tolerated_, amplitude);
    phase_ = Phase::holding;
    return true;
  }
  const bool falls = phase_ == Phase::acting && amplitude < kFalls * checked_;
  checked_ = amplitude;
  act_until_ns_ = in.now_ns + kLookAgain_ns;
  return falls;
}

// Nothing was tried, as nobody follows a shadow; but a frequency that has drifted asks for another speed.
void Compensator::retarget_shadow(const CompensatorInputs& in, OutputQueue& out) noexcept {
  act_until_ns_ = in.now_ns + kShadowAct_ns;
  const Candidate next = next_candidate(situation(in), attempts_, settings_.limits);
  const bool same_kind = next.kind == CorrectionKind::spindle_speed && candidate_.kind == next.kind;
  const double change = std::abs(next.setting.speed - candidate_.setting.speed);
  if (same_kind && change > kShadowRetarget * candidate_.setting.speed) start(in, next, out);
}

CutPlace Compensator::place(const CompensatorInputs& in) const noexcept {
  const CutSetting program = programmed(in);
  CutPlace place;
  if (in.robot != nullptr) {
    place.joints = in.robot->joint_position;
    place.tcp = in.robot->tcp_position;
  }
  place.programmed_speed = program.speed;
  place.feed_direction = program.feed_direction;
  place.axial_depth = in.axial_depth;
  return place;
}

void Compensator::remember(const CompensatorInputs& in) noexcept {
  if (remembered_ || settings_.mode != RuntimeMode::active || candidate_.kind != CorrectionKind::spindle_speed) return;
  remembered_ = true;
  CutPlace there = place(in);
  there.axial_depth = chatter_depth_;
  memory_.keep({there, candidate_.setting});
}

// It was tried and did not help: not again at this depth, nor, if it is what worked here before, the next time.
void Compensator::give_up_candidate(const CompensatorInputs& in) noexcept {
  attempts_.add(candidate_, in.axial_depth);
  if (remembered_) memory_.forget(place(in), candidate_.setting.speed);
}

std::int64_t Compensator::time_to_act_ns(const CompensatorInputs& in) const noexcept {
  if (settings_.mode == RuntimeMode::shadow) return kShadowAct_ns;
  double s = motion_.arrives_at() - motion_time(in.now_ns) + kLasts_s +
             kLastsTimeConstants * settings_.limits.spindle_time_constant_s;
  const double most = tool_chatters(in) ? kMostSettling_s : kMostSettlingOfStructure_s;
  s += std::min(candidate_.setting.variation_hz > 0.0 ? 0.0 : candidate_.settle_s, most);
  if (candidate_.setting.variation_hz > 0.0) s += kSwingsToAct / candidate_.setting.variation_hz;
  return to_ns(s);
}

}  // namespace stillcut
