// What stability costs: one spectral radius, a whole field of them, the verdicts of a diagram, a traced boundary, and
// live diagrams along a posture sweep. Each line carries `bound`, the time that the machine's arithmetic would need if
// nothing but the multiplications of the innermost solution counted, and for the traced ones the error that a separate
// run at the next finer resolution finds.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "models/interpolation.hpp"
#include "models/lobe_trace.hpp"
#include "models/lobes.hpp"
#include "models/receptance.hpp"
#include "models/stability_field.hpp"

#define TEST_DATA ""
#include "tests/models/stability_cases.hpp"

namespace {

using namespace stillcut;

constexpr int kSpeeds = 200, kDepths = 100;

struct Diagram {
  test::StabilityCase cutting;
  std::vector<double> speeds, depths;
};

// Case a of the reference: one mode, 5000-25 000 rpm, 0-5 mm; 0: half immersion down-milling, 1: a slot.
Diagram case_a(std::int64_t slot) {
  Diagram diagram{
      slot == 0 ? test::reference_case("a", 0.5, Milling::down) : test::reference_case("a", 1.0, Milling::slot),
      equally_spaced_speeds(rpm_to_rad_s(5000), rpm_to_rad_s(25000), kSpeeds),
      {}};
  for (int k = 1; k <= kDepths; ++k) diagram.depths.push_back(5e-3 * k / kDepths);
  return diagram;
}

// Case c: a robot's four modes in two directions, feed at 30 degrees.
Diagram case_c() {
  return {test::reference_case("c_feed30", 0.5, Milling::down),
          equally_spaced_speeds(rpm_to_rad_s(2800), rpm_to_rad_s(3800), kSpeeds),
          {}};
}

double worst_relative(const std::vector<DepthLimit>& a, const std::vector<DepthLimit>& b) {
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::isfinite(a[i].depth) && std::isfinite(b[i].depth)) {
      worst = std::max(worst, std::abs(a[i].depth / b[i].depth - 1.0));
    }
  }
  return worst;
}

// One radius with everything that belongs to its speed. Target: 25 us within 1e-4; a slot within twice that.
void OneRadius(benchmark::State& state) {
  const Diagram diagram = case_a(state.range(0));
  CutAtSpeed cutting(diagram.cutting.cut, diagram.cutting.modes, diagram.speeds.front(), 0);
  std::size_t i = 0;
  for (auto _ : state) {
    cutting.move_to(diagram.speeds[i * 37 % kSpeeds]);
    benchmark::DoNotOptimize(cutting.radius(diagram.depths[i * 61 % kDepths], 1e-5));
    ++i;
  }
}
BENCHMARK(OneRadius)->ArgName("slot")->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

// 20 000 radii. Target: 0.5 s; a slot within twice that.
void Field(benchmark::State& state) {
  const Diagram diagram = case_a(state.range(0));
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        spectral_radii(diagram.cutting.cut, diagram.cutting.modes, diagram.speeds, diagram.depths));
  }
}
BENCHMARK(Field)->ArgName("slot")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

// The verdict at the same 20 000 points. Target: 50 ms; a slot within twice that. `wrong`: points that the radius
// itself contradicts.
void Verdicts(benchmark::State& state) {
  const Diagram diagram = case_a(state.range(0));
  std::vector<std::uint8_t> stable;
  for (auto _ : state) {
    stable = stable_cuts(diagram.cutting.cut, diagram.cutting.modes, diagram.speeds, diagram.depths);
  }
  const auto radii = spectral_radii(diagram.cutting.cut, diagram.cutting.modes, diagram.speeds, diagram.depths);
  int wrong = 0;
  for (std::size_t k = 0; k < radii.size(); ++k) wrong += (radii[k] < 1.0) != (stable[k] == 1);
  state.counters["wrong"] = wrong;
}
BENCHMARK(Verdicts)->ArgName("slot")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

// The boundary over 200 speeds. Targets: case a 20 ms (a slot twice that), case c 40 ms. `error`: worst relative
// difference to a run at the next resolution and a tenth of the tolerance.
void Boundary(benchmark::State& state, const Diagram& diagram, double max_depth) {
  std::vector<DepthLimit> limits;
  for (auto _ : state) {
    limits = traced_depth_limits(diagram.cutting.cut, diagram.cutting.modes, diagram.speeds, {.max_depth = max_depth});
  }
  const auto finer = traced_depth_limits(diagram.cutting.cut, diagram.cutting.modes, diagram.speeds,
                                         {.max_depth = max_depth, .tolerance = 5e-5, .level = 1});
  state.counters["error"] = worst_relative(limits, finer);
}
BENCHMARK_CAPTURE(Boundary, one_mode, case_a(0), 5e-3)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Boundary, one_mode_slot, case_a(1), 5e-3)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Boundary, four_modes, case_c(), 20e-3)->Unit(benchmark::kMillisecond);

// A diagram of 201 speeds for a new posture, feed direction and immersion each time, as the model thread makes them:
// the modes of 15 postures weighed, turned and traced. `x_25Hz`: how many times faster than an arm followed at 25 Hz.
void PostureSweep(benchmark::State& state) {
  DynamicsMap map;
  map.has_joints = true;
  for (int i = 0; i < 15; ++i) {
    Posture posture;
    posture.id = std::to_string(i);
    posture.joints = {0.1 * (i % 5), 0.15 * (i / 5), 0, 0, 0, 0};
    posture.modes = test::robot_modes();
    for (std::size_t m = 0; m < posture.modes.size(); ++m) {
      posture.modes[m].natural_frequency *= 1.0 + 0.02 * std::sin(1.3 * i + static_cast<double>(m));
      posture.modes[m].stiffness *= 1.0 + 0.05 * std::cos(0.7 * i + static_cast<double>(m));
    }
    map.postures.push_back(posture);
  }
  Tool tool;
  tool.diameter = 0.025, tool.teeth = 2;
  Material material;
  material.ktc = 8e8, material.krc = 3e8;
  Cut cut;
  cut.milling = Milling::down;
  const SpindleLimits spindle{rpm_to_rad_s(2800), rpm_to_rad_s(3800), 200.0, 2000.0};
  double share = 0.0;
  for (auto _ : state) {
    share = std::fmod(share + 0.013, 1.0);
    Posture posture;
    posture.joints = {0.4 * share, 0.3 * (1.0 - share), 0, 0, 0, 0};
    cut.feed_direction = kTwoPi * share;
    cut.radial_depth = tool.diameter * (0.2 + 0.6 * share);
    const PredictedPosture predicted = predict_posture(map, posture, {});
    benchmark::DoNotOptimize(compute_lobe_diagram(tool, material, cut, spindle, predicted.posture.modes));
  }
  constexpr double kFollowed_hz = 25.0;
  state.counters["x_25Hz"] =
      benchmark::Counter(static_cast<double>(state.iterations()) / kFollowed_hz, benchmark::Counter::kIsRate);
}
BENCHMARK(PostureSweep)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
