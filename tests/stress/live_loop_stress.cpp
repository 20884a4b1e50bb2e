// The daemon's loop with everybody that it shares data with, each as fast as it can, for the thread sanitizer: the loop
// ticks without sleeping on a bus that is never empty, while lobes, robot messages, recorder, publisher and readers of
// its times go on beside it.
#include <gtest/gtest.h>

#include <filesystem>
#include <thread>

#include "drivers/lcm/recording_messages.hpp"
#include "rt/periodic.hpp"
#include "tests/simulated_cut.hpp"
#include "tests/stress/stress_time.hpp"
#include "tools/live_loop.hpp"
#include "tools/live_outputs.hpp"
#include "tools/predictor.hpp"
#include "tools/recorder.hpp"

// LCM hands a message over under a mutex of GLib's, which the sanitizer cannot see (tests/drivers/lcm).
extern "C" const char* __tsan_default_suppressions() {
  return "called_from_lib:liblcm.so\ncalled_from_lib:libglib-2.0.so\n";
}

namespace stillcut {
namespace {

using test::stress;

// A cut played round and round.
class RoundBus final : public CanBus {
 public:
  explicit RoundBus(std::vector<CanFrame> cut)
      : cut_{std::move(cut)}, round_ns_{cut_.back().stamp_ns - cut_.front().stamp_ns + 1'000'000} {}

  std::size_t receive(std::span<CanFrame> frames) noexcept override {
    const std::size_t count = std::min<std::size_t>(frames.size() - 1, 8);
    for (std::size_t i = 0; i < count; ++i) {
      frames[i] = cut_[next_];
      frames[i].stamp_ns += shift_ns_;
      if (++next_ < cut_.size()) continue;
      next_ = 0;
      shift_ns_ += round_ns_;
    }
    now_ns.store(frames[count - 1].stamp_ns, std::memory_order_relaxed);
    return count;
  }
  bool send(const CanFrame&) noexcept override { return false; }
  [[nodiscard]] BusState state() const noexcept override { return ended.load() ? BusState::ended : BusState::up; }
  [[nodiscard]] BusCounters counters() const noexcept override { return {}; }

  std::atomic<std::int64_t> now_ns{0};
  std::atomic<bool> ended{false};

 private:
  std::vector<CanFrame> cut_;
  std::int64_t round_ns_, shift_ns_ = 0;
  std::size_t next_ = 0;
};

TEST(LiveLoopStress, WithAllThatShareItsData) {
  Cell cell = demo_cell();
  cell.mode = RuntimeMode::active;
  RoundBus bus{simulate_cut(cell, {{0.0, 0.0}, {0.1, 0.0}, {0.2, 3.8e-3}, {0.9, 3.8e-3}, {0.95, 0.0}}, 1.0)};
  Pipeline pipeline{cell};
  Predictor predictor{cell};
  const LobesAnswer answer{predictor.nominal().diagram, 0};
  pipeline.core().add_lobes(answer.diagram);
  const auto channels = std::make_unique<LoopChannels>();
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("stillcut-stress-" + std::to_string(getpid()));
  Recorder recorder{*channels, {.folder = folder, .keep_mib = 64.0}, "can0"};
  std::atomic<std::int64_t> asked{0};
  PublisherThread publisher{*channels, open_lcm("memq://"), "", cell.mode, [&](const Output& output) {
                              recorder.add_output(output);
                              if (output.type == Output::Type::correction) asked.store(output.correction.sequence);
                            }};
  LiveLoop live{bus, pipeline, *channels, false, true, true};
  publisher.start();

  std::atomic<bool> done{false};
  std::uint64_t ticks = 0;
  std::thread loop{[&] {
    while (live.tick(monotonic_ns())) {
      ++ticks;
      channels->times.loop.execution.record(static_cast<std::int64_t>(ticks % 1000));
      if (ticks % 64 == 0) std::this_thread::yield();
    }
    done.store(true);
  }};
  std::thread model{[&] {
    while (!done.load()) {
      LobesAnswer next = answer;
      next.diagram.usable_from_ns = bus.now_ns.load(std::memory_order_relaxed);
      next.question = recorder.add_question(encode(RobotState{.stamp_ns = next.diagram.usable_from_ns}), false);
      channels->lobes.publish(next);
      next.diagram.ahead = true;
      channels->ahead.publish(next);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }};
  std::thread robot{[&] {
    for (int i = 0; !done.load(); ++i) {
      const std::int64_t now_ns = bus.now_ns.load(std::memory_order_relaxed);
      (void)channels->messages.push(RobotState{.stamp_ns = now_ns,
                                               .spindle_speed_rpm = 8500.0,
                                               .axial_depth = 3.8e-3,
                                               .radial_depth = 10e-3,
                                               .milling = Milling::down});
      (void)channels->messages.push(CorrectionAck{.stamp_ns = now_ns, .sequence = asked.load(), .accepted = true});
      if (i % 8 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }};
  std::int64_t looked = 0;
  stress([&] {
    for (const NamedLatency& stage : named_latencies(channels->times)) looked += stage.times.count;
    looked += static_cast<std::int64_t>(channels->outputs.refused() + channels->recorded.size_approx());
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  bus.ended.store(true);
  for (std::thread* thread : {&loop, &model, &robot}) thread->join();
  publisher.finish();
  recorder.finish();
  std::filesystem::remove_all(folder);
  std::printf("%llu ticks, %lld frames, %lld onsets, %lld corrections, %lld frames recorded\n",
              static_cast<unsigned long long>(ticks), static_cast<long long>(pipeline.core().counters().frames),
              static_cast<long long>(publisher.tally().chatter_onsets),
              static_cast<long long>(publisher.tally().corrections),
              static_cast<long long>(recorder.counters().frames));
  EXPECT_GT(publisher.tally().corrections, 0);
  EXPECT_GT(recorder.counters().frames, 0);
  EXPECT_GT(looked, 0);
}

}  // namespace
}  // namespace stillcut
