// Once built, the core takes nothing from the heap; nor does the planning of moves.
#include <gtest/gtest.h>

#include "rt/synchronized_motion.hpp"
#include "tests/count_allocations.hpp"
#include "tests/rt/core_script.hpp"
#include "tests/rt/motion_cases.hpp"

namespace stillcut {
namespace {

TEST(Core, AllocatesNothingAfterConstruction) {
  const SyntheticLog log = record(chattering_cut());
  Core core{settings_of(chattering_cut(), RuntimeMode::active)};
  const LobeDiagram diagram = dated(0, 0);
  allocations = 0;
  counting = true;
  core.add_lobes(diagram);
  std::size_t next_speed = 0, outputs = 0;
  for (const SampleBlock& block : log.blocks) {
    for (; next_speed < log.speeds.size() && log.speeds[next_speed].stamp_ns <= block.stamp_ns; ++next_speed) {
      if (core.accept_frame(log.speeds[next_speed].stamp_ns)) core.add_speed(log.speeds[next_speed]);
    }
    RobotState state = state_at(block.stamp_ns);
    state.spindle_speed_rpm = 9000.0;
    core.add_robot_state(state);
    if (core.accept_frame(block.stamp_ns)) core.add_samples(block);
    for (const Output& output : core.outputs()) {
      if (output.type == Output::Type::correction)
        core.add_ack({block.stamp_ns, output.correction.sequence, true, 0, 1});
    }
    outputs += core.outputs().size();
    core.clear_outputs();
  }
  core.accept_frame(kStart);  // goes back
  core.add_bus_error(0x20000040, 0);
  core.advance(log.blocks.back().stamp_ns + 3 * kSecond);
  counting = false;
  EXPECT_EQ(allocations, 0);
  EXPECT_GT(outputs, 50U);
  EXPECT_GT(core.outputs().size(), 20U);
}

TEST(SynchronizedMotion, AllocatesNothing) {
  MotionCases cases{16};
  constexpr std::size_t kAxes = 7;
  std::vector<AxisTask> tasks;
  for (std::size_t i = 0; i < 100 * kAxes; ++i) tasks.push_back(cases.next());
  std::array<AxisTrajectory, kAxes> moves;
  double sum = 0.0;
  allocations = 0;
  counting = true;
  for (std::size_t i = 0; i < tasks.size(); i += kAxes) {
    const auto axes = std::span(tasks).subspan(i, kAxes);
    sum += plan_velocities(axes, moves, Synchronization::time).duration;
    sum += plan_positions(axes, moves, Synchronization::time).duration + moves[0].at(0.5).velocity;
    sum += plan_position(axes[0].start, axes[0].target, axes[0].limits).trajectory.duration();
  }
  counting = false;
  EXPECT_EQ(allocations, 0);
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace stillcut
