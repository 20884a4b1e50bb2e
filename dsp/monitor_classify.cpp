// Is a line the spindle's, or free of it? The half of the decision that looks at one line at one moment.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "dsp/monitor.hpp"
#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

constexpr double kLeastSteadiness = 0.08;  // of a line that has been there for more than the last quarter window
constexpr double kBasePeak = 1.5, kSameLine_hz = 8.0, kMovesMore = 1.5;  // of base_line
constexpr double kAccelerationCounts = 0.03;
constexpr double kLeastBefore = 0.25;               // amplitude one revolution before over that now
constexpr double kSettledRevolutions = 32.0;        // of constant speed and contact before a line on an order may count
constexpr double kEvenFall = 2.0, kEvenRise = 6.0;  // of the whole vibration's power in the last quarter of a second
constexpr std::int64_t kLongestSuspense_ns = 60'000'000;

}  // namespace

// The line's displacement over that of the forced vibration: what does not move the tool is no chatter, however clear
// the line. Where a heavy unbalance moves the sensor, the acceleration tells, with a thirtieth of its weight.
double Monitor::of_forced(const SensorPath& path, const Tone& tone) const noexcept {
  const double omega = 2.0 * std::numbers::pi * tone.frequency_hz;
  const double forced = std::sqrt(2.0) * path.filter().displacement(view_.speed);
  if (!(forced > 0.0)) return kInfinity;
  const double by_acceleration = tone.amplitude / (std::sqrt(2.0) * path.synchronous_level());
  return std::max(tone.amplitude / (omega * omega * forced), kAccelerationCounts * by_acceleration);
}

// Chatter shows in a whole row of lines, a spindle order apart. The one that moves the tool most, near a mode that is
// expected, is the chatter itself.
Tone Monitor::base_line(const SensorPath& path, int axis, const Tone& heard) const noexcept {
  const double least_apart_hz = std::max(kBasePeak * path.bin_hz(), spindle_hz());
  const auto moves = [](const Tone& tone) { return tone.amplitude / (tone.frequency_hz * tone.frequency_hz); };
  Tone base = heard;
  for (const ExpectedMode& mode : modes()) {
    const double mode_hz = mode.frequency_hz;
    if (std::abs(mode_hz - heard.frequency_hz) < least_apart_hz || !(mode_hz > settings_.watch.lowest_hz)) continue;
    const double order = std::round((mode_hz - heard.frequency_hz) / spindle_hz());
    const double near_hz = heard.frequency_hz + order * spindle_hz();
    if (order == 0.0 || std::abs(near_hz - mode_hz) > kNearAMode * mode_hz) continue;
    const Tone tone = analyse_tone(path.watch().window(axis), path.sample_rate_hz(), near_hz);
    if (std::abs(tone.frequency_hz - near_hz) < kSameLine_hz && moves(tone) > kMovesMore * moves(base)) base = tone;
  }
  return base;
}

// A line that moves against the orders may be the spindle that changes its speed: a reading since then must say no.
bool Monitor::speed_confirmed(std::int64_t since_ns) const noexcept {
  return !settings_.has_speed_signal || speed_.last_stamp_ns() >= since_ns ||
         newest_ns_ - since_ns > kLongestSuspense_ns;
}

// Whatever comes from the spindle repeats after a revolution, also where several orders run together in one window, and
// also while the filter has yet to learn it. Chatter between the orders does not: its phase turns.
Monitor::Suspect Monitor::classify(const SensorPath& path, const LineCandidate& candidate,
                                   const Tone& tone) const noexcept {
  Suspect suspect;
  suspect.frequency_hz = tone.frequency_hz;
  // What fills only the last quarter of the window has just begun: a knock, for all that can be told.
  if (tone.steadiness < kLeastSteadiness) return suspect;
  if (std::abs(tone.frequency_hz - candidate.frequency_hz) > 1.5 * path.bin_hz()) return suspect;
  const LineWatch& watch = path.watch();
  const auto window_ns = std::llround(1e9 / path.bin_hz());
  const auto revolution_ns = [](double speed) { return std::llround(2e9 * std::numbers::pi / speed); };
  double speed = speed_at(newest_ns_ - window_ns / 2);
  if (speed < settings_.gate.idle_speed) return suspect;
  speed = speed_at(newest_ns_ - (window_ns + revolution_ns(speed)) / 2);
  if (speed < settings_.gate.idle_speed) return suspect;
  const double spindle_hz = speed / (2.0 * std::numbers::pi);
  const double orders = tone.frequency_hz / spindle_hz;
  const double speed_error = 2.0 * orders * speed_uncertainty() / speed;  // in cycles of the line
  double allowed = kOnOrder_hz / spindle_hz + speed_error;
  if (revolution_ns(speed) < watch.longest_lag_s() * 1e9) {
    const double noise = 0.25 / std::sqrt(std::max(1.0, candidate.ratio * settings_.watch.limit));
    const Recurrence turned = recurrence(watch.kept(candidate.axis), watch.window_length(), path.sample_rate_hz(),
                                         tone.frequency_hz, 1.0 / spindle_hz);
    suspect.cycles = turned.cycles;
    allowed += noise;
    if (turned.before < kLeastBefore ||
        std::abs(std::remainder(orders - turned.cycles, 1.0)) > 0.1 + noise + speed_error) {
      return suspect;
    }
  } else {  // a slow spindle: more than is kept of the past
    suspect.cycles = std::remainder(orders, 1.0);
  }
  if (std::abs(suspect.cycles) > allowed) {
    suspect.line = Line::free;
  } else if (path.fall() < kEvenFall && path.rise() < kEvenRise && tone.growth_per_s > 0.0 &&
             stands_out_of_the_orders(path, candidate, spindle_hz)) {
    suspect.line = Line::on_order;
  }
  return suspect;
}

// On a spindle order a line may be forced. It counts only if it grows at constant speed while the other orders do not;
// where the teeth are known, the orders that they force: chatter off these has sidebands on the rest.
bool Monitor::stands_out_of_the_orders(const SensorPath& path, const LineCandidate& candidate,
                                       double spindle_hz) const noexcept {
  if (steady_s_ < std::max(0.3, kSettledRevolutions / spindle_hz)) return false;
  const auto own = static_cast<int>(std::lround(candidate.frequency_hz / spindle_hz));
  const double own_hz = own * spindle_hz;
  const int every = settings_.teeth > 1 && own % settings_.teeth != 0 ? settings_.teeth : 1;
  double others = 0.0;
  const auto orders = static_cast<int>(0.4 * path.sample_rate_hz() / spindle_hz);
  for (int order = every; order <= orders; order += every) {
    const double hz = order * spindle_hz;
    if (std::abs(hz - own_hz) >= 2.5 * path.bin_hz()) others = std::max(others, path.watch().ratio_at(hz));
  }
  return candidate.ratio > 4.0 * others;
}

}  // namespace stillcut
