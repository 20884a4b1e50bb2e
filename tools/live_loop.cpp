#include "tools/live_loop.hpp"

#include <algorithm>
#include <ctime>
#include <utility>

namespace stillcut {
namespace {

// How far behind the clock a silent tick moves data time: a frame stamped before that has long been in the socket, so
// no frame can still come from a time that was declared silent.
constexpr std::int64_t kBehindClock_ns = 20'000'000;
constexpr std::int64_t kMicrosecond_ns = 1000;
constexpr std::int64_t kClockStep_ns = 1'000'000'000;  // no frame is held up this long: the clock was set back
// Frames a tick takes at most, so that a flood delays one tick and not the thread for good.
constexpr int kBatchesATick = 32;

}  // namespace

std::int64_t realtime_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

bool LiveLoop::tick(std::int64_t awake_ns) noexcept {
  StageTimes& stages = channels_.times.stages;
  stages.begin_tick();
  const std::int64_t before_ns = clock_();
  if (channels_.lobes.update()) take_lobes(channels_.lobes.value());
  if (channels_.ahead.update()) take_lobes(channels_.ahead.value());
  drain_bus();
  if (live_clock_ && drained_) {
    declared_ns_ =
        std::max(declared_ns_, (before_ns + clock_shift_ns_ - kBehindClock_ns) / kSilentStep_ns * kSilentStep_ns);
    feed_messages_until(declared_ns_);
    feed_silence();
    hand_over();
  }
  if (live_clock_) keep_time(awake_ns);
  if (watched_) show();
  stages.end_tick();
  return bus_.state() != BusState::ended;
}

void LiveLoop::drain_bus() noexcept {
  StageTimes& stages = channels_.times.stages;
  drained_ = false;
  for (int batch = 0; batch < kBatchesATick && !drained_; ++batch) {
    stages.begin(Stage::receive);
    const std::size_t count = bus_.receive(batch_);
    drained_ = count < batch_.size();
    for (std::size_t i = 0; i < count; ++i) {
      const std::int64_t received_ns = batch_[i].stamp_ns;
      place_in_time(batch_[i]);
      feed_messages_until(batch_[i].stamp_ns);
      feed(batch_[i]);
      if (hand_over() && live_clock_) channels_.times.decision.record(clock_() - received_ns);
    }
  }
}

// A loop that is out of time only listens. Its word takes the next microsecond of data time, as a late message does.
void LiveLoop::keep_time(std::int64_t awake_ns) noexcept {
  if (!timekeeper_.tick(awake_ns)) return;
  LoopTimes& times = channels_.times;
  times.in_time.store(timekeeper_.in_time(), std::memory_order_relaxed);
  if (!timekeeper_.in_time())  // one writer: no locked add needed
    times.times_out.store(times.times_out.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  if (!must_keep_time_) return;
  timing_.in_time = timekeeper_.in_time();
  timing_.longest_gap_ns = timekeeper_.longest_gap_ns();
  has_timing_ = true;
}

// A frame from a time that was already declared silent (the machine stood still between stamp and socket) counts as of
// the end of that silence: dropping it would be a decision that the recording cannot repeat. A frame from much earlier
// means that the host's clock was set back: the core drops it and says so, and data time goes on from where it was.
void LiveLoop::place_in_time(CanFrame& frame) noexcept {
  frame.stamp_ns += clock_shift_ns_;
  const std::int64_t late_ns = declared_ns_ - frame.stamp_ns;
  if (late_ns >= kClockStep_ns) {
    clock_shift_ns_ += late_ns;
  } else if (late_ns > 0) {
    frame.stamp_ns = declared_ns_;
  }
}

// Frames lie before and after a message by their stamps alone, in the recording too. A message that comes when data
// time has passed its stamp counts as of the next microsecond, so that playback finds it the same place.
void LiveLoop::place_in_time(RobotMessage& message) const noexcept {
  std::visit([&](auto& m) { m.stamp_ns = std::max(m.stamp_ns + clock_shift_ns_, fed_ns_ + kMicrosecond_ns); }, message);
}

// A diagram that comes too late (the model thread was busy) comes into use in the next microsecond. Whole microseconds:
// more a recording does not hold.
void LiveLoop::take_lobes(const LobesAnswer& answer) noexcept {
  LobeDiagram diagram = answer.diagram;
  diagram.usable_from_ns = std::max(diagram.usable_from_ns + clock_shift_ns_, fed_ns_ + kMicrosecond_ns);
  if (diagram.posture_stamp_ns != 0) diagram.posture_stamp_ns += clock_shift_ns_;
  if (diagram.usable_until_ns != 0)
    diagram.usable_until_ns = (diagram.usable_until_ns + clock_shift_ns_) / kMicrosecond_ns * kMicrosecond_ns;
  pipeline_.core().add_lobes(diagram);
  record(LobesUsed{fed_ns_ + kMicrosecond_ns, diagram.posture_stamp_ns, diagram.usable_from_ns, diagram.usable_until_ns,
                   diagram.ahead, answer.question});
}

void LiveLoop::feed_messages_until(std::int64_t stamp_ns) noexcept {
  // Before the first frame there is no time.
  if (has_timing_ && frame_fed_ && fed_ns_ + kMicrosecond_ns <= stamp_ns) {
    timing_.stamp_ns = fed_ns_ + kMicrosecond_ns;
    pipeline_.core().add_timing(timing_);
    record(timing_);
    has_timing_ = false;
  }
  for (;;) {
    if (!has_waiting_) {
      if (!channels_.messages.pop(waiting_)) return;
      place_in_time(waiting_);
      has_waiting_ = true;
    }
    if (const auto* state = std::get_if<RobotState>(&waiting_)) {
      if (state->stamp_ns > stamp_ns) return;
      pipeline_.core().add_robot_state(*state);
      record(*state);
    } else if (const auto* ack = std::get_if<CorrectionAck>(&waiting_)) {
      if (ack->stamp_ns > stamp_ns) return;
      pipeline_.core().add_ack(*ack);
      record(*ack);
    }
    has_waiting_ = false;
  }
}

void LiveLoop::feed(const CanFrame& frame) noexcept {
  pipeline_.feed(frame);
  fed_ns_ = std::max(fed_ns_, frame.stamp_ns);
  frame_fed_ = true;
  record(frame);
  if (watched_) (void)channels_.watched.push(frame);  // a full ring is counted by the ring
}

// Every five milliseconds, and at once when something was decided.
void LiveLoop::show() noexcept {
  constexpr int kTicksApart = 5;
  if (!std::exchange(handed_over_, false) && --ticks_to_show_ > 0) return;
  ticks_to_show_ = kTicksApart;
  channels_.view.publish(view_of(pipeline_.core(), pipeline_.decoder().counters()));
}

// Playback knows of a silence only what is recorded of it. Before the first frame there is none.
void LiveLoop::feed_silence() noexcept {
  if (declared_ns_ <= fed_ns_) return;
  pipeline_.core().advance(declared_ns_);
  if (frame_fed_) record(Silence{declared_ns_, declared_ns_});
  fed_ns_ = declared_ns_;
}

// A full ring is counted by the ring.
void LiveLoop::record(const CoreInput& input) noexcept {
  if (record_) (void)channels_.recorded.push(input);
}

bool LiveLoop::hand_over() noexcept {
  Core& core = pipeline_.core();
  if (core.outputs().empty()) return false;
  handed_over_ = true;
  channels_.times.stages.begin(Stage::hand_over);
  // Relaxed: the ring's release below orders it before the first output.
  channels_.origin_ns.store(core.origin_ns(), std::memory_order_relaxed);
  for (const Output& output : core.outputs()) (void)channels_.outputs.push(output);
  core.clear_outputs();
  return true;
}

}  // namespace stillcut
