#include "tools/replay_trace.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stillcut {

TraceCollector::TraceCollector(const Cell& cell) {
  trace_.title = cell.file.filename().string();
  trace_.sample_rate_hz = cell.can->accelerometers.front().sample_rate_hz;
  trace_.teeth = cell.tool->teeth;
  trace_.min_speed_rpm = rad_s_to_rpm(cell.spindle->min_speed);
  trace_.max_speed_rpm = rad_s_to_rpm(cell.spindle->max_speed);
}

void TraceCollector::add(const Pipeline& pipeline) {
  const Decoded& decoded = pipeline.decoded();
  const std::int64_t origin_ns = pipeline.core().origin_ns();
  for (int b = 0; b < decoded.blocks; ++b) {
    const SampleBlock& block = decoded.block[b];
    if (block.sensor != 0) continue;
    const double first_s =
        static_cast<double>(block.stamp_ns - origin_ns) * 1e-9 - (block.samples - 1) / trace_.sample_rate_hz;
    if (axis_[0].empty() && axis_[1].empty() && axis_[2].empty()) trace_.start_s = first_s;
    for (int a = 0; a < kMaxAxes; ++a) {
      if ((block.axes_present >> a & 1U) == 0) continue;
      // Lost frames are shown as gaps, in their place; a counter that tells of more than fit the time is not believed.
      const double until_here = std::max(0.0, (first_s - trace_.start_s) * trace_.sample_rate_hz + 1.0);
      const double lost = std::min(static_cast<double>(std::int64_t{block.frames_lost} * block.samples),
                                   std::max(0.0, until_here - static_cast<double>(axis_[a].size())));
      axis_[a].insert(axis_[a].end(), static_cast<std::size_t>(lost), std::numeric_limits<float>::quiet_NaN());
      axis_[a].insert(axis_[a].end(), block.acceleration[a].begin(), block.acceleration[a].begin() + block.samples);
    }
  }
  const MonitorView& view = pipeline.core().view();
  if (view.stamp_ns == last_view_ns_) return;
  last_view_ns_ = view.stamp_ns;
  trace_.trace.push_back({static_cast<double>(view.stamp_ns - origin_ns) * 1e-9, view.indicator,
                          rad_s_to_rpm(view.speed), view.state, view.chatter_frequency_hz});
}

void TraceCollector::add(const Event& event, std::int64_t origin_ns) {
  trace_.events.push_back({static_cast<double>(event.stamp_ns - origin_ns) * 1e-9, event.type, event.kind,
                           event.frequency_hz, event.spindle_speed_rpm});
}

ReplayTrace TraceCollector::finish() {
  double largest = -1.0;
  for (auto& axis : axis_) {
    double mean = 0.0, square = 0.0, count = 0.0;
    for (const float x : axis) {
      if (!std::isfinite(x)) continue;
      mean += x;
      square += double{x} * x;
      count += 1.0;
    }
    if (count < 1.0) continue;
    const double variance = square / count - mean / count * (mean / count);
    if (variance > largest) {
      largest = variance;
      trace_.vibration = axis;
    }
  }
  return std::move(trace_);
}

}  // namespace stillcut
