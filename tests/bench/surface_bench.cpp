// What the swept surface costs: patches a second on one thread and on two, beside what the memory allows. The bound is
// a plain minimum of a map with another of its size, streamed once: the machine can lower no more heights than that.
// `patches` and `heights` are a second; `of_bound` is heights over the bound's.
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>

#include "models/path_surface.hpp"
#include "models/surface_refinement.hpp"
#include "models/surface_vibration.hpp"
#include "tools/tasks_on_threads.hpp"

namespace {

using namespace stillcut;

// The surface paper's case 5: 6000 rpm, 300 mm/min, a_e 0.1 mm, tilt 5, lead 10 degrees, its tool of 8 mm.
struct PaperCut {
  Tool tool{.shape = ToolShape::ball,
            .diameter = 8e-3,
            .teeth = 2,
            .pitch = {kTwoPi / 2, kTwoPi / 2},
            .helix = deg_to_rad(45)};
  Cut cut{.radial_depth = 0.1e-3,
          .axial_depth = 0.5e-3,
          .feed_per_tooth = 0.025e-3,
          .spindle_speed = rpm_to_rad_s(6000),
          .tilt = deg_to_rad(5),
          .lead = deg_to_rad(10)};
};

double streamed_per_second(const HeightMap& map) {
  std::vector<double> heights(map.heights.size(), 1.0), lower(heights.size(), 0.5);
  constexpr int kTimes = 5;
  const auto begin = std::chrono::steady_clock::now();
  for (int k = 0; k < kTimes; ++k) {
    for (std::size_t i = 0; i < heights.size(); ++i) heights[i] = std::min(heights[i], lower[i]);
    benchmark::DoNotOptimize(heights.data());
    benchmark::ClobberMemory();
  }
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  return kTimes * static_cast<double>(heights.size()) / taken.count();
}

constexpr double kAmplitude = 3e-6, kTurn = kTwoPi * 310.0;  // m, rad/s

// 0: a perfect tool; 1: the paper's runout, 20 um radial, 5 um axial; 2: it vibrates too, by 3 um.
Displacement spoil(Tool& tool, std::int64_t how) {
  Displacement displacement;
  if (how >= 1) tool.runout = 20e-6, tool.axial_runout = 5e-6;
  if (how < 2) return displacement;
  displacement.at = [](double time) -> Eigen::Vector3d {
    return kAmplitude * Eigen::Vector3d(std::sin(kTurn * time), std::sin(0.7 * kTurn * time), std::cos(kTurn * time));
  };
  displacement.reach = Eigen::Vector3d::Constant(kAmplitude);
  displacement.speed = std::sqrt(3.0) * kAmplitude * kTurn;
  return displacement;
}

Workers on_threads(int threads) {
  return [threads](std::size_t count, const auto& task) { run_tasks(count, threads, task, [] {}); };
}

// Arguments: side in mm, spacing in um, threads, how the tool is spoilt.
void surface(benchmark::State& state) {
  PaperCut paper;
  const Displacement displacement = spoil(paper.tool, state.range(3));
  const double side = 1e-3 * static_cast<double>(state.range(0)), spacing = 1e-6 * static_cast<double>(state.range(1));
  const CutterMotion motion = cutter_motion(paper.tool, paper.cut, displacement);
  const auto passes = passes_over(motion, paper.cut, side, side);
  const Workers workers = on_threads(static_cast<int>(state.range(2)));
  SweepCount total;
  HeightMap map;
  for (auto unused : state) {
    map = uncut_map(side, side, spacing);
    const SurfaceSweep sweep(motion, paper.cut, map.spacing_along, map.spacing_across);
    const SweepCount count = sweep_all(sweep, map, passes, workers);
    total.patches += count.patches;
    total.heights += count.heights;
  }
  const double bound = streamed_per_second(map);
  state.counters["patches"] = benchmark::Counter(static_cast<double>(total.patches), benchmark::Counter::kIsRate);
  state.counters["heights"] = benchmark::Counter(static_cast<double>(total.heights), benchmark::Counter::kIsRate);
  state.counters["of_bound"] =
      benchmark::Counter(static_cast<double>(total.heights) / bound, benchmark::Counter::kIsRate);
  state.counters["map_mib"] = static_cast<double>(map.heights.size() * sizeof(double)) / (1 << 20);
}

// The same cut round a cylinder of 20 mm, in chords of 0.1 mm with the axis turning: the surface of a tool path, with
// all that is found out about it. `of_flat` is its time over that of as many parallel passes, in the same run.
void path(benchmark::State& state) {
  PaperCut paper;
  const Displacement displacement = spoil(paper.tool, state.range(3));
  const double side = 1e-3 * static_cast<double>(state.range(0)), spacing = 1e-6 * static_cast<double>(state.range(1));
  const CutterMotion motion = cutter_motion(paper.tool, paper.cut, displacement);
  const auto passes = passes_over(motion, paper.cut, side, side);
  constexpr double kCylinder = 20e-3, kChord = 0.1e-3;
  const double ball = 0.5 * paper.tool.diameter;
  ToolPath tool_path;
  for (const CutterPass& pass : passes)
    for (double at = pass.begin; at < pass.begin + pass.length; at += kChord) {
      const double turn = (at - 0.5 * side) / kCylinder;
      const Eigen::Matrix3d turned = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()).toRotationMatrix();
      const Eigen::Vector3d middle(0.5 * side, pass.across, -kCylinder);
      const Eigen::Vector3d axis = turned * motion.orientation.col(2);
      const bool first = at == pass.begin;
      PathMove move{.from = tool_path.moves.empty() ? Eigen::Vector3d::Zero() : tool_path.moves.back().to,
                    .to = middle + turned * Eigen::Vector3d(0.0, 0.0, kCylinder + ball) - ball * axis,
                    .tool_axis = axis,
                    .cutting = !first,
                    .spindle_speed = paper.cut.spindle_speed};
      if (!first) move.feed_rate = motion.feed_rate;
      tool_path.moves.push_back(move);
    }
  const CutterPath cutter = cutter_path(paper.tool, tool_path, {}, displacement);
  const Workers workers = on_threads(static_cast<int>(state.range(2)));
  SweepCount total;
  std::chrono::duration<double> curved{}, flat{};
  for (auto unused : state) {
    const auto begin = std::chrono::steady_clock::now();
    const PathSurface surface =
        path_surface(cutter, {0.0, 0.0, side, side}, {.spacing = spacing, .allow_coarse = false, .workers = workers});
    curved += std::chrono::steady_clock::now() - begin;
    total.patches += surface.count.patches;
    if (surface.uncovered > 0) state.SkipWithError("the path leaves holes");
    state.PauseTiming();
    HeightMap map = uncut_map(side, side, spacing);
    const auto flat_begin = std::chrono::steady_clock::now();
    const SurfaceSweep sweep(motion, paper.cut, map.spacing_along, map.spacing_across);
    sweep_all(sweep, map, passes, workers);
    flat += std::chrono::steady_clock::now() - flat_begin;
    state.ResumeTiming();
  }
  state.counters["patches"] = benchmark::Counter(static_cast<double>(total.patches), benchmark::Counter::kIsRate);
  state.counters["of_flat"] = curved / flat;
}

