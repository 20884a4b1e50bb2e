#include "tools/hil_score.hpp"

#include <algorithm>
#include <cmath>

namespace stillcut {
namespace {

// An alarm belongs to a spell from a little before it: an accelerometer hears a fraction of the micrometres at which
// the truth begins, and an end is told a little later.
constexpr double kLead = 0.3, kTail = 0.3;         // s
constexpr double kFullDepth = 0.9, kStill = 0.05;  // share of the depth that the spell began with; s it lasted

double time_of(const Event& event, const VirtualMachine& machine) {
  return static_cast<double>(event.stamp_ns - machine.origin_ns()) * 1e-9;
}

bool belongs(double time, const ChatterSpell& spell) {
  return time >= spell.start - kLead && time <= spell.end + kTail;
}

// Onsets; a kind told later belongs to the same one.
std::vector<double> onset_times(const VirtualMachine& machine, std::span<const Event> events) {
  std::vector<double> times;
  bool open = false;
  for (const Event& event : events) {
    if (event.type == EventType::chatter_onset && !open) times.push_back(time_of(event, machine));
    if (event.type == EventType::chatter_onset) open = true;
    if (event.type == EventType::chatter_end) open = false;
  }
  return times;
}

// As long as the feed goes on; without it the tool only rubs.
double depth_at(const VirtualMachine& machine, double time) {
  const auto& moments = machine.moments();
  if (moments.empty()) return 0.0;
  const auto at = static_cast<std::size_t>(std::max(time, 0.0) * 1e3);
  const MachineMoment& moment = moments[std::min(at, moments.size() - 1)];
  return moment.removal_rate > 0.0 ? moment.axial_depth : 0.0;
}

// Died down by itself or by the correction, not because the tool left the part or the program took less.
bool ended_in_the_cut(const VirtualMachine& machine, const ChatterSpell& spell) {
  const double depth = kFullDepth * depth_at(machine, spell.start);
  return spell.died_down && depth_at(machine, spell.end) >= depth && depth_at(machine, spell.end - kStill) >= depth &&
         depth > 0.0;
}

}  // namespace

HilScore score_run(const VirtualMachine& machine, std::span<const Event> events) {
  HilScore score;
  score.spells = machine.truth().spells();
  for (const ChatterSpell& spell : score.spells) score.chatter_s += spell.end - spell.start;
  const std::vector<double> onsets = onset_times(machine, events);
  for (const double onset : onsets) {
    const bool justified = std::any_of(score.spells.begin(), score.spells.end(),
                                       [&](const ChatterSpell& spell) { return belongs(onset, spell); });
    score.false_alarms += justified ? 0 : 1;
  }
  if (!score.spells.empty()) {
    const ChatterSpell& first = score.spells.front();
    const auto alarm = std::find_if(onsets.begin(), onsets.end(), [&](double onset) { return belongs(onset, first); });
    score.detected = alarm != onsets.end();
    if (*score.detected) score.detection_ms = 1e3 * (*alarm - first.start);
    score.suppressed = std::all_of(score.spells.begin(), score.spells.end(),
                                   [&](const ChatterSpell& spell) { return ended_in_the_cut(machine, spell); });
    if (*score.suppressed && *score.detected) score.suppression_ms = 1e3 * (score.spells.back().end - *alarm);
  }
  for (const Event& event : events)
    score.corrections += event.type == EventType::correction && std::isfinite(event.spindle_speed_rpm) ? 1 : 0;
  score.peak_displacement_um = 1e6 * machine.peak_displacement();
  score.stopped = machine.controller().stopped();
  constexpr double kMm3 = 1e9, kMinute = 60.0;
  if (machine.cutting_time() > 0.0)
    score.removed_mm3_per_min = kMm3 * kMinute * machine.removed_volume() / machine.cutting_time();
  score.lengths = machine.surface().lengths();
  score.roughness = mean_of(score.lengths);
  return score;
}

}  // namespace stillcut
