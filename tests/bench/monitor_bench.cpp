// How much faster than the machine the chatter monitor is: three axes at 25.6 kHz, a cut with tooth harmonics, runout
// and noise. `x_real_time` is seconds of signal per second of processor time; the parts below the whole show where it
// goes.
#include <benchmark/benchmark.h>

#include <complex>
#include <random>
#include <vector>

#include "dsp/fft.hpp"
#include "dsp/line_watch.hpp"
#include "dsp/monitor.hpp"
#include "dsp/synchronous_filter.hpp"
#include "dsp/tone.hpp"
#include "tests/dsp/synthetic_cut.hpp"

namespace {

using namespace stillcut;

constexpr double kRate_hz = 25600.0;
constexpr int kAxes = 3;
constexpr double kSignal_s = 4.0;
constexpr auto kSamples = static_cast<std::size_t>(kSignal_s * kRate_hz);

void report(benchmark::State& state, double signal_s) {
  state.counters["x_real_time"] =
      benchmark::Counter(signal_s * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void whole_monitor(benchmark::State& state, double rate_hz, double chatter_hz) {
  SyntheticCut cut;
  cut.rate_hz = rate_hz;
  cut.axes = kAxes;
  cut.duration_s = kSignal_s;
  cut.chatter.frequency_hz = chatter_hz;
  cut.chatter.start_s = 1.0;
  const SyntheticLog log = record(cut);
  std::size_t events = 0;
  for (auto _ : state) {
    Monitor monitor{monitor_settings(cut)};
    events += play(log, monitor, [](const MonitorView&) {}).size();
  }
  benchmark::DoNotOptimize(events);
  report(state, kSignal_s);
}

std::vector<float> noise(std::size_t length) {
  std::mt19937 random{1};
  std::normal_distribution<float> normal;
  std::vector<float> samples(length);
  for (float& x : samples) x = normal(random);
  return samples;
}

void integrity(benchmark::State& state) {
  SyntheticCut cut;
  cut.duration_s = 1.0;
  const SyntheticLog log = record(cut);
  SampleCheck check;
  std::uint32_t doubts = 0;
  for (auto _ : state) {
    for (const SampleBlock& block : log.blocks) {
      for (int i = 0; i < block.samples; ++i) doubts |= check.check(block, i);
    }
  }
  benchmark::DoNotOptimize(doubts);
  report(state, cut.duration_s);
}

void synchronous_filter(benchmark::State& state) {
  const std::vector<float> samples = noise(kSamples * kAxes);
  SynchronousFilter filter{kAxes};
  filter.set_samples_per_revolution(256.0);
  std::array<float, kMaxAxes> residual{};
  for (auto _ : state) {
    double angle = 0.0;
    for (std::size_t n = 0; n < kSamples; ++n) {
      angle += 1.0 / 256.0;
      if (angle >= 1.0) angle -= 1.0;
      filter.process(angle, std::span{samples}.subspan(n * kAxes, kAxes), residual);
      benchmark::DoNotOptimize(residual);
    }
  }
  report(state, kSignal_s);
}

// One transform an axis and hop.
void transform(benchmark::State& state) {
  const int length = window_length(kRate_hz, LineWatchSettings{}.window_s);
  RealFft fft{length};
  const std::vector<float> samples = noise(static_cast<std::size_t>(length));
  std::vector<std::complex<float>> spectrum(static_cast<std::size_t>(fft.bins()));
  for (auto _ : state) {
    for (int a = 0; a < kAxes; ++a) fft.transform(samples, spectrum);
    benchmark::DoNotOptimize(spectrum.data());
  }
  report(state, length / 8 / kRate_hz);
}

// Window, transform, floors, limits and candidates.
void line_watch(benchmark::State& state) {
  const std::vector<float> samples = noise(kSamples * kAxes);
  LineWatch watch{kAxes, kRate_hz, {}};
  for (auto _ : state) {
    for (std::size_t n = 0; n < kSamples; ++n) watch.push(std::span{samples}.subspan(n * kAxes, kAxes));
  }
  report(state, kSignal_s);
}

// The close look at one suspected line; at most three a hop, and only where a line stands out.
void look_closely(benchmark::State& state) {
  const int length = window_length(kRate_hz, LineWatchSettings{}.window_s);
  const std::vector<float> samples = noise(static_cast<std::size_t>(4 * length));
  for (auto _ : state) {
    benchmark::DoNotOptimize(analyse_tone(std::span{samples}.last(static_cast<std::size_t>(length)), kRate_hz, 700.0));
    benchmark::DoNotOptimize(recurrence(samples, length, kRate_hz, 700.0, 0.01));
  }
}

BENCHMARK_CAPTURE(whole_monitor, stable, kRate_hz, 0.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(whole_monitor, chatter, kRate_hz, 730.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(whole_monitor, chatter_at_50_kHz, 50000.0, 730.0)->Unit(benchmark::kMillisecond);
BENCHMARK(integrity)->Unit(benchmark::kMillisecond);
BENCHMARK(synchronous_filter)->Unit(benchmark::kMillisecond);
BENCHMARK(transform)->Unit(benchmark::kMicrosecond);
BENCHMARK(line_watch)->Unit(benchmark::kMillisecond);
BENCHMARK(look_closely)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