// Passes milled in time; `real_time`: seconds of cutting a second.
void vibration(benchmark::State& state) {
  const PaperCut paper;
  VibrationSetup setup{.tool = paper.tool, .material = {}, .cut = paper.cut, .modes = {}, .force_noise = 0.0};
  setup.tool.runout = 20e-6;
  setup.tool.axial_runout = 5e-6;
  setup.material = {
      .name = "", .ktc = 1661.8e6, .krc = 1240.8e6, .kac = 19.1e6, .kte = 7.1e3, .kre = 15.9e3, .kae = 2.3e3};
  const double w = kTwoPi * 64.0;
  setup.modes = {{w, 0.05, 5e6, {1, 0, 0}}, {w, 0.05, 5e6, {0, 1, 0}}, {w, 0.05, 5e6, {0, 0, 1}}};
  const CutterMotion motion = cutter_motion(setup.tool, setup.cut);
  const auto passes = passes_over(motion, setup.cut, 2e-3, 0.5e-3);
  double cut = 0.0;
  for (auto unused : state) {
    benchmark::DoNotOptimize(vibrating_passes(setup, passes).peak);
    for (const CutterPass& pass : passes) cut += pass.length / motion.feed_rate;
  }
  state.counters["real_time"] = benchmark::Counter(cut, benchmark::Counter::kIsRate);
}

}  // namespace

BENCHMARK(vibration)->Unit(benchmark::kMillisecond);
BENCHMARK(surface)
    ->ArgNames({"mm", "um", "threads", "spoilt"})
    ->Args({2, 4, 1, 0})
    ->Args({2, 4, 2, 0})
    ->Args({2, 4, 1, 1})
    ->Args({2, 4, 2, 1})
    ->Args({2, 4, 1, 2})
    ->Args({2, 4, 2, 2})
    ->Args({20, 4, 2, 0})
    ->Args({20, 4, 2, 2})
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(path)
    ->ArgNames({"mm", "um", "threads", "spoilt"})
    ->Args({2, 4, 1, 0})
    ->Args({2, 4, 1, 2})
    ->Args({2, 4, 2, 2})
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_MAIN();
