#include "rt/core.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "dsp/numbers.hpp"
#include "models/lobe_diagram.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kStatusEvery_ns = 100'000'000;
constexpr std::int64_t kLongestTold_ns = 5'000'000'000;  // of a silence; longer ones are told by their last seconds
constexpr double kPriorStep = 0.1;                       // of margin, worth telling the monitor
constexpr std::int64_t kControllerSilent_ns = 500'000'000;
// A diagram computed for a posture older than this is not of the present posture (as long as states arrive).
constexpr std::int64_t kLobesTooOld_ns = 1'500'000'000;

constexpr double kDepthForgets_s = 0.1;  // of the rate at which the depth grows
constexpr double kDepthAhead_s = 1.0;

// CAN_ERR_* of linux/can/error.h
constexpr std::uint32_t kControllerTrouble = 0x04, kBusOff = 0x40, kRestarted = 0x100;
constexpr std::uint8_t kPassive = 0x30;  // receive or transmit

}  // namespace

Core::Core(const CoreSettings& settings)
    : settings_{settings}, monitor_{settings.monitor}, compensator_{settings.compensator} {}

bool Core::accept_frame(std::int64_t stamp_ns) noexcept {
  if (!started_) {
    started_ = true;
    origin_ns_ = now_ns_ = stamp_ns;
    next_status_ns_ = stamp_ns + kStatusEvery_ns;
    monitor_.set_origin(stamp_ns);
  }
  if (stamp_ns < now_ns_) {
    ++counters_.frames_out_of_order;
    if (!out_of_order_told_) {  // one fault a run of such frames
      char note[96];
      std::snprintf(note, sizeof note, "stamp goes back by %.6f s; frame dropped",
                    static_cast<double>(now_ns_ - stamp_ns) * 1e-9);
      outputs_.put(Event{now_ns_, EventType::fault, ChatterKind::unknown, kNaN, kNaN, rad_s_to_rpm(view().speed),
                         short_text(note)});
    }
    out_of_order_told_ = true;
    return false;
  }
  out_of_order_told_ = false;
  advance(stamp_ns);
  ++counters_.frames;
  return true;
}

void Core::advance(std::int64_t now_ns) noexcept {
  if (!started_ || now_ns <= now_ns_) return;
  const std::int64_t skipped_ns = std::max<std::int64_t>(0, now_ns - next_status_ns_ - kLongestTold_ns);
  next_status_ns_ += skipped_ns / kStatusEvery_ns * kStatusEvery_ns;
  for (; next_status_ns_ <= now_ns; next_status_ns_ += kStatusEvery_ns) {
    step_to(next_status_ns_);
    put_status(next_status_ns_);
  }
  step_to(now_ns);
}

void Core::step_to(std::int64_t now_ns) noexcept {
  now_ns_ = now_ns;
  adopt_lobes(now_ns);
  const std::uint32_t doubts = view().doubts;
  monitor_.advance(now_ns);
  if (view().doubts != doubts) decide(monitor_.events().empty() ? now_ns : monitor_.events().back().stamp_ns);
}

void Core::add_speed(const SpindleReading& reading) noexcept { monitor_.add_speed(reading); }

void Core::add_samples(const SampleBlock& block) noexcept {
  counters_.frames_lost += block.frames_lost;
  bus_errors_told_ &= ~kBusOff;  // samples come: it is on again
  monitor_.add_samples(block);
  decide(view().stamp_ns);  // the samples' own time: arrival jitter must not move a decision
}

// Bus-off and error-passive lose frames: told once, until the bus says that it was restarted or, after bus-off, samples
// come.
void Core::add_bus_error(std::uint32_t id, std::uint8_t controller) noexcept {
  if ((id & kRestarted) != 0) bus_errors_told_ = 0;
  const bool passive = (id & kControllerTrouble) != 0 && (controller & kPassive) != 0;
  const char* what = (id & kBusOff) != 0 ? "CAN bus-off: no frames until the controller is restarted"
                     : passive           ? "CAN controller error-passive: check wiring, termination and bit rates"
                                         : nullptr;
  const std::uint32_t kind = (id & kBusOff) != 0 ? kBusOff : kControllerTrouble;
  if (what == nullptr || (bus_errors_told_ & kind) != 0) return;
  bus_errors_told_ |= kind;
  outputs_.put(
      Event{now_ns_, EventType::fault, ChatterKind::unknown, kNaN, kNaN, rad_s_to_rpm(view().speed), short_text(what)});
}

void Core::add_timing(const LoopTiming& timing) noexcept {
  in_time_ = timing.in_time;
  if (in_time_) return;
  char note[96];
  std::snprintf(note, sizeof note, "the loop cannot keep time: stood still for %.1f ms; see 'stillcut doctor'",
                static_cast<double>(timing.longest_gap_ns) * 1e-6);
  outputs_.put(
      Event{now_ns_, EventType::fault, ChatterKind::unknown, kNaN, kNaN, rad_s_to_rpm(view().speed), short_text(note)});
  decide(now_ns_);
}

void Core::add_robot_state(const RobotState& state) noexcept {
  const double step_s = static_cast<double>(state.stamp_ns - robot_.stamp_ns) * 1e-9;
  if (robot_heard_ && step_s > 0.0 && step_s < kDepthForgets_s) {
    const double rate = (state.axial_depth - robot_.axial_depth) / step_s;
    const double share = step_s / kDepthForgets_s;
    depth_rate_ = std::isfinite(rate) ? std::lerp(depth_rate_, rate, share) : 0.0;
  } else {
    depth_rate_ = 0.0;
  }
  robot_ = state;
  robot_heard_ = true;
}

