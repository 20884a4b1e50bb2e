#include "tools/replay_trace.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace stillcut {

TraceCollector::TraceCollector(const Cell& cell) {
  std::array<char, 160> cut{};
  std::snprintf(cut.data(), cut.size(), "%s, %d-tooth tool of %.0f mm, %.1f mm deep",
                cell.material ? cell.material->name.c_str() : "cut", cell.tool->teeth, cell.tool->diameter * 1e3,
                cell.cut->axial_depth * 1e3);
  trace_.title = cut.data();
  trace_.subtitle = cell.file.string();
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
                          rad_s_to_rpm(view.speed), view.state, view.chatter_frequency_hz, view.decay_per_s});
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
