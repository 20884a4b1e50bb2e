// Chatter of the robot's structure: by mode coupling, or regenerative at a few hertz. It may stand beside the tool's,
// as an episode of its own.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "dsp/monitor.hpp"
#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

constexpr double kStructuralRelease = 0.25;  // of the limit in power
constexpr double kCyclesToEnd = 3.0;
constexpr double kOfOrder = 0.3;  // of the line's frequency: nearer to an order, its window hears that as well
// Once the orders are known and taken out, a mode of the map may be heard beside one; it has to last.
constexpr double kBesideOrder = 0.06, kOnMode = 0.12, kBesideOrderAsks = 2.0, kRevolutionsToTell = 24.0;
constexpr double kNearStructure = 0.25;  // of a mode's frequency
constexpr double kFallToDoubtStructure = 8.0, kDoubtfulAsks = 2.0, kNoMapAsks = 2.0, kUnexpectedAsks = 3.0;

}  // namespace

void Monitor::listen_to_structure(std::size_t index, std::int64_t stamp_ns, bool trusted) noexcept {
  SlowWatch& slow = sensors_[index].path.slow();
  if (view_.structural) {
    if (index == structural_sensor_ && trusted) follow_structural(slow, stamp_ns);
    return;
  }
  if (!trusted || gate_.state() != State::cut) {
    slow.forget_evidence();
    return;
  }
  const double turns_hz = spindle_hz();
  const auto from_order = [turns_hz](double hz) {
    return std::abs(hz - turns_hz * std::max(1.0, std::round(hz / turns_hz))) / hz;
  };
  SlowLine line = slow.best_line([&](double hz) { return from_order(hz) > kOfOrder; });
  double asked = 1.0;
  if (!(line.evidence > 0.0) && steady_s_ * turns_hz > kRevolutionsToTell) {
    line =
        slow.best_line([&](double hz) { return from_order(hz) > kBesideOrder && near_a_mode(modes(), hz, kOnMode); });
    asked = kBesideOrderAsks;
  }
  if (line.evidence < asked * structural_evidence_asked(sensors_[index].path, line.frequency_hz)) return;
  view_.structural = true;
  view_.structural_frequency_hz = line.frequency_hz;
  structural_sensor_ = index;
  structural_below_s_ = 0.0;
  char note[96];
  std::snprintf(note, sizeof note, "grows by %.2f a cycle", line.cycle_growth);
  emit(stamp_ns, EventType::chatter_onset, ChatterKind::structural, line.frequency_hz, note);
}

// A map knows where the robot's modes are; and a tool that leaves the cut now and then shakes the robot as well.
double Monitor::structural_evidence_asked(const SensorPath& path, double frequency_hz) const noexcept {
  if (mode_count_ == 0) return kNoMapAsks;
  if (near_a_mode(modes(), frequency_hz, kNearStructure)) {
    return path.fall() > kFallToDoubtStructure ? kDoubtfulAsks : 1.0;
  }
  return kUnexpectedAsks;
}

void Monitor::follow_structural(const SlowWatch& slow, std::int64_t stamp_ns) noexcept {
  double& hz = view_.structural_frequency_hz;
  const SlowLine line = slow.line_at(hz);
  if (std::abs(line.frequency_hz - hz) < 0.15 * hz) hz = line.frequency_hz;
  structural_below_s_ = line.ratio < kStructuralRelease ? structural_below_s_ + slow.step_s() : 0.0;
  if (structural_below_s_ > kCyclesToEnd / hz) end_structural(stamp_ns, "");
}

void Monitor::end_structural(std::int64_t stamp_ns, const char* why) noexcept {
  emit(stamp_ns, EventType::chatter_end, ChatterKind::structural, view_.structural_frequency_hz, why);
  view_.structural = false;
  view_.structural_frequency_hz = kNaN;
}

}  // namespace stillcut
