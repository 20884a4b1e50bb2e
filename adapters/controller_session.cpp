#include "adapters/controller_session.hpp"

#include <algorithm>
#include <cmath>

namespace stillcut {
namespace {

constexpr std::int64_t kSilenceEndsSession_ns = 1'000'000'000;
constexpr std::int64_t kOvertakenBy = 100;  // cycles; a counter further back is that of a new session
constexpr std::int64_t kStateEvery_ns = 10'000'000;

}  // namespace

ControllerSession::ControllerSession(const SessionSettings& settings)
    : settings_{settings}, follower_{settings.follower} {
  motion_.assume(settings.nominal_feed_direction);
}

std::optional<Answer> ControllerSession::receive(const Correction& correction, std::int64_t now_ns) {
  const bool silent = counters_.cycles == 0 || now_ns - last_cycle_ns_ > kSilenceEndsSession_ns;
  follower_.hold_back(silent ? "the controller is silent" : held_back_);
  std::optional<Answer> answer = follower_.receive(correction, now_ns);
  if (answer) answer->ack.stamp_ns = state_.stamp_ns;  // the controller's clock, as in its state
  return answer;
}

std::optional<Setpoint> ControllerSession::cycle(const ControllerReport& report, std::int64_t now_ns) {
  const std::int64_t steps = (report.counter - last_counter_) / settings_.counter_step;
  const bool anew = counters_.cycles == 0 || now_ns - last_cycle_ns_ > kSilenceEndsSession_ns || steps < -kOvertakenBy;
  if (anew) {
    ++counters_.sessions;
    motion_.forget();
    follower_.started_again();
  } else if (report.counter <= last_counter_) {
    ++counters_.old;
    return std::nullopt;
  } else {
    counters_.lost += std::max<std::int64_t>(steps - 1, 0);
  }
  ++counters_.cycles;
  last_counter_ = report.counter;
  last_cycle_ns_ = now_ns;
  motion_.add(report.clock_us, report.position);

  state_.stamp_ns = report.clock_us * 1000;
  state_.joint_position = report.joints;
  state_.tcp_position = report.position;
  state_.tool_orientation = report.orientation;
  state_.feed_direction = motion_.direction();
  state_.feed_rate = motion_.rate_m_per_s();
  state_.spindle_speed_rpm =
      std::isnan(report.spindle_speed_rpm) ? settings_.nominal_speed_rpm : report.spindle_speed_rpm;
  state_.axial_depth = state_.radial_depth = std::nan("");  // no controller knows them: the cell's nominal holds
  state_.block = report.block;
  follower_.hold_back(held_back_);
  return follower_.cycle(now_ns, {state_.spindle_speed_rpm, state_.feed_rate, state_.feed_direction});
}

std::optional<RobotState> ControllerSession::state_due(std::int64_t now_ns) {
  if (now_ns < next_state_ns_) return std::nullopt;
  // Half a cycle of allowance: packets do not come at exact times.
  next_state_ns_ = now_ns + kStateEvery_ns - std::min(settings_.cycle_ns / 2, kStateEvery_ns / 2);
  return state_;
}

}  // namespace stillcut
