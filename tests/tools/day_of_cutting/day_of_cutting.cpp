// day_of_cutting HOURS FOLDER: a day of simulated cutting through the daemon's own loop, publisher and recorder, as
// fast as it goes. Ten minutes from the simulated machine, with depths that are sound and depths that chatter, come
// again and again; an arm moves, asks for lobes, and follows no correction. Prints a line an hour; fails where memory
// grows after the second hour, where the monitor hears less than at first, or where anything is dropped.
#include <malloc.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "drivers/can/candump_log.hpp"
#include "drivers/files/cell.hpp"
#include "drivers/lcm/connection.hpp"
#include "tools/live_loop.hpp"
#include "tools/live_outputs.hpp"
#include "tools/predictor.hpp"
#include "tools/recorder.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000, kMillisecond = 1'000'000, kSecond = 1'000'000'000;
constexpr std::int64_t kRobotCycle_ns = 12 * kMillisecond;  // of a common robot controller
constexpr std::int64_t kAsksEvery_ns = 20 * kSecond;  // for lobes; the daemon's four a second would take an hour here
constexpr int kSettled_h = 6;
constexpr double kMaxHeapGrowth_mib = 0.25;
// What the recorder holds between two of its writes is here a hundred times what it is beside a machine, and more when
// this machine is slow: once it was taken from the kernel it stays resident.
constexpr double kMaxResidentGrowth_mib = 16.0;

std::int64_t data_time_ns = kStart_ns;
std::int64_t data_clock() noexcept { return data_time_ns; }

// The frames of a log without end, up to the present.
class RepeatedLog final : public CanBus {
 public:
  explicit RepeatedLog(const std::filesystem::path& log) {
    CandumpReader reader{log};
    for (CanFrame frame; reader.next(frame);) frames_.push_back(frame);
    length_ns_ = frames_.back().stamp_ns - frames_.front().stamp_ns + kMillisecond;
  }

  std::size_t receive(std::span<CanFrame> into) noexcept override {
    std::size_t n = 0;
    for (; n < into.size(); ++n) {
      CanFrame frame = frames_[at_];
      frame.stamp_ns += shift_ns_ + kStart_ns - frames_.front().stamp_ns;
      if (frame.stamp_ns > data_time_ns) break;
      into[n] = frame;
      if (++at_ < frames_.size()) continue;
      at_ = 0;
      shift_ns_ += length_ns_;
    }
    return n;
  }
  bool send(const CanFrame& /*frame*/) noexcept override { return false; }
  [[nodiscard]] BusState state() const noexcept override { return BusState::up; }
  [[nodiscard]] BusCounters counters() const noexcept override { return {}; }

 private:
  std::vector<CanFrame> frames_;
  std::size_t at_ = 0;
  std::int64_t shift_ns_ = 0, length_ns_ = 0;
};

struct Memory {
  double resident_mib = 0.0, heap_mib = 0.0;
};

Memory memory_now() {
  std::ifstream file{"/proc/self/statm"};
  double pages = 0.0, resident = 0.0;
  file >> pages >> resident;
  return {resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1048576.0,
          static_cast<double>(mallinfo2().uordblks) / 1048576.0};
}

RobotState arm_at(const Cell& cell, std::int64_t now_ns) {
  const double turn = static_cast<double>(now_ns % (97 * kSecond)) * 1e-9 / 97.0 * 2.0 * 3.14159265358979;
  RobotState state;
  state.stamp_ns = now_ns;
  state.tcp_position = {0.1 * std::cos(turn), 0.1 * std::sin(turn), 0.0};
  state.feed_direction = turn;
  state.feed_rate = 0.05;
  state.spindle_speed_rpm = 8500.0;
  state.axial_depth = cell.cut->axial_depth;
  state.radial_depth = kNaN;
  state.milling = cell.cut->milling;
  return state;
}

// Lets the ordinary threads catch up, which at this pace have a few hundred times less time than beside a machine.
template <typename Item>
void wait_for_room(const Ring<Item>& ring) {
  while (ring.size_approx() > ring.capacity() / 2) std::this_thread::sleep_for(std::chrono::milliseconds{1});
}

