// The core: monitor, prediction and compensator put together, as a function of what arrives. The live loop and playback
// both drive exactly this, frame by frame in the order of their stamps, so a recording gives the live run's decisions
// again bit for bit. It holds no clock, no socket, no thread; after construction it allocates, locks and throws
// nothing.
//
// Order of calls for each CAN frame: accept_frame(stamp); if it says true, add_samples / add_speed for what the frame
// held; then read outputs() and clear_outputs(). Robot messages go in when their stamp's turn has come. In silence the
// live loop calls advance(now) instead, with a `now` that no later frame can undercut.
#pragma once

#include <array>
#include <cstdint>

#include "dsp/monitor.hpp"
#include "models/lobe_diagram.hpp"
#include "rt/compensator.hpp"
#include "rt/output_queue.hpp"
#include "rt/signals.hpp"

namespace stillcut {

struct CoreSettings {
  MonitorSettings monitor;
  CompensatorSettings compensator;
  double axial_depth = 0.0;     // m, nominal; a robot state overrides it
  double feed_direction = 0.0;  // rad, nominal
  double nominal_speed = 0.0;   // rad/s, nominal
};

struct CoreCounters {
  std::int64_t frames = 0;       // accepted
  std::int64_t frames_lost = 0;  // told by counters
  std::int64_t frames_out_of_order = 0;
};

class Core {
 public:
  explicit Core(const CoreSettings& settings);

  // Told of filter, transform and decide; before the first frame.
  void set_probe(const StageProbe& probe) noexcept { monitor_.set_probe(probe); }

  // A frame's stamp comes first. False: it went back in time; the frame is to be dropped (a fault event says so).
  bool accept_frame(std::int64_t stamp_ns) noexcept;
  void add_samples(const SampleBlock& block) noexcept;
  void add_speed(const SpindleReading& reading) noexcept;
  void add_robot_state(const RobotState& state) noexcept;
  void add_ack(const CorrectionAck& ack) noexcept { compensator_.acknowledge(ack); }
  void add_timing(const LoopTiming& timing) noexcept;
  // The controller's own report of trouble on the bus: an error frame's identifier and second data byte
  // (linux/can/error.h).
  void add_bus_error(std::uint32_t id, std::uint8_t controller) noexcept;
  // Comes into use when data time reaches its usable_from_ns; until then up to 16 wait, in the order they came.
  void add_lobes(const LobeDiagram& diagram) noexcept;
  // Data time has come this far without a frame. One long step says what many short ones would;
  // only of a silence of more than five seconds it leaves the status messages of the beginning out.
  void advance(std::int64_t now_ns) noexcept;

  [[nodiscard]] std::span<const Output> outputs() const noexcept { return outputs_.items(); }
  void clear_outputs() noexcept { outputs_.clear(); }

  [[nodiscard]] const MonitorView& view() const noexcept { return monitor_.view(); }
  [[nodiscard]] const CoreCounters& counters() const noexcept { return counters_; }
  [[nodiscard]] std::int64_t origin_ns() const noexcept { return origin_ns_; }
  [[nodiscard]] std::int64_t now_ns() const noexcept { return now_ns_; }  // data time; 0 before the first frame
  // As the robot says, else as the cell file: m.
  [[nodiscard]] double axial_depth() const noexcept;
  [[nodiscard]] double feed_direction() const noexcept;  // rad, the same way
  // a_lim / a - 1 at the present posture, speed and depth; NaN unknown.
  [[nodiscard]] double predicted_margin() const noexcept;
  [[nodiscard]] RuntimeMode mode() const noexcept { return settings_.compensator.mode; }
  // The newest state; nullptr when none was heard yet.
  [[nodiscard]] const RobotState* robot() const noexcept { return robot_heard_ ? &robot_ : nullptr; }
  // The diagram in use; nullptr when there is none that fits the posture.
  [[nodiscard]] const LobeDiagram* lobes() const noexcept;
  // That along the announced path; nullptr when none is announced, or it has been travelled.
  [[nodiscard]] const LobeDiagram* lobes_ahead() const noexcept;

 private:
  void step_to(std::int64_t now_ns) noexcept;
  void decide(std::int64_t stamp_ns) noexcept;
  void collect_events() noexcept;
  void adopt_lobes(std::int64_t now_ns) noexcept;
  [[nodiscard]] LobeDiagram& waiting_lobes(std::size_t place) noexcept {
    return next_lobes_[(first_lobes_ + place) % next_lobes_.size()];
  }
  void put_status(std::int64_t now_ns) noexcept;
  void update_prior() noexcept;
  [[nodiscard]] double coming_depth() const noexcept;

  CoreSettings settings_;
  Monitor monitor_;
  Compensator compensator_;
  OutputQueue outputs_;
  CoreCounters counters_;
  LobeDiagram lobes_;                     // the newest that may be used
  LobeDiagram lobes_ahead_, next_ahead_;  // along the announced path; the one whose time has yet to come
  bool has_next_ahead_ = false;
  std::array<LobeDiagram, 16> next_lobes_{};  // those whose time has yet to come, round and round from first_lobes_
  std::size_t first_lobes_ = 0, next_lobes_count_ = 0;
  double prior_margin_ = 0.0;  // that the monitor was last told; NaN unknown
  RobotState robot_;
  double depth_rate_ = 0.0;  // m/s, as the robot's states tell
  bool started_ = false;     // by the first frame
  bool robot_heard_ = false;
  bool out_of_order_told_ = false;
  bool in_time_ = true;
  std::uint32_t bus_errors_told_ = 0;  // kinds of bus trouble told since the bus was last well
  std::int64_t origin_ns_ = 0, now_ns_ = 0, decided_ns_ = 0, next_status_ns_ = 0;
};

}  // namespace stillcut
