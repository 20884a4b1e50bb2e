#include "tests/tools/closed_loop/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rt/trajectory.hpp"

namespace stillcut::campaign {
namespace {

constexpr std::int64_t kCampaignOrigin = 1'700'000'000'000'000'000;
constexpr double kFastFrom_hz = 80.0;                     // as the truth's
constexpr double kFastWindow = 0.05, kSlowWindow = 0.25;  // s
constexpr double kVisible = 3e-6, kRinging = 0.2;  // m, s after the beginning of a spell: what the truth calls chatter
constexpr double kSameSetting = 0.005;             // relative
constexpr double kDown = 0.1;                      // of the peak
constexpr double kNoise = 2.0;                     // of what noise leaves in 95 % of the time
constexpr double kTimeConstants = 4.0, kRoom = 0.1;  // of the spindle; s
constexpr double kBack = 0.3, kDownFor = 0.2;        // of the peak, s: chatter that was down so long is back
constexpr double kSurelyDown = 1.0;                  // s
constexpr int kManyTimes = 2;
constexpr double kFloorFor = 4.0;    // s of the deep cut
constexpr double kBeforeExit = 0.4;  // s: the tool is still whole in the part

double seconds(std::int64_t stamp_ns) { return static_cast<double>(stamp_ns - kCampaignOrigin) * 1e-9; }

// Feed and direction move to their target in small steps, which the messages do not name: each counts as one setting.
Asked asked_by(const Correction& c) {
  Asked asked{seconds(c.stamp_ns), c.kind, 0.0};
  if (c.kind == CorrectionKind::spindle_speed) asked.value = rpm_to_rad_s(c.spindle_speed_target_rpm);
  if (c.kind == CorrectionKind::speed_variation) asked.value = c.speed_variation_ratio;
  return asked;
}

bool same(const Asked& a, const Asked& b) {
  return a.kind == b.kind &&
         std::abs(a.value - b.value) <= kSameSetting * std::max(std::abs(a.value), std::abs(b.value));
}

// The messages' changes of setting, until a stop.
std::vector<Asked> settings_of(const std::vector<Correction>& corrections) {
  std::vector<Asked> settings;
  for (const Correction& c : corrections) {
    if (c.mode != RuntimeMode::active) continue;
    const Asked asked = asked_by(c);
    const bool nothing_to_release = settings.empty() && asked.kind == CorrectionKind::release;
    if (nothing_to_release || (!settings.empty() && same(settings.back(), asked))) continue;
    settings.push_back(asked);
    if (asked.kind == CorrectionKind::stop_request) break;
  }
  return settings;
}

int distinct(const std::vector<Asked>& settings) {
  int count = 0;
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const auto seen = [&](const Asked& earlier) { return same(earlier, settings[i]); };
    const auto here = settings.begin() + static_cast<std::ptrdiff_t>(i);
    if (settings[i].kind != CorrectionKind::release && std::none_of(settings.begin(), here, seen)) ++count;
  }
  return count;
}

bool comes_again(const std::vector<Asked>& settings) {
  for (std::size_t i = 2; i < settings.size(); ++i)
    if (settings[i].kind != CorrectionKind::release && same(settings[i], settings[i - 2])) return true;
  return false;
}

struct Amplitude {
  std::vector<double> at_ms;
  std::vector<bool> unsettled;  // an entry, a step or a turn of the feed shows beside chatter

  [[nodiscard]] std::size_t index(double time) const {
    const double last = static_cast<double>(at_ms.size()) - 1.0;
    return static_cast<std::size_t>(std::clamp(1e3 * time, 0.0, last));
  }
  [[nodiscard]] double at(double time) const { return at_ms[index(time)]; }
  [[nodiscard]] double highest(double from, double to) const {
    double most = 0.0;
    for (std::size_t i = index(from); i < index(to); ++i)
      if (!unsettled[i]) most = std::max(most, at_ms[i]);
    return most;
  }
  [[nodiscard]] double share(double part, double from, double to) const {
    std::vector<double> values(at_ms.begin() + static_cast<std::ptrdiff_t>(index(from)),
                               at_ms.begin() + static_cast<std::ptrdiff_t>(index(to)));
    if (values.empty()) return kNaN;
    const auto nth = static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + nth, values.end());
    return values[static_cast<std::size_t>(nth)];
  }
};

