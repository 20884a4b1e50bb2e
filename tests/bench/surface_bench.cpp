// What the swept surface costs: patches a second on one thread and on two, beside what the memory allows. The bound is
// a plain minimum of a map with another of its size, streamed once: the machine can lower no more heights than that.
// `patches` and `heights` are a second; `of_bound` is heights over the bound's.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>

#include "models/surface_refinement.hpp"
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

// Arguments: side in mm, spacing in um, threads, with the paper's runout (20 um radial, 5 um axial).
void surface(benchmark::State& state) {
  PaperCut paper;
  if (state.range(3) != 0) paper.tool.runout = 20e-6, paper.tool.axial_runout = 5e-6;
  const double side = 1e-3 * static_cast<double>(state.range(0)), spacing = 1e-6 * static_cast<double>(state.range(1));
  const int threads = static_cast<int>(state.range(2));
  const CutterMotion motion = cutter_motion(paper.tool, paper.cut);
  const auto passes = passes_over(motion, paper.cut, side, side);
  const Workers workers = [threads](std::size_t count, const auto& task) { run_tasks(count, threads, task, [] {}); };
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

}  // namespace

BENCHMARK(surface)
    ->ArgNames({"mm", "um", "threads", "runout"})
    ->Args({2, 4, 1, 0})
    ->Args({2, 4, 2, 0})
    ->Args({2, 4, 1, 1})
    ->Args({2, 4, 2, 1})
    ->Args({20, 4, 2, 0})
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_MAIN();
