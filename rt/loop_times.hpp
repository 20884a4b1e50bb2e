// What the loop knows of its own time, to be read at any time by any thread: lateness and length of its ticks, the
// stages within them, how long a decision took from the bus to the channels, and whether it keeps time.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "rt/latency_histogram.hpp"
#include "rt/periodic.hpp"
#include "rt/stage_times.hpp"

namespace stillcut {

// Written by the loop alone.
struct LoopTimes {
  LoopStatistics loop;
  StageTimes stages;
  LatencyHistogram decision;                // from a frame's stamp to the hand-over of what was decided on it
  std::atomic<std::uint64_t> times_out{0};  // times that it was out of time (rt/timekeeper.hpp)
  std::atomic<bool> in_time{true};
};

struct NamedLatency {
  const char* name = "";
  LatencySummary times;
};

// In the order of the work: wake-up, the six stages, the whole tick, decision.
inline constexpr std::size_t kNamedLatencies = kStages + 3;
inline std::array<NamedLatency, kNamedLatencies> named_latencies(const LoopTimes& times) noexcept {
  const auto stage = [&](const char* name, Stage which) {
    return NamedLatency{name, times.stages.histogram(which).summary()};
  };
  return {NamedLatency{"wake-up", times.loop.wakeup.summary()},
          stage("receive", Stage::receive),
          stage("decode", Stage::decode),
          stage("filter", Stage::filter),
          stage("transform", Stage::transform),
          stage("decide", Stage::decide),
          stage("hand-over", Stage::hand_over),
          NamedLatency{"tick", times.loop.execution.summary()},
          NamedLatency{"decision", times.decision.summary()}};
}

}  // namespace stillcut
