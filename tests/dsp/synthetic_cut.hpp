// A cut made of known parts, for tests of the chatter monitor: tooth harmonics and runout that follow the spindle
// angle, noise, knocks, and a chatter line that starts, grows and ends when the test says so. Not a model of milling:
// here the truth is set by hand. Times are seconds from the first sample.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "dsp/monitor.hpp"

namespace stillcut {

struct SyntheticChatter {
  double frequency_hz = 0.0;
  double start_s = 0.0;        // when it stands at 1 % of the forced amplitude
  double growth_per_s = 20.0;  // exponential, up to
  double largest = 1.5;        // times the forced amplitude
  double stop_s = 1e9;         // from here it decays
  double decay_per_s = 60.0;
  double sideband = 0.0;  // one tooth passing above: over the line's amplitude

  // Over the forced amplitude.
  [[nodiscard]] double amplitude(double t) const {
    if (frequency_hz <= 0.0 || t < start_s) return 0.0;
    const double at = std::min(t, stop_s);
    const double grown = std::min(largest, 0.01 * std::exp(growth_per_s * (at - start_s)));
    return grown * std::exp(-decay_per_s * (t - at));
  }
  [[nodiscard]] double reaches_s(double ratio) const { return start_s + std::log(ratio / 0.01) / growth_per_s; }
};

// A line of the robot's structure, a few hertz: it grows from cycle to cycle, stands, and dies.
struct SyntheticSlowLine {
  double frequency_hz = 0.0;
  double start_s = 0.0;  // when it stands at 1 % of its largest
  double cycle_growth = 1.3;
  double largest = 3.0;  // m/s^2
  double stop_s = 1e9;   // from here it decays
  double cycle_decay = 0.7;
  std::array<double, kMaxAxes> axes{1.0, 0.6, 0.3};