// Amplitude at each millisecond, m.
Amplitude amplitude_of(const VirtualMachine& machine, bool fast) {
  const auto& ms = machine.truth().milliseconds();
  const auto window = static_cast<std::size_t>(1e3 * (fast ? kFastWindow : kSlowWindow));
  Amplitude amplitude{std::vector<double>(ms.size()), std::vector<bool>(ms.size())};
  double square = 0.0;
  int samples = 0;
  const auto squares = [&](std::size_t i) { return fast ? ms[i].fast_square : ms[i].square; };
  for (std::size_t i = 0; i < ms.size(); ++i) {
    square += squares(i);
    samples += ms[i].samples;
    if (i >= window) {
      square -= squares(i - window);
      samples -= ms[i - window].samples;
    }
    amplitude.unsettled[i] = ms[i].unsettled;
    amplitude.at_ms[i] = samples > 0 ? std::sqrt(2.0 * std::max(square, 0.0) / samples) : 0.0;
  }
  return amplitude;
}

// Spells of the truth that are more than a robot that rings after an entry or a step.
std::vector<ChatterSpell> chatter_of(const VirtualMachine& machine, const Amplitude& amplitude) {
  std::vector<ChatterSpell> spells = machine.truth().spells();
  std::erase_if(spells, [&](const ChatterSpell& spell) {
    const double from = spell.start + kRinging;
    return amplitude.highest(from, std::max(spell.end, from + 0.1)) < kVisible;
  });
  return spells;
}

// How often chatter came back after it had been down.
int times_back(const Amplitude& amplitude, double peak, double from, double until) {
  int times = 0, low = 0;
  for (double time = from; time < until; time += 1e-3) {
    const double now = amplitude.at(time);
    if (now > kBack * peak && low > static_cast<int>(1e3 * kDownFor)) ++times;
    if (now > kBack * peak) low = 0;
    if (now < kDown * peak) ++low;
  }
  return times;
}

double measured_speed(const VirtualMachine& machine, double time) {
  const auto& moments = machine.moments();
  return moments[std::min(static_cast<std::size_t>(1e3 * time), moments.size() - 1)].spindle_speed;
}

// Duration of the jerk-limited move from the speed at the first correction to the last speed asked for.
double move_duration(const RandomCell& cell, const VirtualMachine& machine, const std::vector<Asked>& asked) {
  const auto is_speed = [](const Asked& a) { return a.kind == CorrectionKind::spindle_speed; };
  const auto first = std::find_if(asked.begin(), asked.end(), is_speed);
  const auto last = std::find_if(asked.rbegin(), asked.rend(), is_speed);
  if (first == asked.end()) return 0.0;
  const VelocityPlan plan = plan_velocity({0.0, measured_speed(machine, first->time), 0.0}, last->value, 0.0,
                                          {cell.spindle.acceleration, cell.spindle.jerk});
  return plan.error == TrajectoryError::none ? plan.trajectory.duration() : 0.0;
}

// From when on the amplitude is below a level for a second at least and never again above another, s after `from`.
double down_after(const Amplitude& amplitude, double level, double back, double from, double until) {
  double since = from;  // below the level
  double down = RunMetrics::kFar;
  for (double time = from; time < until; time += 1e-3) {
    const double now = amplitude.at(time);
    if (now > level) since = time;
    if (now > back) down = RunMetrics::kFar;
    if (down == RunMetrics::kFar && time - since >= kSurelyDown) down = since - from;
  }
  return down;
}

