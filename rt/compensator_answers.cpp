// What the compensator makes of the controller's answers: none, and nothing is asked any more; a kind of correction
// that it does not take is left out, and the next one asked for.
#include <algorithm>
#include <cstdio>

#include "dsp/numbers.hpp"
#include "rt/compensator.hpp"
#include "rt/watch.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kAnswerWithin_ns = 1'000'000'000;
constexpr std::int64_t kQuietAsksAnew_ns = 2'000'000'000;

const char* name_of(CorrectionKind kind) noexcept {
  switch (kind) {
    case CorrectionKind::spindle_speed:
      return "spindle speed";
    case CorrectionKind::speed_variation:
      return "speed variation";
    case CorrectionKind::feed_direction:
      return "feed direction";
    case CorrectionKind::feed_override:
      return "feed override";
    case CorrectionKind::stop_request:
      return "stop";
    case CorrectionKind::release:
      break;
  }
  return "release";
}

}  // namespace

void Compensator::acknowledge(const CorrectionAck& ack) noexcept {
  if (settings_.mode != RuntimeMode::active) return;                                  // a shadow is not answered
  if (ack.sequence < first_sequence_ || ack.sequence > last_asked_sequence_) return;  // no answer to what is asked now
  answered_ns_ = std::max(answered_ns_, ack.stamp_ns);
  if (ack.accepted) {
    attempts_.accept(asked_);
    taken_ = true;
  } else if (!attempts_.refused(asked_)) {
    attempts_.refuse(asked_);
    refusal_ = ack.reason;
    refusal_is_news_ = true;
  }
}

// Why nothing may be asked of the controller now; nullptr when all conditions hold.
const char* Compensator::reason_to_hold_back(const CompensatorInputs& in) noexcept {
  if (in.monitor->doubts != kNoDoubt && phase_ != Phase::stopped && !deafened(in)) return "the monitor cannot tell";
  if (settings_.mode != RuntimeMode::active) return nullptr;
  if (!in.in_time && phase_ != Phase::stopped) return "the loop cannot keep time";
  if (!in.controller_alive) return "controller silent";
  if (correcting() && in.now_ns - answered_ns_ > kAnswerWithin_ns) unanswered_ = true;
  // Quiet for a while: a new question.
  if (!correcting() && has_run(unheard_since_ns_, in.now_ns, kQuietAsksAnew_ns)) unanswered_ = false;
  return unanswered_ ? "controller did not answer" : nullptr;
}

// A controller that is heard, or heard again, may be another, or have been set up anew.
void Compensator::meet_controller(const CompensatorInputs& in) noexcept {
  if (in.controller_alive && !controller_met_) {
    attempts_.forget_refusals();
    refusal_ = {};
  }
  controller_met_ = in.controller_alive;
}

void Compensator::tell_refusal(const CompensatorInputs& in, OutputQueue& out) noexcept {
  if (!refusal_is_news_) return;
  refusal_is_news_ = false;
  ShortText note{};
  std::snprintf(note.data(), note.size(), "%s refused: %.70s", name_of(asked_),
                refusal_[0] == '\0' ? "no reason told" : refusal_.data());
  out.put(Event{in.monitor->stamp_ns, EventType::correction, ChatterKind::unknown, chatter_frequency_hz_,
                in.monitor->indicator, kNaN, note});
}

// What the controller has refused is not in force: the next that it may take, if chatter goes on.
void Compensator::leave_what_is_refused(const CompensatorInputs& in, OutputQueue& out) noexcept {
  if (!taken_) {  // nothing has moved since
    motion_.begin(before_);
    began_ns_ = in.now_ns;
  }
  const bool goes_on = is_heard(in) && phase_ != Phase::returning && (tool_chatters(in) || structure_chatters(in));
  if (goes_on) return ask_next(in, out);
  release(in, with_refusal("the controller refuses").data(), out);
}

// A stop is asked for until the tool is out of the part, or the controller does not take it.
void Compensator::follow_stop(const CompensatorInputs& in, OutputQueue& out) noexcept {
  const bool over = has_run(air_since_ns_, in.now_ns, kAirEndsCut_ns);
  if (over) {
    attempts_.end_cut();
    release(in, "stopped, and the cut is over", out);
  } else if (attempts_.refused(CorrectionKind::stop_request)) {
    release(in, with_refusal("the controller does not stop").data(), out);
    said_none_ = true;
  }
}

// A reason, and after it the controller's own words, if it had any.
ShortText Compensator::with_refusal(const char* reason) const noexcept {
  if (refusal_[0] == '\0') return short_text(reason);
  ShortText text{};
  std::snprintf(text.data(), text.size(), "%s: %.50s", reason, refusal_.data());
  return text;
}

}  // namespace stillcut