  // m/s^2
  [[nodiscard]] double amplitude(double t) const {
    if (frequency_hz <= 0.0 || t < start_s) return 0.0;
    const double at = std::min(t, stop_s);
    const double grown = std::min(1.0, 0.01 * std::pow(cycle_growth, frequency_hz * (at - start_s)));
    return largest * grown * std::pow(cycle_decay, frequency_hz * (t - at));
  }
  [[nodiscard]] double reaches_s(double acceleration) const {
    return start_s + std::log(acceleration / (0.01 * largest)) / (std::log(cycle_growth) * frequency_hz);
  }
};

struct SyntheticCut {
  double rate_hz = 25600.0;
  int axes = 3;
  int samples_per_frame = 10;
  double duration_s = 3.0;
  int teeth = 2;
  double forced = 10.0;  // amplitude of the first tooth harmonic, m/s^2
  double runout = 0.3;   // of the spindle orders between, relative to the tooth harmonics beside them
  double noise = 0.3;    // standard deviation in the cut, m/s^2
  double air = 0.2;      // share of forced signal and noise that remains out of the cut
  std::uint32_t seed = 1;
  std::function<double(double)> speed_rpm = [](double) { return 6000.0; };
  std::function<double(double)> depth = [](double t) { return t < 0.5 ? 0.0 : 1.0; };  // 0: air, 1: nominal
  SyntheticChatter chatter;
  SyntheticSlowLine slow;
  double gravity = 0.0;          // on the last axis, m/s^2
  std::vector<double> knocks_s;  // each rings a mode of 430 Hz and one of 1320 Hz, 3 % damped, to `knock` m/s^2
  double knock = 20.0;
  double speed_period_s = 0.02, speed_jitter_s = 0.0;
  std::function<bool(double)> speed_is_sent = [](double) { return true; };
  std::function<double(double, double)> speed_told = [](double, double rad_per_s) { return rad_per_s; };
  std::function<void(SampleBlock&, double)> spoil = [](SampleBlock&, double) {};
  std::function<bool(double)> frame_is_sent = [](double) { return true; };
  bool has_counter = true;
};

inline constexpr std::int64_t kSyntheticOrigin_ns = 1'700'000'000'000'000'000;

inline MonitorSettings monitor_settings(const SyntheticCut& cut) {
  MonitorSettings settings;
  settings.sensors = {{cut.rate_hz, static_cast<std::uint8_t>((1U << cut.axes) - 1U)}};
  settings.highest_speed = 24000.0 * std::numbers::pi / 30.0;
  return settings;
}

struct SyntheticLog {
  std::vector<SampleBlock> blocks;
  std::vector<SpindleReading> speeds;
};

inline SyntheticLog record(const SyntheticCut& cut) {
  constexpr int kOrders = 24;
  SyntheticLog log;
  std::mt19937 random{cut.seed};
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> any_phase{0.0, 2.0 * std::numbers::pi}, within{-1.0, 1.0};
  std::array<std::array<std::complex<double>, kOrders + 1>, kMaxAxes> parts{};
  std::array<double, kMaxAxes> chatter_phase{}, chatter_share{};
  for (int a = 0; a < kMaxAxes; ++a) {
    for (int h = 1; h <= kOrders; ++h) {
      const double tooth_harmonic = std::max(1.0, std::round(static_cast<double>(h) / cut.teeth));
      const double size = cut.forced / std::pow(tooth_harmonic, 1.2) * (h % cut.teeth == 0 ? 1.0 : cut.runout);
      const double amplitude = size * (1.0 + 0.3 * within(random));
      parts[a][h] = std::polar(amplitude, any_phase(random));
    }
    chatter_phase[a] = any_phase(random);
    chatter_share[a] = a == 0 ? 1.0 : 0.5 + 0.4 * within(random);
  }
  const auto nanoseconds = [](double s) { return kSyntheticOrigin_ns + std::llround(s * 1e9); };
  double angle = 0.0, chatter_angle = 0.0, next_speed_s = 0.0;
  const auto samples = static_cast<long>(cut.duration_s * cut.rate_hz);
  SampleBlock block;
  block.axes_present = static_cast<std::uint8_t>((1U << cut.axes) - 1U);
  std::uint32_t lost = 0;
  for (long n = 0; n < samples; ++n) {
    const double t = static_cast<double>(n) / cut.rate_hz;
    const double speed = cut.speed_rpm(t) * std::numbers::pi / 30.0;
    if (t >= next_speed_s) {
      next_speed_s += cut.speed_period_s;
      if (cut.speed_is_sent(t)) {
        const double told = cut.speed_told(t, speed);
        log.speeds.push_back({nanoseconds(t + cut.speed_jitter_s * 0.5 * (1.0 + within(random))), told});
      }
    }
    angle = std::remainder(angle + speed / cut.rate_hz, 2.0 * std::numbers::pi);
    chatter_angle += 2.0 * std::numbers::pi * cut.chatter.frequency_hz / cut.rate_hz;
    const double engaged = cut.air + (1.0 - cut.air) * cut.depth(t);
    const double grown = cut.forced * cut.chatter.amplitude(t);
    const double slow = cut.slow.amplitude(t), slow_angle = 2.0 * std::numbers::pi * cut.slow.frequency_hz * t;
    std::array<std::complex<double>, kOrders + 1> turn;
    turn[0] = 1.0;
    const std::complex<double> once = std::polar(1.0, angle);
    for (int h = 1; h <= kOrders; ++h) turn[h] = turn[h - 1] * once;
    double ringing = 0.0;
    for (const double knock_s : cut.knocks_s) {
      const double since = t - knock_s;
      if (since < 0.0 || since > 0.3) continue;
      for (const double f : {430.0, 1320.0}) {
        const double omega = 2.0 * std::numbers::pi * f;
        ringing += cut.knock * std::exp(-0.03 * omega * since) * std::sin(omega * since);
      }
    }
    for (int a = 0; a < cut.axes; ++a) {
      double x = cut.noise * std::max(engaged, 0.1) * normal(random) + ringing;
      for (int h = 1; h <= kOrders; ++h) {
        x += engaged * (turn[h].real() * parts[a][h].real() - turn[h].imag() * parts[a][h].imag());
      }
      x += grown * chatter_share[a] * std::sin(chatter_angle + chatter_phase[a]);
      if (cut.chatter.sideband > 0.0) {
        const double sideband_angle = chatter_angle + cut.teeth * angle;
        x += grown * cut.chatter.sideband * chatter_share[a] * std::sin(sideband_angle);
      }
      x += slow * cut.slow.axes[a] * std::sin(slow_angle + a);
      if (a == cut.axes - 1) x += cut.gravity;
      block.acceleration[a][block.samples] = static_cast<float>(x);
    }
    if (++block.samples == cut.samples_per_frame) {
      block.stamp_ns = nanoseconds(t);
      if (cut.frame_is_sent(t)) {
        block.frames_lost = cut.has_counter ? lost : 0;
        lost = 0;
        log.blocks.push_back(block);
        cut.spoil(log.blocks.back(), t);
      } else {
        ++lost;
      }
      block.samples = 0;
    }
  }
  std::stable_sort(log.speeds.begin(), log.speeds.end(),
                   [](const SpindleReading& a, const SpindleReading& b) { return a.stamp_ns < b.stamp_ns; });
  return log;
}

// Plays a log into a monitor as the daemon does: readings and frames in order of their stamps. `each(view)` sees the
// view after every frame.
template <typename Each>
std::vector<Event> play(const SyntheticLog& log, Monitor& monitor, Each&& each) {
  std::vector<Event> events;
  monitor.set_origin(kSyntheticOrigin_ns);
  std::size_t next_speed = 0;
  for (const SampleBlock& block : log.blocks) {
    for (; next_speed < log.speeds.size() && log.speeds[next_speed].stamp_ns <= block.stamp_ns; ++next_speed) {
      monitor.add_speed(log.speeds[next_speed]);
    }
    monitor.advance(block.stamp_ns);
    monitor.add_samples(block);
    events.insert(events.end(), monitor.events().begin(), monitor.events().end());
    monitor.clear_events();
    each(monitor.view());
  }
  return events;
}

inline std::vector<Event> play(const SyntheticCut& cut) {
  Monitor monitor{monitor_settings(cut)};
  return play(record(cut), monitor, [](const MonitorView&) {});
}

inline double seconds(const Event& event) { return static_cast<double>(event.stamp_ns - kSyntheticOrigin_ns) * 1e-9; }

inline std::vector<Event> only(const std::vector<Event>& events, EventType type) {
  std::vector<Event> found;
  std::copy_if(events.begin(), events.end(), std::back_inserter(found), [&](const Event& e) { return e.type == type; });
  return found;
}

}  // namespace stillcut