void measure_amplitude(const RandomCell& cell, const Amplitude& amplitude, RunMetrics& run) {
  const double end = cell.duration - kBeforeExit;
  run.settled = amplitude.share(0.95, 0.5 * (cell.deep_from + end), end);
  if (cell.kind == CellClass::stable) return;
  run.sound = amplitude.highest(0.8, 1.2);
  run.peak = amplitude.highest(run.chattered ? run.chatter_from : cell.deeper_from, end);
  if (std::isnan(run.alarm)) return;
  run.at_alarm = amplitude.at(run.alarm);
  if (!run.asked.empty()) run.at_correction = amplitude.at(run.asked.front().time);
  run.times_back = times_back(amplitude, run.peak, run.alarm, end);
  const double level = kDown * run.peak, noise = std::fmax(level, kNoise * run.in_pocket);
  const double back = std::fmax(kBack * run.peak, noise);
  run.down_after = down_after(amplitude, level, back, run.alarm, end);
  run.down_to_noise_after = down_after(amplitude, noise, back, run.alarm, end);
  run.below_for_good_after = down_after(amplitude, level, level, run.alarm, end);
}

// What the noise of the force leaves of motion in the pocket: the same cut, its speed programmed, no monitor.
double floor_in_pocket(const RandomCell& cell, const Cell& milled, Scenario scenario) {
  scenario.spindle_speed = {{0.0, cell.pocket_speed}};
  scenario.duration = std::min(cell.duration, cell.deep_from + kFloorFor);
  VirtualMachine machine{milled, scenario, kCampaignOrigin};
  while (!machine.ended()) machine.advance();
  const Amplitude amplitude = amplitude_of(machine, !(cell.chatter_hz < kFastFrom_hz));
  return amplitude.share(0.95, cell.deep_from + 0.5 * kFloorFor, scenario.duration - kBeforeExit);
}

}  // namespace

RunMetrics measure(const RandomCell& cell, const VirtualMachine& machine, const Heard& heard, double in_pocket) {
  RunMetrics run;
  run.in_pocket = in_pocket;
  const Amplitude amplitude = amplitude_of(machine, !(cell.chatter_hz < kFastFrom_hz));
  const std::vector<ChatterSpell> spells = chatter_of(machine, amplitude);
  run.spells = static_cast<int>(spells.size());
  run.chattered = !spells.empty();
  if (run.chattered) {
    run.chatter_from = spells.front().start;
    run.chatter_hz = spells.front().frequency_hz;
    const bool down = std::all_of(spells.begin(), spells.end(), [&](const ChatterSpell& spell) {
      return spell.died_down && (spell.end < cell.duration - kBeforeExit || cell.kind == CellClass::stable);
    });
    run.ended = down ? spells.back().end : RunMetrics::kFar;
  }
  for (const Event& event : heard.events) {
    if (event.type != EventType::chatter_onset) continue;
    ++run.onsets;
    const double time = seconds(event.stamp_ns);
    if (std::isnan(run.alarm) && time >= cell.deeper_from) run.alarm = time;
  }
  run.asked = settings_of(heard.corrections);
  run.targets = distinct(run.asked);
  run.stopped = machine.controller().stopped();
  if (!heard.corrections.empty()) run.reason = heard.corrections.back().reason.data();
  for (const Correction& c : heard.corrections)
    if (run.stopped && c.kind == CorrectionKind::stop_request) run.reason = c.reason.data();
  run.allowed =
      move_duration(cell, machine, run.asked) + kTimeConstants * cell.controller.spindle_time_constant + kRoom;
  measure_amplitude(cell, amplitude, run);
  run.limit_cycle = comes_again(run.asked) || run.times_back >= kManyTimes;
  return run;
}

RunMetrics run_cell(const RandomCell& random, const std::filesystem::path& folder) {
  write_cell(random, folder);
  Cell known = read_cell(folder / "cell.toml", {.bus = false});
  known.mode = RuntimeMode::active;
  const Cell milled = read_cell(folder / "machine.toml", {.bus = false});
  const Scenario scenario = read_scenario(folder / "scenario.toml", milled);
  VirtualMachine machine{milled, scenario, kCampaignOrigin};
  const Heard heard = run_in_data_time(known, machine);
  return measure(random, machine, heard,
                 random.kind == CellClass::pocket ? floor_in_pocket(random, milled, scenario) : kNaN);
}

}  // namespace stillcut::campaign
