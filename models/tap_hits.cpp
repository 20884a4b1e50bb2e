#include "models/tap_hits.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>

#include "models/sentence.hpp"

namespace stillcut {

namespace {

constexpr std::size_t kShortestRecord = 64;

std::size_t samples_during(double seconds, double sample_rate_hz) {
  return static_cast<std::size_t>(std::llround(seconds * sample_rate_hz));
}

bool quick_to_transform(std::size_t length) {
  if (length % 2 != 0) return false;
  for (const std::size_t factor : {2, 3, 5})
    while (length % factor == 0) length /= factor;
  return length == 1;
}

void require_channel(std::span<const double> values, const std::string& name) {
  const auto bad = std::ranges::find_if(values, [](double value) { return !std::isfinite(value); });
  if (bad != values.end())
    throw std::invalid_argument(sentence(name, " is not finite at sample ", bad - values.begin(), ": record again"));
  if (std::ranges::all_of(values, [](double value) { return value == 0.0; }))
    throw std::invalid_argument(name + " is zero throughout: check its cable, or leave the channel out");
}

bool overloaded(std::span<const double> values, double full_scale) {
  return std::ranges::any_of(values, [&](double value) { return std::abs(value) >= kEndOfRange * full_scale; });
}

}  // namespace

void require_tap_settings(const TapSettings& s) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(what);
  };
  require(s.force_axis >= 0 && s.force_axis <= 2, "the hammer's axis must be x, y or z");
  require(std::abs(s.force_sense) == 1.0, "the hammer's sense must be 1 or -1");
  require(std::isfinite(s.record_s) && s.record_s > 0.0, "a tap's record must be longer than 0 s");
  require(s.before_s >= 0.0 && s.before_s < 0.5 * s.record_s,
          "the time before a hit must be from 0 s to half of the record");
  require(s.trigger_n > 0.0 && s.least_peak_n >= s.trigger_n,
          "the trigger must be above 0 N, the least peak no less than the trigger");
  require(s.rebound_share > 0.0 && s.rebound_share < 1.0, "the share of a rebound must be between 0 and 1");
  require(s.force_full_scale_n > s.least_peak_n, "the hammer's full scale must be above the least peak");
  require(s.acceleration_full_scale_m_per_s2 > 0.0, "the accelerometer's full scale must be above 0 m/s^2");
  require(s.force_window_s > 0.0, "the force window must be longer than 0 s");
  require(s.end_weight > 0.0 && s.end_weight <= 1.0,
          "the exponential window's weight at the end must be above 0 and at most 1");
  require(s.highest_of_rate > 0.0 && s.highest_of_rate < 0.5,
          "the highest frequency must be below half of the sample rate");
}

const char* describe(TapFault fault) noexcept {
  switch (fault) {
    case TapFault::none:
      return "sound";
    case TapFault::force_overload:
      return "force overload: hit more softly or choose a wider range";
    case TapFault::response_overload:
      return "acceleration overload: hit more softly or choose a wider range";
    case TapFault::double_hit:
      return "double hit: let the hammer rebound freely, and the structure come to rest before the next hit";
    case TapFault::too_long:
      return "force lasts longer than its window: hit, do not push, or widen the window";
    case TapFault::too_weak:
      return "too little force: hit harder";
    case TapFault::cut_off:
      return "cut off: the recording must hold the whole record, from before the hit";
  }
  return "";
}

std::size_t record_samples(const TapSettings& settings, double sample_rate_hz) {
  std::size_t length = samples_during(settings.record_s, sample_rate_hz);
  if (length < kShortestRecord)
    throw std::invalid_argument(sentence("a tap's record of ", settings.record_s, " s has ", length,
                                         " samples: record at least ", kShortestRecord));
  while (!quick_to_transform(length)) --length;
  return length;
}

std::size_t samples_before(const TapSettings& settings, double sample_rate_hz) {
  return samples_during(settings.before_s, sample_rate_hz);
}

void require_sound_taps(const TapRecording& recording, const TapSettings& settings) {
  require_tap_settings(settings);
  if (!std::isfinite(recording.sample_rate_hz) || recording.sample_rate_hz <= 0.0)
    throw std::invalid_argument("the sample rate must be above 0 Hz");
  require_channel(recording.force, "force");
  bool any = false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::vector<double>& values = recording.acceleration[axis];
    if (values.empty()) continue;
    any = true;
    const std::string name = sentence("acceleration ", "xyz"[axis]);
    if (values.size() != recording.force.size())
      throw std::invalid_argument(sentence(name, " has ", values.size(), " samples, force has ", recording.force.size(),
                                           ": record them together"));
    require_channel(values, name);
  }
  if (!any) throw std::invalid_argument("no acceleration was recorded: name at least one axis");
  const auto [lowest, highest] = std::ranges::minmax(recording.force);
  if (-lowest > highest && -lowest >= settings.trigger_n)
    throw std::invalid_argument(sentence("force goes down to ", lowest, " N, up to ", highest,
                                         " N only: turn the hammer's sign, pressing is positive"));
}

std::vector<TapHit> find_hits(const TapRecording& recording, const TapSettings& settings) {
  const std::vector<double>& force = recording.force;
  const double rate = recording.sample_rate_hz;
  const std::size_t count = force.size(), length = record_samples(settings, rate),
                    before = samples_before(settings, rate);
  const double longest = settings.force_window_s * rate;
  // A pulse has ended only well below the trigger: noise on its flank is not a second hit.
  const double ended_n = 0.5 * settings.trigger_n;
  std::vector<TapHit> hits;
  std::size_t i = 0;
  while (i < count) {
    if (force[i] < settings.trigger_n) {
      ++i;
      continue;
    }
    TapHit hit{.at = i};
    std::size_t pulse_end = i;
    for (; pulse_end < count && force[pulse_end] >= ended_n; ++pulse_end)
      hit.peak_n = std::max(hit.peak_n, force[pulse_end]);
    const std::size_t begin = i - std::min(i, before), record_end = std::min(i + length - before, count);
    const double rebound_n = std::max(settings.trigger_n, settings.rebound_share * hit.peak_n);
    const auto part = [&](const std::vector<double>& values, std::size_t from) {
      const std::size_t to = std::max(from, record_end);
      return std::span{values}.subspan(from, to - from);
    };
    const auto response_overloaded = [&](const std::vector<double>& values) {
      return !values.empty() && overloaded(part(values, begin), settings.acceleration_full_scale_m_per_s2);
    };
    const auto told = [&](const std::vector<std::size_t>& overloads) {
      const auto first = std::ranges::lower_bound(overloads, begin);
      return first != overloads.end() && *first < record_end;
    };
    if (told(recording.force_overloads) || overloaded(part(force, begin), settings.force_full_scale_n))
      hit.fault = TapFault::force_overload;
    else if (told(recording.response_overloads) || std::ranges::any_of(recording.acceleration, response_overloaded))
      hit.fault = TapFault::response_overload;
    else if (std::ranges::any_of(part(force, pulse_end), [&](double value) { return value >= rebound_n; }))
      hit.fault = TapFault::double_hit;
    else if (static_cast<double>(pulse_end - i) > longest)
      hit.fault = TapFault::too_long;
    else if (hit.peak_n < settings.least_peak_n)
      hit.fault = TapFault::too_weak;
    else if (i < before || i + length - before > count)
      hit.fault = TapFault::cut_off;
    hits.push_back(hit);
    i = std::max(record_end, pulse_end);
    while (i < count && force[i] >= ended_n) ++i;  // the end of a pulse is not the beginning of a hit
  }
  return hits;
}

}  // namespace stillcut
