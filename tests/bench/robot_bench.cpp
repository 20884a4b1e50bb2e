// How much faster than the machine a simulated robot is, at 25.6 kS/s under a cutting force, on one core. `x_real_time`
// is seconds of motion per second of processor time. A step is what the milling simulation asks for: where the tool
// will be, the step itself, then displacement, velocity and acceleration. Below the whole: where the time goes.
#include <benchmark/benchmark.h>

#include <cmath>

#include "models/arm_dynamics.hpp"
#include "models/arm_modes.hpp"
#include "models/feed_path.hpp"
#include "models/four_axis_arm.hpp"
#include "models/linearised_robot.hpp"
#include "models/newmark_robot.hpp"
#include "models/serial_arm.hpp"
#include "tests/models/machining_arm.hpp"

namespace {

using namespace stillcut;

constexpr double kRate_hz = 25600.0;
constexpr double kTooth_hz = 250.0;

Arm six_joints() { return test::machining_arm(); }

Eigen::Vector3d cutting_force(long i) {
  const double s = std::sin(kTooth_hz * M_PI * static_cast<double>(i) / kRate_hz);
  return s * s * Eigen::Vector3d(-120.0, 260.0, 40.0);
}

// A joint path that turns every joint slowly.
JointPath turning(const JointVector& home) {
  return [home](double time) { return JointVector(home.array() + 0.05 * std::sin(time)); };
}

template <class Robot>
void run_steps(benchmark::State& state, Robot& robot) {
  long i = 0;
  for (auto _ : state) {
    const Eigen::Vector3d begin = cutting_force(i), end = cutting_force(i + 1);
    benchmark::DoNotOptimize(robot.displacement_after(begin, end));
    robot.advance(begin, end);
    benchmark::DoNotOptimize(Eigen::Vector3d(robot.displacement() + robot.velocity() + robot.acceleration()));
    ++i;
  }
  state.counters["x_real_time"] =
      benchmark::Counter(static_cast<double>(state.iterations()) / kRate_hz, benchmark::Counter::kIsRate);
}

void whole_robot(benchmark::State& state, Arm (*make)(), bool moves) {
  const Arm arm = make();
  const JointVector home = home_angles(arm);
  NewmarkRobot robot(arm, moves ? turning(home) : holding(home), 1.0 / kRate_hz);
  run_steps(state, robot);
  state.counters["solutions_a_step"] =
      static_cast<double>(robot.iterations()) / static_cast<double>(state.iterations());
}

void linearised(benchmark::State& state, Arm (*make)(), bool moves, bool kdl) {
  const Arm arm = make();
  SerialArm serial(arm);
  const Linearise ours = [&](const JointVector& q) { return linear_arm(arm, q); };
  const Linearise theirs = [&](const JointVector& q) { return serial.linearised(q); };
  const JointVector home = home_angles(arm);
  LinearisedRobot robot(kdl ? theirs : ours, moves ? turning(home) : holding(home), 1.0 / kRate_hz);
  run_steps(state, robot);
}

BENCHMARK_CAPTURE(whole_robot, six_joints_stand, six_joints, false);
BENCHMARK_CAPTURE(whole_robot, six_joints_move, six_joints, true);
BENCHMARK_CAPTURE(whole_robot, four_axes_stand, huynh_robot, false);
BENCHMARK_CAPTURE(linearised, six_joints_stand, six_joints, false, false);
BENCHMARK_CAPTURE(linearised, six_joints_move, six_joints, true, false);
BENCHMARK_CAPTURE(linearised, six_joints_move_kdl, six_joints, true, true);

// The parts, six joints.
template <class Part>
void part(benchmark::State& state, Part run) {
  const Arm arm = six_joints();
  const JointVector home = home_angles(arm), velocities = JointVector::Constant(6, 0.01);
  const ArmPose pose = arm_pose(arm, home);
  for (auto _ : state) benchmark::DoNotOptimize(run(arm, pose, home, velocities));
}

void part_advance(benchmark::State& state) {
  const Arm arm = six_joints();
  NewmarkRobot robot(arm, holding(home_angles(arm)), 1.0 / kRate_hz);
  long i = 0;
  for (auto _ : state) {
    robot.advance(cutting_force(i), cutting_force(i + 1));
    ++i;
  }
}
BENCHMARK(part_advance);

#define STILLCUT_PART(name, ...)                                                                       \
  void part_##name(benchmark::State& state) {                                                          \
    part(state, [&](const Arm& arm, const ArmPose& pose, const JointVector& q, const JointVector& v) { \
      (void)arm, (void)pose, (void)q, (void)v;                                                         \
      return __VA_ARGS__;                                                                              \
    });                                                                                                \
  }                                                                                                    \
  BENCHMARK(part_##name)

STILLCUT_PART(pose, arm_pose(arm, q));
STILLCUT_PART(momenta, momenta(arm, pose, v));
STILLCUT_PART(kinetic_slope, kinetic_slope(arm, pose, v, v));
STILLCUT_PART(gravity, gravity_torques(arm, pose));
STILLCUT_PART(tool_force, tool_torques(arm, pose, Eigen::Vector3d(1, 2, 3)));
STILLCUT_PART(equations_by_dalembert, equations_of_motion(arm, pose, v));
STILLCUT_PART(linear_arm, linear_arm(arm, q));
STILLCUT_PART(modes, arm_modes(linear_arm(arm, q)));

void part_equations_by_kdl(benchmark::State& state) {
  SerialArm serial(six_joints());
  const JointVector home = home_angles(serial.description()), velocities = JointVector::Constant(6, 0.01);
  for (auto _ : state) benchmark::DoNotOptimize(serial.equations(home, velocities));
}
BENCHMARK(part_equations_by_kdl);

}  // namespace

BENCHMARK_MAIN();
