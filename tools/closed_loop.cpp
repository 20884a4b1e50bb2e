#include "tools/closed_loop.hpp"

#include <memory>

#include "tools/predictor.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kTick_ns = 1'000'000;     // as the live loop's
constexpr std::int64_t kBehind_ns = 20'000'000;  // how far a silent tick stays behind the clock, as there
constexpr std::int64_t kTicksAPoint = 10;

// The daemon without its threads.
class DataTimeMonitor {
 public:
  DataTimeMonitor(const Cell& cell, VirtualMachine& machine, const DataTimeListener& listener)
      : machine_{machine}, listener_{listener}, pipeline_{std::make_unique<Pipeline>(cell)}, predictor_{cell} {
    pipeline_->core().add_lobes(predictor_.nominal().diagram);
  }

  void hear(const ControllerMessage& said) {
    Core& core = pipeline_->core();
    if (const auto* ack = std::get_if<CorrectionAck>(&said.message)) return core.add_ack(*ack);
    const RobotState& state = std::get<RobotState>(said.message);
    core.add_robot_state(state);
    if (!pace_.due(state)) return;
    if (const auto diagram = predictor_.at(state)) core.add_lobes(*diagram);
  }

  void hear(const CanFrame& frame) {
    const bool heard = pipeline_->feed(frame);
    if (heard && listener_.on_frame) listener_.on_frame(*pipeline_);
    hand_over();
  }

  void tick(std::int64_t now_ns) {
    pipeline_->core().advance(now_ns - kBehind_ns);
    hand_over();
    if (++ticks_ % kTicksAPoint != 0) return;
    const MonitorView& view = pipeline_->core().view();
    if (view.stamp_ns == 0) return;
    trace_.push_back({static_cast<double>(view.stamp_ns - machine_.origin_ns()) * 1e-9, view.indicator,
                      rad_s_to_rpm(view.speed), view.state, view.chatter_frequency_hz});
  }

  // What was heard, with a finer trace than the status messages give.
  Heard finish() {
    if (!trace_.empty()) heard_.trace = std::move(trace_);
    return std::move(heard_);
  }

 private:
  void hand_over() {
    for (const Output& output : pipeline_->core().outputs()) {
      heard_.add(output, machine_.origin_ns());
      if (listener_.on_output) listener_.on_output(output, pipeline_->core());
      if (output.type == Output::Type::correction) machine_.receive(output.correction);
    }
    pipeline_->core().clear_outputs();
  }

  VirtualMachine& machine_;
  const DataTimeListener& listener_;
  std::unique_ptr<Pipeline> pipeline_;
  Predictor predictor_;
  PredictionPace pace_;
  Heard heard_;
  std::vector<TracePoint> trace_;
  std::int64_t ticks_ = 0;
};

}  // namespace

void Heard::add(const Output& output, std::int64_t origin_ns) {
  if (output.type == Output::Type::event) events.push_back(output.event);
  if (output.type == Output::Type::correction) corrections.push_back(output.correction);
  if (output.type != Output::Type::status) return;
  const Status& status = output.status;
  trace.push_back({static_cast<double>(status.stamp_ns - origin_ns) * 1e-9, status.indicator, status.spindle_speed_rpm,
                   status.state, status.chatter_frequency_hz});
}

Heard run_in_data_time(const Cell& cell, VirtualMachine& machine, const std::function<void(double)>& progress,
                       const DataTimeListener& listener) {
  DataTimeMonitor monitor{cell, machine, listener};
  std::int64_t next_tick_ns = machine.origin_ns() + kTick_ns;
  const double duration = machine.duration();
  while (!machine.ended()) {
    const MachineOutput sent = machine.advance();
    for (const ControllerMessage& said : sent.messages) monitor.hear(said);
    for (const CanFrame& frame : sent.frames) monitor.hear(frame);
    const std::int64_t now_ns = machine.origin_ns() + static_cast<std::int64_t>(machine.time() * 1e9);
    if (now_ns < next_tick_ns) continue;
    monitor.tick(now_ns);
    next_tick_ns += kTick_ns;
    if (progress && next_tick_ns % (100 * kTick_ns) == 0) progress(machine.time() / duration);
  }
  return monitor.finish();
}

}  // namespace stillcut
