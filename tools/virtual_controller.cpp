#include "tools/virtual_controller.hpp"

#include <algorithm>
#include <cmath>

namespace stillcut {
namespace {

constexpr double kSameSpeed = 1e-9;                // relative
constexpr double kHighestOverride = 2.0;           // of a feed
constexpr double kHighestVariation = 0.5;          // of the mean speed
constexpr double kFastestVariation_hz = 20.0;      // a spindle follows none of that speed
constexpr double kFarTurn = 0.01, kFarFeed = 0.1;  // rad, of the programmed feed: beyond, the drives run at their rates

// Speed and variation of speed are told a speed in any case; other kinds may leave the programmed one (0, or no
// number).
bool names_speed(const Correction& c) {
  return c.kind == CorrectionKind::spindle_speed || c.kind == CorrectionKind::speed_variation ||
         (!std::isnan(c.spindle_speed_rpm) && c.spindle_speed_rpm != 0.0);
}

bool same_variation(const Correction& a, const Correction& b) {
  return a.kind == CorrectionKind::speed_variation && b.kind == a.kind &&
         a.speed_variation_ratio == b.speed_variation_ratio && a.speed_variation_hz == b.speed_variation_hz;
}

// With a ratio of 0 the speed is constant, whatever the frequency.
bool can_vary(const Correction& c) {
  const double ratio = c.speed_variation_ratio, hz = c.speed_variation_hz;
  return ratio == 0.0 || (ratio > 0.0 && ratio <= kHighestVariation && hz > 0.0 && hz <= kFastestVariation_hz);
}

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
  if (std::find(script_.accepts.begin(), script_.accepts.end(), c.kind) == script_.accepts.end())
    return "cannot do this kind of correction";
  if (c.kind == CorrectionKind::stop_request) return {};  // whatever else it says
  const double speed = rpm_to_rad_s(c.spindle_speed_rpm);
  if (names_speed(c) &&
      !(speed >= limits_.min_speed * (1.0 - kSameSpeed) && speed <= limits_.max_speed * (1.0 + kSameSpeed)))
    return "speed is outside the spindle";
  if (!(c.feed_override > 0.0 && c.feed_override <= kHighestOverride)) return "feed override is out of range";
  if (c.kind == CorrectionKind::speed_variation && !can_vary(c)) return "speed variation is out of range";
  if (c.kind == CorrectionKind::feed_direction && !std::isfinite(c.feed_direction))
    return "feed direction is out of range";
  return {};
}

void VirtualController::take(const Heard& heard, double time) {
  const Correction& c = heard.correction;
  if (c.kind == CorrectionKind::release) return correction_.reset();
  stopped_ = stopped_ || c.kind == CorrectionKind::stop_request;
  if (!correction_ || !same_variation(*correction_, c)) variation_began_ = time;
  correction_ = c;
  expires_ = heard.expires;
}

// Only an active correction is to be followed, and none that is older than one already seen. A monitor that was started
// anew counts from the beginning again: it is heard once nothing of the one before is in force.
void VirtualController::act_on(const Heard& heard, double time, const RobotState& program) {
  const Correction& c = heard.correction;
  const bool of_another_monitor = !correction_ && c.sequence < last_sequence_ && c.stamp_ns > last_stamp_ns_;
  if (c.mode != RuntimeMode::active || (c.sequence <= last_sequence_ && !of_another_monitor)) return;
  last_sequence_ = c.sequence;
  last_stamp_ns_ = c.stamp_ns;
  const std::string_view reason = reason_to_refuse(heard, time);
  if (reason.empty()) {
    take(heard, time);
  } else {
    ++refused_;
  }
  if (has(ControllerFaultKind::mute, time)) return;
  CorrectionAck ack;
  ack.stamp_ns = stamp(time);
  ack.sequence = c.sequence;
  ack.accepted = reason.empty();
  ack.spindle_speed_rpm = rad_s_to_rpm(mean_speed(program));
  ack.feed_override = feed_asked();
  ack.reason = short_text(reason);
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
  state.feed_rate *= feed_;
  state.feed_direction += turn_;
  said_.push_back({state, {}});
}

// What the spindle is told, about which it may vary.
double VirtualController::mean_speed(const RobotState& program) const {
  const bool corrected = correction_ && names_speed(*correction_);
  const double speed = rpm_to_rad_s(corrected ? correction_->spindle_speed_rpm : program.spindle_speed_rpm);
  return corrected ? std::clamp(speed, limits_.min_speed, limits_.max_speed) : speed;
}

double VirtualController::feed_asked() const {
  if (stopped_) return 0.0;
  return correction_ ? correction_->feed_override : 1.0;
}

void VirtualController::move_drives(double time, const RobotState& program) {
  const double step = time - time_;
  double setpoint = mean_speed(program);
  if (correction_ && correction_->kind == CorrectionKind::speed_variation) {
    const double swing = std::sin(kTwoPi * correction_->speed_variation_hz * (time - variation_began_));
    setpoint =
        std::clamp(setpoint * (1.0 + correction_->speed_variation_ratio * swing), limits_.min_speed, limits_.max_speed);
  }
  const double wanted = (setpoint - speed_) * -std::expm1(-step / script_.spindle_time_constant);
  const double most = script_.spindle_acceleration * step;
  speed_ += std::clamp(wanted, -most, most);

  const double feed_most = step / kFullFeedIn, feed_left = feed_asked() - feed_;
  feed_ += std::clamp(feed_left, -feed_most, feed_most);

  const bool asked = correction_ && correction_->kind == CorrectionKind::feed_direction;
  const double target = asked ? correction_->feed_direction - program.feed_direction : 0.0;
  const double left = std::remainder(target - turn_, kTwoPi), turn_most = script_.turn_rate * step;  // the short way
  feed_moves_ = std::abs(left) > kFarTurn || std::abs(feed_left) > kFarFeed;
  turn_ += std::clamp(left, -turn_most, turn_most);
}

std::span<const ControllerMessage> VirtualController::advance(double time, const RobotState& program) {
  said_.clear();
  for (; static_cast<double>(cycles_) * script_.cycle <= time; ++cycles_)
    cycle(static_cast<double>(cycles_) * script_.cycle, program);
  move_drives(time, program);
  time_ = time;
  return said_;
}

}  // namespace stillcut
