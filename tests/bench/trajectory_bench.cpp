// How long it takes to plan moves of 1, 3 and 7 axes, with time synchronization, beside a real transform of 1024 points
// by kissfft measured in the same run: `per_fft` is the ratio, and `of_reference` compares it with the reference
// figures (Ruckig community 0.17.3 on a machine where that transform took 3.84 us: position 0.575, 3.0 and 7.8 us,
// velocity 0.103, 0.42 and 1.05 us). 1 or less: as fast as the reference or faster.
#include <benchmark/benchmark.h>
#include <kissfft/kiss_fftr.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <vector>

#include "rt/synchronized_motion.hpp"

namespace stillcut {
namespace {

constexpr std::size_t kMoves = 4096;
constexpr double kReferenceTransform_us = 3.84;

// Normal states and uniform limits, like stratum A of the reference table.
std::vector<AxisTask> random_tasks(std::size_t count) {
  std::mt19937_64 random{42};
  std::normal_distribution<double> position{0.0, 4.0}, dynamic{0.0, 0.8};
  std::uniform_real_distribution<double> limit{0.1, 12.0}, jerk{0.1, 16.0}, chance{0.0, 1.0};
  std::vector<AxisTask> tasks;
  while (tasks.size() < count) {
    AxisTask task;
    task.start = {position(random), chance(random) < 0.9 ? dynamic(random) : 0.0,
                  chance(random) < 0.8 ? dynamic(random) : 0.0};
    task.target = {position(random), chance(random) < 0.7 ? dynamic(random) : 0.0,
                   chance(random) < 0.6 ? dynamic(random) : 0.0};
    task.limits = symmetric_limits(limit(random) + std::abs(task.target.velocity),
                                   limit(random) + std::abs(task.target.acceleration), jerk(random));
    if (check_task(task) == TrajectoryError::none) tasks.push_back(task);
  }
  return tasks;
}

// The fastest of many rounds, each with memory of its own: single ones have taken half as long again.
double transform_us() {
  double best = HUGE_VAL;
  for (int round = 0; round < 20; ++round) {
    kiss_fftr_cfg config = kiss_fftr_alloc(1024, 0, nullptr, nullptr);
    std::vector<float> in(1024 + 64 * static_cast<std::size_t>(round));
    std::vector<kiss_fft_cpx> out(513);
    for (std::size_t i = 0; i < in.size(); ++i) in[i] = static_cast<float>(std::sin(0.1 * static_cast<double>(i * i)));
    constexpr int kTransforms = 1000;
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < kTransforms; ++i) {
      kiss_fftr(config, in.data(), out.data());
      benchmark::DoNotOptimize(out.data());
    }
    const std::chrono::duration<double, std::micro> spent = std::chrono::steady_clock::now() - start;
    best = std::min(best, spent.count() / kTransforms);
    kiss_fftr_free(config);
  }
  return best;
}

void report(benchmark::State& state, double mean_us, double reference_us) {
  static const double transform = transform_us();
  state.counters["mean_us"] = mean_us;
  state.counters["fft_us"] = transform;
  state.counters["per_fft"] = mean_us / transform;
  state.counters["of_reference"] = (mean_us / transform) / (reference_us / kReferenceTransform_us);
}

using Planner = MotionPlan (*)(std::span<const AxisTask>, std::span<AxisTrajectory>, Synchronization);

// kMoves different moves a round, so that branches are as unforeseeable as in use.
void plan_moves(benchmark::State& state, Planner plan, Synchronization synchronization, double reference_us) {
  const auto axes = static_cast<std::size_t>(state.range(0));
  const std::vector<AxisTask> tasks = random_tasks(kMoves * axes);
  std::vector<AxisTrajectory> trajectories(axes);
  std::vector<double> times;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < kMoves; ++i) {
      benchmark::DoNotOptimize(plan(std::span(tasks).subspan(i * axes, axes), trajectories, synchronization));
    }
    const std::chrono::duration<double, std::micro> spent = std::chrono::steady_clock::now() - start;
    times.push_back(spent.count() / kMoves);
  }
  // The middle of the rounds: another program's share of the processor is no part of it.
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  report(state, times[times.size() / 2], reference_us);
}

double position_reference_us(std::int64_t axes) { return axes == 1 ? 0.575 : axes == 3 ? 3.0 : 7.8; }
double velocity_reference_us(std::int64_t axes) { return axes == 1 ? 0.103 : axes == 3 ? 0.42 : 1.05; }

void position(benchmark::State& state) {
  plan_moves(state, plan_positions, Synchronization::time, position_reference_us(state.range(0)));
}
BENCHMARK(position)->Arg(1)->Arg(3)->Arg(7)->Unit(benchmark::kMillisecond);

void velocity(benchmark::State& state) {
  plan_moves(state, plan_velocities, Synchronization::time, velocity_reference_us(state.range(0)));
}
BENCHMARK(velocity)->Arg(1)->Arg(3)->Arg(7)->Unit(benchmark::kMillisecond);

// One axis through its own interface, without synchronization.
void one_position(benchmark::State& state) {
  const Planner plan = [](std::span<const AxisTask> tasks, std::span<AxisTrajectory> /*unused*/, Synchronization) {
    const PositionPlan found = plan_position(tasks[0].start, tasks[0].target, tasks[0].limits);
    return MotionPlan{found.error, 0, found.trajectory.duration()};
  };
  plan_moves(state, plan, Synchronization::none, position_reference_us(1));
}
BENCHMARK(one_position)->Arg(1)->Unit(benchmark::kMillisecond);

void one_velocity(benchmark::State& state) {
  const Planner plan = [](std::span<const AxisTask> tasks, std::span<AxisTrajectory> /*unused*/, Synchronization) {
    const AxisTask& task = tasks[0];
    const VelocityPlan found = plan_velocity(task.start, task.target.velocity, task.target.acceleration,
                                             {task.limits.acceleration_max, task.limits.jerk});
    return MotionPlan{found.error, 0, found.trajectory.duration()};
  };
  plan_moves(state, plan, Synchronization::none, velocity_reference_us(1));
}
BENCHMARK(one_velocity)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stillcut

BENCHMARK_MAIN();
