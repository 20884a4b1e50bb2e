// Our ring beside boost::lockfree::spsc_queue, between two threads, in one run: items of 64 bytes, 1024 slots.
// Throughput (a stream of items) and round trip (one item there and one back). Both queues are measured in many short
// turns in random order, so that whatever else the machine does falls on both; what counts is the ratio of the medians.
//
//   bench_ring                                    a table and the ratios
//   bench_ring --benchmark_repetitions=101        any option of Google Benchmark
#include <benchmark/benchmark.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <boost/lockfree/spsc_queue.hpp>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "rt/ring.hpp"
#include "rt/thread.hpp"

namespace {

constexpr std::size_t kSlots = 1024;
constexpr std::uint64_t kStream = 200'000, kRoundTrips = 20'000;
constexpr std::uint64_t kWarmUp = 2 * kSlots;  // untimed: both sides run, every slot has been touched

struct Item {
  std::array<std::uint64_t, 8> words;
};
static_assert(sizeof(Item) == 64);

struct Ours {
  stillcut::Ring<Item> queue{kSlots};
};
struct Boost {
  boost::lockfree::spsc_queue<Item> queue{kSlots};
};

// Waits actively, as a latency measurement must, but lets another thread in now and then should there be one processor
// for both sides.
template <typename Attempt>
void insist(Attempt&& attempt) {
  for (int tries = 1; !attempt(); ++tries) {
    if (tries % 1024 == 0) std::this_thread::yield();
  }
}

void check(benchmark::State& state, std::uint64_t sum, std::uint64_t items) {
  if (sum != items * (items - 1) / 2) state.SkipWithError("items were lost or changed");
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Each side on a processor of its own and, where permitted, ahead of ordinary work for the few milliseconds of a turn:
// on a busy machine one side would otherwise wait for the other to be scheduled, and nothing else would be measured.
std::vector<int> two_processors() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  sched_getaffinity(0, sizeof allowed, &allowed);
  std::vector<int> found;
  for (int cpu = 0; cpu < CPU_SETSIZE && found.size() < 2; ++cpu) {
    if (CPU_ISSET(cpu, &allowed)) found.push_back(cpu);
  }
  return found.size() == 2 ? found : std::vector<int>{-1, -1};
}

template <typename First, typename Second>
void run_both(First first, Second second) {
  static const std::vector<int> cpus = two_processors();
  stillcut::RealTimeThread one{{.priority = 10, .cpu = cpus[0], .lock_memory = false}, first};
  stillcut::RealTimeThread other{{.priority = 10, .cpu = cpus[1], .lock_memory = false}, second};
}

template <typename Queue>
void throughput(benchmark::State& state) {
  for (auto _ : state) {
    Queue ring;
    std::uint64_t sum = 0;
    double seconds = 0.0;
    run_both(
        [&] {
          for (std::uint64_t i = 0; i < kStream; ++i) {
            const Item item{{i}};
            insist([&] { return ring.queue.push(item); });
          }
        },
        [&] {
          Item item{};
          std::chrono::steady_clock::time_point start;
          for (std::uint64_t i = 0; i < kStream; ++i) {
            insist([&] { return ring.queue.pop(item); });
            sum += item.words[0];
            if (i + 1 == kWarmUp) start = std::chrono::steady_clock::now();
          }
          seconds = seconds_since(start);
        });
    state.SetIterationTime(seconds / (kStream - kWarmUp));
    check(state, sum, kStream);
  }
}

template <typename Queue>
void round_trip(benchmark::State& state) {
  for (auto _ : state) {
    Queue there, back;
    std::uint64_t sum = 0;
    double seconds = 0.0;
    run_both(
        [&] {
          Item item{};
          for (std::uint64_t i = 0; i < kRoundTrips; ++i) {
            insist([&] { return there.queue.pop(item); });
            insist([&] { return back.queue.push(item); });
          }
        },
        [&] {
          Item item{};
          std::chrono::steady_clock::time_point start;
          for (std::uint64_t i = 0; i < kRoundTrips; ++i) {
            const Item sent{{i}};
            insist([&] { return there.queue.push(sent); });
            insist([&] { return back.queue.pop(item); });
            sum += item.words[0];
            if (i + 1 == kWarmUp) start = std::chrono::steady_clock::now();
          }
          seconds = seconds_since(start);
        });
    state.SetIterationTime(seconds / (kRoundTrips - kWarmUp));
    check(state, sum, kRoundTrips);
  }
}

// Collects the time of every repetition; the medians are taken at the end.
class Medians : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      failed_ = failed_ || run.error_occurred;
      if (run.run_type == Run::RT_Iteration) times_ns_[run.run_name.function_name].push_back(run.GetAdjustedRealTime());
    }
  }
  [[nodiscard]] bool failed() const { return failed_; }
  [[nodiscard]] std::size_t turns(const std::string& name) const { return times_ns_.at(name).size(); }
  [[nodiscard]] bool has(const std::string& name) const { return times_ns_.count(name) != 0; }
  double median_ns(const std::string& name) {
    std::vector<double>& times = times_ns_.at(name);
    const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
    std::nth_element(times.begin(), middle, times.end());
    return *middle;
  }

 private:
  std::map<std::string, std::vector<double>> times_ns_;
  bool failed_ = false;
};

}  // namespace

int main(int count, char** arguments) {
  std::vector<std::string> options{arguments[0], "--benchmark_repetitions=41",
                                   "--benchmark_enable_random_interleaving=true"};
  options.insert(options.end(), arguments + 1, arguments + count);
  std::vector<char*> pointers;
  for (std::string& option : options) pointers.push_back(option.data());
  int pointer_count = static_cast<int>(pointers.size());
  benchmark::Initialize(&pointer_count, pointers.data());
  if (benchmark::ReportUnrecognizedArguments(pointer_count, pointers.data())) return 2;

  benchmark::RegisterBenchmark("throughput/ours", throughput<Ours>)->UseManualTime()->Iterations(1);
  benchmark::RegisterBenchmark("throughput/boost", throughput<Boost>)->UseManualTime()->Iterations(1);
  benchmark::RegisterBenchmark("round trip/ours", round_trip<Ours>)->UseManualTime()->Iterations(1);
  benchmark::RegisterBenchmark("round trip/boost", round_trip<Boost>)->UseManualTime()->Iterations(1);
  Medians medians;
  benchmark::RunSpecifiedBenchmarks(&medians);
  if (medians.failed()) {
    std::fprintf(stderr, "bench_ring: items were lost or changed\n");
    return 1;
  }
  std::printf(
      "ring, 64 B items, 1024 slots, two threads (medians)      ours     boost   boost/ours (above 1: ours is "
      "ahead)\n");
  for (const std::string what : {"throughput", "round trip"}) {
    if (!medians.has(what + "/ours") || !medians.has(what + "/boost")) continue;
    const double ours = medians.median_ns(what + "/ours"), boost = medians.median_ns(what + "/boost");
    std::printf("  %-10s of %3zu turns each, ns an item %14.1f %9.1f %9.2f\n", what.c_str(),
                medians.turns(what + "/ours"), ours, boost, boost / ours);
  }
  return 0;
}
