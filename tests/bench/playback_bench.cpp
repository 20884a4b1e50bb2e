// How fast playback runs on one core, three axes at 25.6 kS/s, and where the time goes: parse, decode, filter,
// transform, decide. The input is a simulated cut that chatters, so that every path is taken. Processor time, median of
// the runs; the whole chain is `stillcut replay` without its output.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <vector>

#include "drivers/can/candump_log.hpp"
#include "tests/simulated_cut.hpp"
#include "tools/pipeline.hpp"

using namespace stillcut;

namespace {

constexpr double kSignal_s = 6.0;
constexpr int kRuns = 15;

void write_cut(const Cell& cell, const std::filesystem::path& file) {
  std::ofstream out{file, std::ios::binary};
  std::array<char, kMaxCandumpLine> line{};
  for (const CanFrame& frame : simulate_cut(cell, kDemoDepth, kSignal_s)) {
    out.write(line.data(), static_cast<std::streamsize>(format_candump_line(frame, "can0", line)));
  }
}

double processor_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median_s(const std::function<void()>& run) {
  std::vector<double> times;
  for (int i = 0; i < kRuns; ++i) {
    const double start = processor_s();
    run();
    times.push_back(processor_s() - start);
  }
  std::nth_element(times.begin(), times.begin() + kRuns / 2, times.end());
  return times[kRuns / 2];
}

void print_row(const char* stage, double seconds, double whole) {
  std::printf("%-34s %9.2f ms %7.1f %%\n", stage, 1e3 * seconds / kSignal_s, 100.0 * seconds / whole);
}

}  // namespace

int main() {
  const Cell cell = demo_cell();
  const auto file = std::filesystem::temp_directory_path() / "stillcut-playback-bench.log";
  write_cut(cell, file);

  // What each stage feeds the next, kept so that the stages can be timed alone.
  std::vector<CanFrame> frames;
  std::vector<SampleBlock> blocks;
  {
    CandumpReader reader{file};
    for (CanFrame frame; reader.next(frame);) frames.push_back(frame);
    Decoder decoder{read_dbc(cell.can->dbc), *cell.can, ""};
    Decoded decoded;
    for (const CanFrame& frame : frames) {
      if (decoder.decode(frame, decoded) && decoded.blocks > 0) blocks.push_back(decoded.block[0]);
    }
  }
  const SensorSettings sensor{cell.can->accelerometers.front().sample_rate_hz, 7};
  const double speed = cell.cut->spindle_speed;
  volatile double sink = 0.0;  // what was computed is used

  const double parse = median_s([&] {
    CandumpReader reader{file};
    for (CanFrame frame; reader.next(frame);) sink = sink + frame.length;
  });
  const double decode = median_s([&] {
    Decoder decoder{read_dbc(cell.can->dbc), *cell.can, ""};
    Decoded decoded;
    for (const CanFrame& frame : frames) decoder.decode(frame, decoded);
    sink = sink + static_cast<double>(decoder.counters().frames_lost);
  });
  const double filter_and_transform = median_s([&] {
    SensorPath path{sensor, {}};
    for (const SampleBlock& block : blocks) {
      for (int i = 0; i < block.samples;) i = path.process(block, i, speed);
    }
    sink = sink + path.level();
  });
  const double transform = median_s([&] {
    LineWatch watch{kMaxAxes, sensor.sample_rate_hz, {}};
    std::array<Lanes, kMaxSamplesPerBlock> samples{};
    for (const SampleBlock& block : blocks) {
      for (int from = 0, to = 0; from < block.samples; from = to) {
        to = std::min<int>(block.samples, from + watch.to_hop());
        for (int i = from; i < to; ++i) {
          samples[i - from] = {block.acceleration[0][i], block.acceleration[1][i], block.acceleration[2][i], 0.0F};
        }
        watch.push(std::span{samples}.first(static_cast<std::size_t>(to - from)));
      }
    }
    sink = sink + watch.largest_ratio();
  });
  const double whole = median_s([&] {
    CandumpReader reader{file};
    Pipeline pipeline{cell};
    for (CanFrame frame; reader.next(frame);) {
      pipeline.feed(frame);
      sink = sink + static_cast<double>(pipeline.core().outputs().size());
      pipeline.core().clear_outputs();
    }
  });
  std::filesystem::remove(file);

  std::printf("playback, 3 axes at %.0f S/s, processor time for a second of signal\n", sensor.sample_rate_hz);
  print_row("parse", parse, whole);
  print_row("decode", decode, whole);
  print_row("filter (check, synchronous filter)", filter_and_transform - transform, whole);
  print_row("transform (FFT, floor, lines)", transform, whole);
  print_row("decide (the rest of the core)", whole - parse - decode - filter_and_transform, whole);
  print_row("whole chain", whole, whole);
  std::printf("%.0f x real time (target 200)\n", kSignal_s / whole);
}
