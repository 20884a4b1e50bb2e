// What the core knows at a moment, for onlookers: taken on the loop's thread (or during playback) and passed on by
// value.
#pragma once

#include <cstdint>

#include "drivers/can/decoder.hpp"
#include "rt/core.hpp"

namespace stillcut {

struct LoopView {
  std::int64_t now_ns = 0;  // data time; 0: no frame yet
  RuntimeMode mode = RuntimeMode::shadow;
  MonitorView monitor;
  CoreCounters core;
  DecoderCounters decoder;
  double axial_depth = 0.0;           // m
  double feed_direction = 0.0;        // rad
  bool has_lobes = false;             // a diagram that fits the posture is in use
  double margin = 0.0;                // a_lim / a - 1; NaN unknown
  double depth_limit = 0.0;           // m, at the present speed; NaN unknown
  double predicted_chatter_hz = 0.0;  // where the lobes expect it at the present speed; NaN unknown
};

// Real-time: no allocation, no lock, no system call. decoder: the counters of the frames that went in.
LoopView view_of(const Core& core, const DecoderCounters& decoder) noexcept;

}  // namespace stillcut
