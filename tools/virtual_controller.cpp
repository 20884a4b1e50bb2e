#include "tools/virtual_controller.hpp"

#include <algorithm>
#include <cmath>

namespace stillcut {
namespace {

constexpr double kSameSpeed = 1e-9;       // relative
constexpr double kHighestOverride = 2.0;  // of a feed

}  // namespace

VirtualController::VirtualController(ControllerScript script, const SpindleLimits& limits, double speed,
                                     std::int64_t origin_ns)
    : script_{std::move(script)}, limits_{limits}, origin_ns_{origin_ns}, speed_{speed} {
  if (!(script_.spindle_acceleration > 0.0)) script_.spindle_acceleration = limits.acceleration;
}

std::int64_t VirtualController::stamp(double time) const {
  return origin_ns_ + 1000 * static_cast<std::int64_t>(std::llround(time * 1e6));
}

bool VirtualController::has(ControllerFaultKind kind, double time) const {
  return std::any_of(script_.faults.begin(), script_.faults.end(),
                     [&](const ControllerFault& fault) { return fault.kind == kind && fault.span.contains(time); });
}

void VirtualController::receive(const Correction& correction, double time) {
  if (has(ControllerFaultKind::silent, time)) return;
  inbox_.push_back({correction, time + script_.lag, time + 1e-3 * correction.valid_for_ms});
}

std::string_view VirtualController::reason_to_refuse(const Heard& heard, double time) const {
  const Correction& c = heard.correction;
  if (has(ControllerFaultKind::refuses, time)) return "corrections are locked";
  if (time > heard.expires) return "too late";
  if (c.kind == CorrectionKind::release) return {};
  if (c.kind != CorrectionKind::spindle_speed) return "cannot do this kind of correction";
  const double speed = rpm_to_rad_s(c.spindle_speed_rpm);
  if (!(speed >= limits_.min_speed * (1.0 - kSameSpeed) && speed <= limits_.max_speed * (1.0 + kSameSpeed)))
    return "speed is outside the spindle";
  if (!(c.feed_override > 0.0 && c.feed_override <= kHighestOverride)) return "feed override is out of range";
  return {};
}

// Only an active correction is to be followed, and none that is older than one already seen.
void VirtualController::act_on(const Heard& heard, double time, const RobotState& program) {
  const Correction& c = heard.correction;
  if (c.mode != RuntimeMode::active || c.sequence <= last_sequence_) return;
  last_sequence_ = c.sequence;
  const std::string_view reason = reason_to_refuse(heard, time);
  if (!reason.empty()) {
    ++refused_;
  } else if (c.kind == CorrectionKind::release) {
    correction_.reset();
  } else {
    correction_ = c;
    expires_ = heard.expires;
  }
  if (has(ControllerFaultKind::mute, time)) return;
  CorrectionAck ack;
  ack.stamp_ns = stamp(time);
  ack.sequence = c.sequence;
  ack.accepted = reason.empty();
  ack.spindle_speed_rpm = correction_ ? correction_->spindle_speed_rpm : program.spindle_speed_rpm;
  ack.feed_override = feed_override();
  said_.push_back({ack, reason});
}

void VirtualController::cycle(double time, const RobotState& program) {
  if (correction_ && time > expires_) correction_.reset();
  std::size_t done = 0;
  for (; done < inbox_.size() && inbox_[done].acts_from <= time; ++done) act_on(inbox_[done], time, program);
  inbox_.erase(inbox_.begin(), inbox_.begin() + static_cast<std::ptrdiff_t>(done));
  if (has(ControllerFaultKind::silent, time)) {
    said_.clear();
    return;
  }
  RobotState state = program;
  state.stamp_ns = stamp(time);
  state.feed_rate *= feed_override();
  said_.push_back({state, {}});
}

std::span<const ControllerMessage> VirtualController::advance(double time, const RobotState& program) {
  said_.clear();
  for (; static_cast<double>(cycles_) * script_.cycle <= time; ++cycles_)
    cycle(static_cast<double>(cycles_) * script_.cycle, program);
  const double step = time - time_;
  time_ = time;
  const double setpoint = rpm_to_rad_s(correction_ ? correction_->spindle_speed_rpm : program.spindle_speed_rpm);
  const double wanted = (setpoint - speed_) * -std::expm1(-step / script_.spindle_time_constant);
  const double most = script_.spindle_acceleration * step;
  speed_ += std::clamp(wanted, -most, most);
  return said_;
}

}  // namespace stillcut