void Core::add_lobes(const LobeDiagram& diagram) noexcept {
  if (diagram.ahead) {  // the newest announcement counts; it must not keep the diagrams of the posture waiting
    next_ahead_ = diagram;
    has_next_ahead_ = true;
    return adopt_lobes(now_ns_);
  }
  // The first that came waits its turn whatever comes after it; only the newest of a full row is replaced.
  next_lobes_count_ = std::min(next_lobes_count_ + 1, next_lobes_.size());
  waiting_lobes(next_lobes_count_ - 1) = diagram;
  adopt_lobes(now_ns_);
}

void Core::adopt_lobes(std::int64_t now_ns) noexcept {
  if (has_next_ahead_ && next_ahead_.usable_from_ns <= now_ns) {
    lobes_ahead_ = next_ahead_;
    has_next_ahead_ = false;
  }
  std::size_t due = 0;
  while (due < next_lobes_count_ && waiting_lobes(due).usable_from_ns <= now_ns) ++due;
  if (due == 0) return;
  lobes_ = waiting_lobes(due - 1);
  first_lobes_ = (first_lobes_ + due) % next_lobes_.size();
  next_lobes_count_ -= due;
  update_prior();
}

// What the monitor should expect: the modes of the posture, and the margin at the present speed and depth.
void Core::update_prior() noexcept {
  prior_margin_ = predicted_margin();
  const LobeDiagram* diagram = lobes();
  std::array<ExpectedMode, LobeDiagram::kMaxModes> modes{};
  const auto count =
      static_cast<std::size_t>(diagram == nullptr ? 0 : std::clamp(diagram->mode_count, 0, LobeDiagram::kMaxModes));
  for (std::size_t m = 0; m < count; ++m) modes[m] = {diagram->modes[m].frequency_hz, diagram->modes[m].damping_ratio};
  monitor_.expect({modes.data(), count}, prior_margin_);
}

const LobeDiagram* Core::lobes() const noexcept {
  if (!lobes_.valid) return nullptr;
  const bool of_another_posture = robot_heard_ && robot_.stamp_ns - lobes_.posture_stamp_ns > kLobesTooOld_ns;
  return of_another_posture ? nullptr : &lobes_;
}

const LobeDiagram* Core::lobes_ahead() const noexcept {
  return lobes_ahead_.valid && now_ns_ < lobes_ahead_.usable_until_ns ? &lobes_ahead_ : nullptr;
}

double Core::axial_depth() const noexcept {
  return robot_heard_ && std::isfinite(robot_.axial_depth) ? robot_.axial_depth : settings_.axial_depth;
}

double Core::feed_direction() const noexcept { return robot_heard_ ? robot_.feed_direction : settings_.feed_direction; }

// The depth for which a correction is chosen: while the tool goes deeper that of a second later, up to the nominal one.
double Core::coming_depth() const noexcept {
  const double now = axial_depth();
  const double deepest = std::max(now, settings_.axial_depth);
  return depth_rate_ > 0.0 && deepest > now ? std::min(deepest, now + depth_rate_ * kDepthAhead_s) : now;
}

double Core::predicted_margin() const noexcept {
  const LobeDiagram* diagram = lobes();
  return diagram == nullptr ? kNaN : margin_at(*diagram, view().speed, axial_depth());
}

void Core::decide(std::int64_t stamp_ns) noexcept {
  const std::int64_t now_ns = decided_ns_ = std::max(decided_ns_, stamp_ns);
  collect_events();
  CompensatorInputs in;
  in.now_ns = now_ns;
  in.monitor = &view();
  in.lobes = lobes();
  in.lobes_ahead = lobes_ahead();
  in.robot = robot_heard_ ? &robot_ : nullptr;
  in.axial_depth = axial_depth();
  in.coming_depth = coming_depth();
  in.feed_direction = feed_direction();
  in.nominal_speed = robot_heard_ ? rpm_to_rad_s(robot_.spindle_speed_rpm) : settings_.nominal_speed;
  in.in_time = in_time_;
  in.controller_alive = robot_heard_ && now_ns - robot_.stamp_ns < kControllerSilent_ns;
  compensator_.step(in, outputs_);
}

void Core::collect_events() noexcept {
  for (const Event& event : monitor_.events()) outputs_.put(event);
  monitor_.clear_events();
}

void Core::put_status(std::int64_t now_ns) noexcept {
  const MonitorView& heard = view();
  Status s;
  s.stamp_ns = now_ns;
  s.state = heard.state;
  s.mode = settings_.compensator.mode;
  s.spindle_speed_rpm = rad_s_to_rpm(heard.speed);
  s.indicator = heard.indicator;
  s.margin = predicted_margin();
  s.chatter_frequency_hz = heard.chatter_frequency_hz;
  s.frames = counters_.frames;
  s.frames_lost = counters_.frames_lost;
  s.lobes_stamp_ns = lobes() == nullptr ? 0 : lobes_.posture_stamp_ns;
  outputs_.put(s);
  const bool moved =
      std::isnan(s.margin) != std::isnan(prior_margin_) || std::abs(s.margin - prior_margin_) > kPriorStep;
  if (moved) update_prior();
}

}  // namespace stillcut
