#include "tools/plant.hpp"

#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <thread>

#include "drivers/lcm/publisher.hpp"
#include "tools/live_loop.hpp"

namespace stillcut {
namespace {

constexpr int kPlantPriority = 40;      // SCHED_FIFO
constexpr double kProgressEvery = 0.1;  // s

// For as long as the machine runs.
class RaisedPriority {
 public:
  RaisedPriority() {
    pthread_getschedparam(pthread_self(), &policy_, &before_);
    const sched_param raised{kPlantPriority};
    pthread_setschedparam(pthread_self(), SCHED_FIFO, &raised);  // refused without the right: then it goes on without
  }
  ~RaisedPriority() { pthread_setschedparam(pthread_self(), policy_, &before_); }
  RaisedPriority(const RaisedPriority&) = delete;
  RaisedPriority& operator=(const RaisedPriority&) = delete;

 private:
  int policy_ = 0;
  sched_param before_{};
};

}  // namespace

void MonitorInbox::add(const Output& output) {
  const std::lock_guard lock{mutex_};
  if (output.type == Output::Type::correction)
    corrections_.push_back(output.correction);
  else
    others_.push_back(output);
}

std::vector<Correction> MonitorInbox::take_corrections() {
  const std::lock_guard lock{mutex_};
  return std::exchange(corrections_, {});
}

Heard MonitorInbox::take_heard(std::int64_t origin_ns) {
  const std::lock_guard lock{mutex_};
  Heard heard;
  for (const Output& output : others_) heard.add(output, origin_ns);
  return heard;
}

PlantReport run_in_real_time(VirtualMachine& machine, CanBus& bus, const LcmConnection& lcm, MonitorInbox& inbox,
                             const std::function<void(double)>& progress) {
  using std::chrono::nanoseconds, std::chrono::steady_clock;
  const RaisedPriority raised;
  Publisher publisher{lcm};
  PlantReport report;
  // Counted on the clock that nobody sets.
  const steady_clock::time_point start = steady_clock::now() + nanoseconds(machine.origin_ns() - realtime_ns());
  double next_progress = 0.0;
  while (!machine.ended()) {
    const MachineOutput sent = machine.advance();
    if (sent.frames.empty() && sent.messages.empty()) continue;
    const auto due = start + nanoseconds(static_cast<std::int64_t>(machine.time() * 1e9));
    const double late_ms = std::chrono::duration<double, std::milli>(steady_clock::now() - due).count();
    report.behind_ms = std::max(report.behind_ms, late_ms);
    if (late_ms < 0.0) std::this_thread::sleep_until(due);
    for (const CanFrame& frame : sent.frames) report.unsent += bus.send(frame) ? 0 : 1;
    for (const ControllerMessage& said : sent.messages) {
      if (const auto* ack = std::get_if<CorrectionAck>(&said.message))
        publisher.publish(*ack, said.reason);
      else
        publisher.publish(std::get<RobotState>(said.message));
    }
    for (const Correction& correction : inbox.take_corrections()) machine.receive(correction);
    if (!progress || machine.time() < next_progress) continue;
    progress(machine.time() / machine.duration());
    next_progress = machine.time() + kProgressEvery;
  }
  return report;
}

}  // namespace stillcut
