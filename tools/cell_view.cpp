#include "tools/cell_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "drivers/can/can_bus.hpp"
#include "tools/spoken.hpp"

namespace stillcut {
namespace {

constexpr double kSilentIsGone_s = 1.5;
constexpr std::int64_t kFaultShown_ns = 3'000'000'000;
// How far an event may be stamped after the newest report; more: it is of a daemon before the clock was set back.
constexpr std::int64_t kAhead_ns = 1'000'000'000;
constexpr double kWatchIndicator = 0.5;
constexpr std::int64_t kWatchHeld_ns = 1'000'000'000;
constexpr std::size_t kMostSpectra = kMaxSensors;

template <class... Values>
std::string phrase(const char* format, Values... values) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

double seconds_between(std::int64_t from_ns, std::int64_t to_ns) { return static_cast<double>(to_ns - from_ns) * 1e-9; }

std::string joined(const std::vector<std::string>& parts) {
  std::string all;
  for (const std::string& part : parts) all += (all.empty() ? "" : ", ") + part;
  return all;
}

// Setpoints of one move follow each other; what an onlooker counts is that something else is asked for.
bool begins_something(const Correction& correction, const Correction& before) {
  return correction.kind != before.kind || correction.limited_by != before.limited_by ||
         std::abs(correction.spindle_speed_target_rpm - before.spindle_speed_target_rpm) > 0.5 ||
         std::abs(correction.feed_direction - before.feed_direction) > 1e-3 ||
         std::abs(correction.speed_variation_ratio - before.speed_variation_ratio) > 1e-3;
}

// What the controller is asked for.
std::string asked_sentence(const Correction& correction) {
  if (correction.kind == CorrectionKind::spindle_speed)
    return phrase("spindle speed to %.0f rpm", correction.spindle_speed_target_rpm);
  return std::string(text_of(correction.reason));
}

std::string depth_sentence(const MonitorReport& monitor) {
  const double depth_mm = 1e3 * monitor.axial_depth, limit_mm = 1e3 * monitor.depth_limit;
  if (std::isinf(limit_mm)) return phrase("%.2f mm deep, no limit predicted at this speed", depth_mm);
  if (std::isnan(limit_mm)) return "no limit is predicted for this posture and speed";
  return phrase("%.2f mm deep, predicted limit %.2f mm", depth_mm, limit_mm);
}

}  // namespace

const char* shown_name(Shown shown) noexcept {
  static constexpr std::array kNames{"no daemon", "not cutting", "stable",      "watch",
                                     "chatter",   "correcting",  "cannot tell", "fault"};
  return kNames[static_cast<std::size_t>(shown)];
}

std::string chatter_sentence(const MonitorReport& monitor) {
  std::string text = monitor.kind == ChatterKind::unknown ? "chatter of a kind not yet known"
                                                          : std::string(chatter_name(monitor.kind)) + " chatter";
  if (std::isfinite(monitor.chatter_frequency_hz)) text += phrase(" at %.1f Hz", monitor.chatter_frequency_hz);
  if (monitor.chatter_mode > 0)
    text += phrase(", nearest mode %d (%.1f Hz)", monitor.chatter_mode, monitor.chatter_mode_hz);
  return text;
}

void CellView::take(const TelemetryMessage& message, std::int64_t received_ns) {
  heard_ns_ = received_ns;
  std::visit([this](const auto& m) { take_one(m); }, message);
}

// A daemon without telemetry says at least this much.
void CellView::take_one(const Status& status) {
  if (report_heard_ns_ && seconds_between(*report_heard_ns_, *heard_ns_) <= kSilentIsGone_s) return;
  monitor_heard_ns_ = heard_ns_;
  MonitorReport report;
  report.stamp_ns = status.stamp_ns;
  report.state = status.state;
  report.mode = status.mode;
  report.chatter = status.state == State::chatter;
  report.indicator = status.indicator;
  report.spindle_speed_rpm = status.spindle_speed_rpm;
  report.margin = status.margin;
  report.chatter_frequency_hz = status.chatter_frequency_hz;
  monitor_ = report;
}

void CellView::take_one(const MonitorReport& report) {
  report_heard_ns_ = monitor_heard_ns_ = heard_ns_;
  monitor_ = report;
  if (report.indicator >= kWatchIndicator) near_limit_ns_ = report.stamp_ns;
}

void CellView::take_one(const LatencyReport& report) {
  if (!latency_ || report.ticks != latency_->ticks) ticked_ns_ = heard_ns_;
  latency_ = report;
}

void CellView::take_one(const SpectrumReport& report) {
  if (spectra_.size() < kMostSpectra || spectra_.contains(report.sensor)) spectra_[report.sensor] = report;
}

void CellView::take_one(const Event& event) {
  ++event_counts_[static_cast<std::size_t>(event.type) % event_counts_.size()];
  events_.push_back(event);
  if (events_.size() > kEventsKept) events_.pop_front();
}

void CellView::take_one(const Correction& correction) {
  if (!correction_ || begins_something(correction, *correction_)) {
    corrections_.push_back(correction);
    if (corrections_.size() > kCorrectionsKept) corrections_.pop_front();
  }
  correction_ = correction;
}

std::int64_t CellView::events_heard(EventType type) const {
  return event_counts_[static_cast<std::size_t>(type) % event_counts_.size()];
}

double CellView::silent_s(std::int64_t now_ns) const {
  return heard_ns_ ? seconds_between(*heard_ns_, now_ns) : kInfinity;
}

const Correction* CellView::asked() const {
  if (!correction_ || correction_->kind == CorrectionKind::release || !monitor_) return nullptr;
  const std::int64_t age_ns = monitor_->stamp_ns - correction_->stamp_ns;
  const bool valid = age_ns <= std::int64_t{correction_->valid_for_ms} * 1'000'000;
  return valid && age_ns > -kAhead_ns ? &*correction_ : nullptr;
}

// What is behind all that the monitor may doubt.
std::optional<ShownState> CellView::nothing_comes(std::int64_t now_ns) const {
  if (const double silent = seconds_between(*monitor_heard_ns_, now_ns); silent > kSilentIsGone_s) {
    const bool ticks = ticked_ns_ && seconds_between(*ticked_ns_, now_ns) <= kSilentIsGone_s;
    if (ticks) return ShownState{Shown::cannot_tell, "the daemon runs and tells nothing of the cut; see its log"};
    return ShownState{Shown::fault, phrase("the daemon lives, its loop stands still for %.0f s; see its log", silent)};
  }
  if (health_ && health_->bus_state == static_cast<int>(BusState::down))
    return ShownState{Shown::fault, "the CAN interface is down; see 'stillcut doctor'"};
  if (health_ && health_->bus_state == static_cast<int>(BusState::gone))
    return ShownState{Shown::fault, "the CAN interface is gone; see 'stillcut doctor'"};
  return {};
}

std::string CellView::why_fault() const {
  if (latency_ && !latency_->in_time) return "the loop cannot keep time; see 'stillcut doctor'";
  if (events_.empty() || events_.back().type != EventType::fault || !monitor_) return {};
  const std::int64_t age_ns = monitor_->stamp_ns - events_.back().stamp_ns;
  const bool fresh = age_ns < kFaultShown_ns && age_ns > -kAhead_ns;
  return std::string(fresh ? text_of(events_.back().note) : std::string_view{});
}

ShownState CellView::state(std::int64_t now_ns) const {
  const double silent = silent_s(now_ns);
  if (silent > kSilentIsGone_s || !monitor_)
    return {Shown::no_daemon, std::isinf(silent) ? "nothing was heard of a daemon yet; start it: stillcutd CELL"
                                                 : phrase("nothing was heard of the daemon for %.0f s", silent)};
  if (std::optional<ShownState> nothing = nothing_comes(now_ns)) return *std::move(nothing);
  if (monitor_->doubts != 0) return {Shown::cannot_tell, joined(doubt_names(monitor_->doubts))};
  if (std::string why = why_fault(); !why.empty()) return {Shown::fault, std::move(why)};
  if (health_ && health_->frames == 0) return {Shown::cannot_tell, "no CAN frame was heard yet; see 'stillcut doctor'"};
  if (const Correction* now = asked(); now != nullptr && now->mode == RuntimeMode::active) {
    return {Shown::correcting, asked_sentence(*now) + (monitor_->chatter ? ", against " + chatter_sentence(*monitor_)
                                                                         : ", the chatter is over")};
  }
  if (monitor_->chatter) return {Shown::chatter, chatter_sentence(*monitor_)};
  return in_the_cut();
}

ShownState CellView::in_the_cut() const {
  switch (monitor_->state) {
    case State::idle:
      return {Shown::not_cutting, "the spindle stands or nothing is heard of it"};
    case State::air:
      return {Shown::not_cutting, "the tool turns in air"};
    case State::cannot_tell:
    case State::fault:
      return {Shown::cannot_tell, "the monitor cannot tell yet"};
    case State::entry:
    case State::cut:
    case State::exit:
    case State::chatter:
      break;
  }
  // Held for a while: people read it, and the indicator moves with every hop.
  const std::int64_t since_near_ns = near_limit_ns_ ? monitor_->stamp_ns - *near_limit_ns_ : kWatchHeld_ns;
  if (since_near_ns >= 0 && since_near_ns < kWatchHeld_ns)
    return {Shown::watch, "the indicator comes near the alarm limit; " + depth_sentence(*monitor_)};
  if (monitor_->margin < 0.0) return {Shown::watch, "deeper than the lobes allow: " + depth_sentence(*monitor_)};
  return {Shown::stable, depth_sentence(*monitor_)};
}

}  // namespace stillcut
