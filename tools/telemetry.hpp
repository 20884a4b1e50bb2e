// What onlookers are told beside events, corrections and status, made of what the loop has heard and of its view, in
// data time: the daemon does it live, playback does the same for a recording. One ordinary thread; no clock.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "drivers/files/cell.hpp"
#include "drivers/lcm/telemetry_messages.hpp"
#include "models/lobe_diagram.hpp"
#include "tools/loop_view.hpp"
#include "tools/sensor_stream.hpp"

namespace stillcut {

class Telemetry {
 public:
  using Tell = std::function<void(const TelemetryMessage&)>;

  // Throws InputError for a section that is missing.
  Telemetry(const Cell& cell, Tell tell);

  // Samples of one accelerometer; comes before the view that knows of them.
  void add(const SampleBlock& block);

  // Tells what is due: the monitor's view and spectra 20 times a second and the view at once when it says something
  // new, the diagram when it is another (at most five times a second) and every second. `lobes`: the newest of the
  // present posture; nullptr: none.
  void add(const LoopView& view, const LobeDiagram* lobes);

  // The sensors' part and what the newest view knows; the hops beyond it are the caller's.
  [[nodiscard]] HealthReport health(std::int64_t stamp_ns) const;

 private:
  void tell_diagram(const LoopView& view, const LobeDiagram* lobes);

  Tell tell_;
  std::vector<SensorStream> sensors_;
  LoopView view_;
  std::int64_t period_ = 0;  // of the reports, the newest that was told of
  std::int64_t diagram_told_ns_ = 0;
  std::int64_t diagram_from_ns_ = 0;  // usable_from_ns of that
  bool diagram_valid_ = false;
};

MonitorReport monitor_report(const LoopView& view, const LobeDiagram* lobes);

}  // namespace stillcut
