// Gathers during a playback what its picture shows: the strongest axis of the first accelerometer and the monitor's
// view.
#pragma once

#include "drivers/files/cell.hpp"
#include "tools/pipeline.hpp"
#include "tools/plot_replay.hpp"

namespace stillcut {

class TraceCollector {
 public:
  explicit TraceCollector(const Cell& cell);

  void add(const Pipeline& pipeline);
  void add(const Event& event, std::int64_t origin_ns);
  // The picture's data; the vibration of the axis with the largest rms.
  ReplayTrace finish();

 private:
  ReplayTrace trace_;
  std::array<std::vector<float>, kMaxAxes> axis_;
  std::int64_t last_view_ns_ = 0;
};

}  // namespace stillcut
