// All threads of the daemon as it runs, for the thread sanitizer: loop, publisher, recorder, model and subscriber in
// real time, with a sensor on a local bus and a robot that moves on an LCM network in the process.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <thread>

#include "drivers/can/can_bus.hpp"
#include "drivers/lcm/monitor_listener.hpp"
#include "drivers/lcm/publisher.hpp"
#include "tests/simulated_cut.hpp"
#include "tests/stress/stress_time.hpp"
#include "tools/live_loop.hpp"
#include "tools/live_run.hpp"

namespace stillcut {
namespace {

using test::stress;

constexpr double kQuarter = 0.5 * std::numbers::pi;

TEST(LiveRunStress, TheWholeDaemon) {
  Cell cell = demo_cell();
  cell.mode = RuntimeMode::active;
  cell.can->accelerometers.front().sample_rate_hz = 5120;  // the sanitizer makes everything many times slower
  const std::vector<CanFrame> cut =
      simulate_cut(cell, {{0.0, 0.0}, {0.1, 0.0}, {0.2, 3.8e-3}, {0.9, 3.8e-3}, {0.95, 0.0}}, 1.0);
  const std::string bus_name = "local:stillcut-stress-" + std::to_string(getpid());
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("stillcut-stress-run-" + std::to_string(getpid()));
  const LcmConnection lcm = open_lcm("memq://");
  const std::unique_ptr<CanBus> bus = open_can_bus(bus_name);
  Publisher robot{lcm};
  std::atomic<std::int64_t> asked{0};
  const MonitorListener listener{
      lcm,
      {.on_correction = [&](const Correction& c) { asked.store(c.sequence); }, .on_event = {}},
      MonitorListener::Thread::none};
  LiveRunOptions options;
  options.record = folder;
  options.allow_not_real_time = true;
  LiveRun run{cell, bus_name, lcm, options};

  std::atomic<bool> done{false};
  std::thread sensor{[&] {
    for (std::size_t i = 0; !done.load(); i = (i + 1) % cut.size()) {
      (void)bus->send(cut[i]);
      if (i % 4 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(6));
    }
  }};
  std::thread arm{[&] {
    for (int i = 0; !done.load(); ++i) {
      RobotState state{.stamp_ns = realtime_ns(),
                       .spindle_speed_rpm = 8500.0,
                       .axial_depth = 3.8e-3,
                       .radial_depth = 10e-3,
                       .milling = Milling::down};
      state.joint_position = {0.1 * std::sin(0.01 * i), -kQuarter, kQuarter, 0.0, kQuarter, 0.0};  // about home
      RobotPath path{.stamp_ns = state.stamp_ns, .count = 1};
      path.points[0].joint_position = state.joint_position;
      (void)robot.publish(state);
      if (i % 50 == 0) (void)robot.publish(path);
      (void)robot.publish(CorrectionAck{.stamp_ns = state.stamp_ns, .sequence = asked.load(), .accepted = true});
      std::this_thread::sleep_for(std::chrono::milliseconds(8));
    }
  }};
  int marks = 0;
  stress([&] {
    if (run.ticks() > 0 && ++marks % 100 == 0) run.mark("operator");
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  });
  done.store(true);
  sensor.join();
  arm.join();
  run.stop();
  const auto summary = run.summary();
  std::printf("%s\n", summary.dump().c_str());
  std::filesystem::remove_all(folder);
  EXPECT_GT(summary["frames"], 0);
  EXPECT_GT(summary["recorded_frames"], 0);
  EXPECT_GT(summary["published"], 0);
  EXPECT_GT(summary["corrections"], 0);
}

}  // namespace
}  // namespace stillcut
