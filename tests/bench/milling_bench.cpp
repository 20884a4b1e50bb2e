// What milling in time costs beside the time it simulates: `times_real` is simulated seconds a second on one core. The
// plant of issue 4: four modes, runout, surface memory, 25.6 kS/s of output. The breakdown holds the parts beside the
// whole: the structure alone, and the tool alone in the air.
#include <benchmark/benchmark.h>

#include "models/milling_simulation.hpp"
#include "models/modal_structure.hpp"

namespace {

using namespace stillcut;

constexpr double kRate_hz = 25.6e3, kSlice_s = 0.1;

MillingSetup plant(ToolShape shape, double helix_deg) {
  MillingSetup setup;
  setup.tool.shape = shape;
  setup.tool.diameter = 0.016;
  setup.tool.teeth = 3;
  setup.tool.pitch.assign(3, kTwoPi / 3);
  setup.tool.helix = deg_to_rad(helix_deg);
  setup.tool.runout = 10e-6;
  setup.material = {.name = "", .ktc = 8e8, .krc = 3e8, .kac = 1e8, .kte = 1e4, .kre = 1e4, .kae = 1e3};
  setup.cut = {.milling = Milling::down,
               .radial_depth = 8e-3,
               .axial_depth = 1.5e-3,
               .feed_per_tooth = 0.1e-3,
               .spindle_speed = rpm_to_rad_s(8000)};
  setup.modes = {{kTwoPi * 18, 0.03, 2e6, {1, 0, 0}},
                 {kTwoPi * 24, 0.03, 3e6, {0, 1, 0}},
                 {kTwoPi * 620, 0.03, 1.5e7, {1, 0, 0}},
                 {kTwoPi * 740, 0.03, 1.8e7, {0, 1, 0}}};
  return setup;
}

void report(benchmark::State& state) {
  state.counters["times_real"] =
      benchmark::Counter(kSlice_s * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void mill(benchmark::State& state, ToolShape shape, double helix_deg, double depth) {
  MillingSetup setup = plant(shape, helix_deg);
  setup.deepest = setup.cut.axial_depth;
  setup.cut.axial_depth = depth;
  MillingSimulation milling(setup, kRate_hz);
  for (auto unused : state)
    for (int i = 0; i < static_cast<int>(kSlice_s * kRate_hz); ++i) benchmark::DoNotOptimize(milling.advance());
  report(state);
}

void straight(benchmark::State& state) { mill(state, ToolShape::end, 0.0, 1.5e-3); }
void helix(benchmark::State& state) { mill(state, ToolShape::end, 30.0, 1.5e-3); }
void ball(benchmark::State& state) { mill(state, ToolShape::ball, 30.0, 1.5e-3); }
void air(benchmark::State& state) { mill(state, ToolShape::end, 30.0, 0.0); }

void structure_alone(benchmark::State& state) {
  constexpr int kSteps = 2;  // a sample, as the plant takes
  ModalStructure structure(plant(ToolShape::end, 0.0).modes, 1.0 / (kSteps * kRate_hz));
  const Eigen::Vector3d force(10.0, 5.0, 1.0);
  for (auto unused : state) {
    for (int i = 0; i < static_cast<int>(kSlice_s * kRate_hz) * kSteps; ++i) {
      benchmark::DoNotOptimize(structure.displacement_after(force, force));
      structure.advance(force, force);
      benchmark::DoNotOptimize(structure.displacement());
    }
  }
  report(state);
}

BENCHMARK(straight)->Unit(benchmark::kMillisecond);
BENCHMARK(helix)->Unit(benchmark::kMillisecond);
BENCHMARK(ball)->Unit(benchmark::kMillisecond);
BENCHMARK(air)->Unit(benchmark::kMillisecond);
BENCHMARK(structure_alone)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