int day(const std::filesystem::path& folder, int hours) {
  const Cell cell = read_cell(folder / "cell.toml", {.bus = false});
  Pipeline pipeline{cell};
  Predictor predictor{cell};
  pipeline.core().add_lobes(predictor.nominal().diagram);
  RepeatedLog bus{folder / "cut.log"};
  const auto channels = std::make_unique<LoopChannels>();
  RecordingSettings settings;
  settings.folder = folder / "recording";
  settings.keep_mib = settings.keep_marked_mib = 64.0;
  Recorder recorder{*channels, settings, "can0"};
  const LcmConnection lcm = open_lcm("memq://");
  std::atomic<std::int64_t> asked{-1}, onsets{0};
  PublisherThread publisher{*channels, lcm, "", cell.mode, [&](const Output& output) {
                              recorder.add_output(output);
                              if (output.type == Output::Type::correction) asked = output.correction.sequence;
                              if (output.type == Output::Type::event && output.event.type == EventType::chatter_onset)
                                ++onsets;
                            }};
  LiveLoop loop{bus, pipeline, *channels, true, true, true, data_clock};
  publisher.start();

  std::printf("%5s %12s %10s %8s\n", "hour", "resident MiB", "heap MiB", "onsets");
  std::int64_t acknowledged = -1, onsets_before = 0, onsets_at_first = 0;
  Memory settled;
  bool good = true;
  std::int64_t next_state_ns = kStart_ns, next_question_ns = kStart_ns;
  for (int hour = 1; hour <= hours; ++hour) {
    for (std::int64_t ms = 0; ms < 3'600'000; ++ms) {
      data_time_ns += kMillisecond;
      if (data_time_ns >= next_state_ns) {
        next_state_ns += kRobotCycle_ns;
        const RobotState state = arm_at(cell, data_time_ns);
        (void)channels->messages.push(state);
        if (const std::int64_t sequence = asked; sequence != acknowledged) {
          CorrectionAck ack;
          ack.stamp_ns = data_time_ns;
          ack.sequence = acknowledged = sequence;
          ack.accepted = true;
          (void)channels->messages.push(ack);
        }
        if (data_time_ns >= next_question_ns) {
          next_question_ns += kAsksEvery_ns;
          if (const auto diagram = predictor.at(state))
            channels->lobes.publish({*diagram, recorder.add_question(encode(predictor.answered()), false)});
        }
      }
      wait_for_room(channels->recorded);
      wait_for_room(channels->outputs);
      loop.tick(data_time_ns - kStart_ns);
    }
    const Memory now = memory_now();
    const std::int64_t heard = onsets - onsets_before;
    onsets_before = onsets;
    std::printf("%5d %12.2f %10.2f %8lld\n", hour, now.resident_mib, now.heap_mib, static_cast<long long>(heard));
    std::fflush(stdout);
    if (hour <= kSettled_h) {
      settled = now;
      onsets_at_first = heard;
      continue;
    }
    if (now.heap_mib > settled.heap_mib + kMaxHeapGrowth_mib ||
        now.resident_mib > settled.resident_mib + kMaxResidentGrowth_mib) {
      std::printf("memory has grown since hour %d\n", kSettled_h);
      good = false;
    }
    if (heard < onsets_at_first * 8 / 10 || heard == 0) {
      std::printf("the monitor hears less than in hour %d\n", kSettled_h);
      good = false;
    }
  }
  publisher.finish();
  recorder.finish();
  const RecorderCounters recorded = recorder.counters();
  std::printf("%lld frames, %lld messages recorded, %lld lost; dropped: %llu outputs, %llu records, %llu messages\n",
              static_cast<long long>(recorded.frames), static_cast<long long>(recorded.messages),
              static_cast<long long>(recorded.lost), static_cast<unsigned long long>(channels->outputs.refused()),
              static_cast<unsigned long long>(channels->recorded.refused()),
              static_cast<unsigned long long>(channels->messages.refused()));
  if (recorded.lost + static_cast<std::int64_t>(channels->outputs.refused() + channels->messages.refused()) > 0)
    good = false;
  return good && hours > kSettled_h ? 0 : 1;
}

}  // namespace
}  // namespace stillcut

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "Usage: day_of_cutting HOURS FOLDER  (a cell.toml and its cut.log; at least 7 hours)\n");
    return 2;
  }
  spdlog::set_level(spdlog::level::err);
  return stillcut::day(argv[2], std::atoi(argv[1]));
}
