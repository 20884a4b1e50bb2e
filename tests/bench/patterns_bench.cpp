// The whole study of `stillcut patterns` (limits, ranking, optimization) on 49 postures, 36 directions over half a
// turn, 201 speeds, both senses of milling, on two threads: beside its target of a minute, and the plan alone.
#include <benchmark/benchmark.h>

#include <chrono>
#include <numeric>

#include "drivers/files/cell.hpp"
#include "models/path_plan.hpp"
#include "tools/pattern_study.hpp"

namespace {

using namespace stillcut;

PatternQuestion pocket_question(const Cell& cell, PlanObjective objective) {
  PatternQuestion question;
  question.cut = *cell.cut;
  question.step = deg_to_rad(5.0);
  question.plan.objective = objective;
  question.threads = 2;
  return question;
}

Cell pocket_cell() { return read_cell(EXAMPLES "/hexapod-pocket/cell.toml", {.dbc = false, .bus = false}); }

void whole_study(benchmark::State& state) {
  constexpr double kTarget_s = 60.0;
  const Cell cell = pocket_cell();
  double seconds = 0.0;
  for (auto _ : state) {
    const auto begin = std::chrono::steady_clock::now();
    benchmark::DoNotOptimize(study_patterns(cell, pocket_question(cell, PlanObjective::absolute), [](double) {}));
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  state.counters["share_of_target"] = seconds / kTarget_s;
}
BENCHMARK(whole_study)->Unit(benchmark::kSecond)->Iterations(1)->UseRealTime();

void plan_alone(benchmark::State& state) {
  const auto objective = state.range(0) == 0 ? PlanObjective::absolute : PlanObjective::time;
  const Cell cell = pocket_cell();
  PatternQuestion question = pocket_question(cell, objective);
  question.method = DirectionMethod::zeroth_order;
  const PatternStudy study = study_patterns(cell, question, [](double) {});
  std::vector<std::size_t> used(study.table.locations.size());
  std::iota(used.begin(), used.end(), std::size_t{0});
  for (auto _ : state) benchmark::DoNotOptimize(plan_path(study.table, used, question.plan));
}
BENCHMARK(plan_alone)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
