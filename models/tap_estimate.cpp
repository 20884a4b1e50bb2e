#include "models/tap_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <numeric>
#include <stdexcept>
#include <string>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "dsp/numbers.hpp"
#include "models/machining.hpp"
#include "models/median.hpp"
#include "models/sentence.hpp"

namespace stillcut {

namespace {

constexpr double kExcitedShare = 0.01;  // of the highest power of force
constexpr double kLinesShare = 0.2;     // of the record: a force window up to this is short

// A value for each line, from the one after 0 Hz, of which an acceleration tells nothing.
struct TapSums {
  struct Axis {
    std::vector<double> response_power;
    ComplexValues cross;  // conj(F) X
  };
  std::vector<double> force_power;
  double force_noise_power = 0.0;  // what noise adds to the sum of that, of each line
  std::array<Axis, 3> axes;
  std::size_t hits = 0;
};

// Weights of the samples of a record.
struct TapWindows {
  std::vector<double> force, response;
};

// The exponential goes over both: then the estimate is the response at i w + s instead of i w, exactly.
TapWindows tap_windows(const TapSettings& settings, double rate, std::size_t length, double decay) {
  TapWindows windows{std::vector<double>(length), std::vector<double>(length)};
  const std::size_t before = samples_before(settings, rate);
  for (std::size_t n = 0; n < length; ++n) {
    const double exponential = std::exp(-decay * static_cast<double>(n) / rate);
    // In force windows after the hit: whole up to 1, gone from 1.5.
    const double t = (static_cast<double>(n) - static_cast<double>(before)) / (rate * settings.force_window_s);
    const double taper = std::clamp(2.0 * (t - 1.0), 0.0, 1.0);
    windows.response[n] = exponential;
    windows.force[n] = exponential * 0.5 * (1.0 + std::cos(0.5 * kTwoPi * taper));
  }
  return windows;
}

// At rest a sensor shows its offset, which for an accelerometer may be gravity. A hit leaves no velocity, so the mean
// acceleration is the offset; force has one sign, but is at rest most of the time.
std::array<double, 3> rest_of_accelerations(const std::array<std::vector<double>, 3>& acceleration) {
  std::array<double, 3> rest{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (const std::vector<double>& values = acceleration[axis]; !values.empty())
      rest[axis] = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  return rest;
}

class TapTransform {
 public:
  explicit TapTransform(std::size_t length) : weighted_(length) { fft_.SetFlag(Eigen::FFT<double>::HalfSpectrum); }

  const ComplexValues& operator()(std::span<const double> values, double rest, std::span<const double> weights) {
    for (std::size_t n = 0; n < weighted_.size(); ++n) weighted_[n] = (values[n] - rest) * weights[n];
    fft_.fwd(lines_, weighted_);
    return lines_;
  }

 private:
  Eigen::FFT<double> fft_;
  std::vector<double> weighted_;
  ComplexValues lines_;
};

void require_alike(std::span<const TapRecording> recordings) {
  if (recordings.empty()) throw std::invalid_argument("no recording of taps was given");
  const TapRecording& first = recordings.front();
  for (const TapRecording& other : recordings) {
    if (other.sample_rate_hz != first.sample_rate_hz)
      throw std::invalid_argument(sentence("recordings at ", first.sample_rate_hz, " Hz and ", other.sample_rate_hz,
                                           " Hz: estimate them apart"));
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (other.acceleration[axis].empty() != first.acceleration[axis].empty())
        throw std::invalid_argument(
            sentence("acceleration ", "xyz"[axis], " is in some recordings only: estimate them apart"));
  }
}

[[noreturn]] void refuse_all(std::span<const TapRecording> recordings, const TapEstimate& estimate,
                             const TapSettings& settings) {
  if (estimate.hits.empty()) {
    double highest = 0.0;
    for (const TapRecording& recording : recordings) highest = std::max(highest, std::ranges::max(recording.force));
    throw std::invalid_argument(sentence("no hit: force stays below the trigger of ", settings.trigger_n,
                                         " N, it reaches ", highest,
                                         " N; check the force's unit, hit harder or lower the trigger"));
  }
  std::string reasons;
  for (const TapHit& hit : estimate.hits) {
    const double at_s = static_cast<double>(hit.at) / recordings[hit.recording].sample_rate_hz;
    reasons += sentence(reasons.empty() ? "" : "; ", "at ", 1e-3 * std::round(1e3 * at_s), " s ");
    if (recordings.size() > 1) reasons += sentence("of recording ", hit.recording + 1, " ");
    reasons += describe(hit.fault);
  }
  throw std::invalid_argument("no hit can be used: " + reasons);
}

// What was estimated is accelerance at p = i w + s, p^2 times the receptance there.
ComplexValues receptance_at_shifted_lines(std::span<const double> frequencies_hz, ComplexValues accelerance,
                                          double decay) {
  for (std::size_t i = 0; i < accelerance.size(); ++i) {
    const std::complex<double> line(0.0, kTwoPi * frequencies_hz[i]), shift = line / (line + decay);
    accelerance[i] *= shift * shift;
  }
  return receptance_of(ResponseKind::accelerance, frequencies_hz, accelerance);
}

// Of force at rest, N: from the middle half of what lies about its median, as the hits are a small share of the time.
double noise_of_force(const std::vector<double>& force, double rest) {
  std::vector<double> off(force.size());
  std::ranges::transform(force, off.begin(), [&](double value) { return std::abs(value - rest); });
  return 1.4826 * median(std::move(off));
}

// Relative: what noise inside the force window adds to the force's transform, where the window is so short that many
// lines share it.
double shared_force_error(const TapSums& sums, const TapSettings& settings, double record_s) {
  if (!(settings.force_window_s < kLinesShare * record_s)) return 0.0;
  // Where the hammer excites: beyond, nothing is told anyway.
  const double least = kExcitedShare * std::ranges::max(sums.force_power);
  std::vector<double> power;
  std::ranges::copy_if(sums.force_power, std::back_inserter(power), [&](double value) { return value >= least; });
  const double usual = median(std::move(power));
  return usual > 0.0 ? std::sqrt(0.5 * sums.force_noise_power / (usual * static_cast<double>(sums.hits))) : 0.0;
}

// Sums over the sound hits of all recordings.
TapSums summed_over_hits(std::span<const TapRecording> recordings, std::span<const TapHit> hits,
                         const TapSettings& settings, std::size_t length, std::size_t lines, double decay) {
  const double rate = recordings.front().sample_rate_hz;
  const std::size_t before = samples_before(settings, rate);
  const TapWindows windows = tap_windows(settings, rate, length, decay);
  TapTransform transform(length);
  TapSums sums;
  sums.force_power.assign(lines, 0.0);
  sums.axes.fill(TapSums::Axis{std::vector<double>(lines, 0.0), ComplexValues(lines)});
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const TapRecording& recording = recordings[r];
    const double force_rest = median(recording.force), force_noise = noise_of_force(recording.force, force_rest);
    const std::array<double, 3> rest = rest_of_accelerations(recording.acceleration);
    for (const TapHit& hit : hits) {
      if (hit.recording != r || hit.fault != TapFault::none) continue;
      ++sums.hits;
      for (const double weight : windows.force) sums.force_noise_power += weight * weight * force_noise * force_noise;
      const auto record = [&](const std::vector<double>& values) {
        return std::span{values}.subspan(hit.at - before, length);
      };
      const ComplexValues force = transform(record(recording.force), force_rest, windows.force);
      for (std::size_t i = 0; i < lines; ++i) sums.force_power[i] += std::norm(force[i + 1]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (recording.acceleration[axis].empty()) continue;
        const ComplexValues& response = transform(record(recording.acceleration[axis]), rest[axis], windows.response);
        for (std::size_t i = 0; i < lines; ++i) {
          sums.axes[axis].response_power[i] += std::norm(response[i + 1]);
          sums.axes[axis].cross[i] += std::conj(force[i + 1]) * response[i + 1];
        }
      }
    }
  }
  return sums;
}

void estimate_axis(const TapSums& sums, std::size_t axis, const TapSettings& settings, TapEstimate& result) {
  const std::size_t lines = sums.force_power.size();
  ComplexValues h1(lines), h2(lines), hv(lines);
  for (std::size_t i = 0; i < lines; ++i) {
    const double xx = sums.axes[axis].response_power[i], ff = sums.force_power[i];
    const std::complex<double> fx = sums.axes[axis].cross[i];
    h1[i] = settings.force_sense * fx / ff;
    h2[i] = settings.force_sense * xx / std::conj(fx);
    hv[i] = settings.force_sense * fx / std::abs(fx) * std::sqrt(xx / ff);
    result.coherence[axis].push_back(sums.hits > 1 ? std::min(1.0, std::norm(fx) / (xx * ff)) : kNaN);
  }
  const auto column = static_cast<std::size_t>(settings.force_axis);
  const auto receptance = [&](ComplexValues accelerance) {
    return receptance_at_shifted_lines(result.h1.frequencies_hz, std::move(accelerance), result.added_decay_per_s);
  };
  result.h1.receptance[axis][column] = receptance(std::move(h1));
  result.h2.receptance[axis][column] = receptance(std::move(h2));
  result.hv.receptance[axis][column] = receptance(std::move(hv));
  if (sums.hits > 1)
    for (FrequencyResponse* response : {&result.h1, &result.h2, &result.hv})
      response->coherence[axis][column] = result.coherence[axis];
}

}  // namespace

TapEstimate estimate_taps(std::span<const TapRecording> recordings, const TapSettings& settings) {
  require_alike(recordings);
  TapEstimate result;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    require_sound_taps(recordings[r], settings);
    for (TapHit hit : find_hits(recordings[r], settings)) {
      hit.recording = r;
      result.hits.push_back(hit);
    }
  }
  const double rate = recordings.front().sample_rate_hz;
  const std::size_t length = record_samples(settings, rate);
  const auto lines = static_cast<std::size_t>(settings.highest_of_rate * static_cast<double>(length));
  result.resolution_hz = rate / static_cast<double>(length);
  result.added_decay_per_s = std::log(1.0 / settings.end_weight) * result.resolution_hz;
  for (std::size_t i = 0; i < lines; ++i)
    result.h1.frequencies_hz.push_back(static_cast<double>(i + 1) * result.resolution_hz);
  result.h1.added_decay_per_s = result.added_decay_per_s;
  const TapSums sums = summed_over_hits(recordings, result.hits, settings, length, lines, result.added_decay_per_s);
  if (sums.hits == 0) refuse_all(recordings, result, settings);
  result.hits_used = sums.hits;
  result.h1.force_error = shared_force_error(sums, settings, static_cast<double>(length) / rate);
  result.h2 = result.hv = result.h1;
  for (const double power : sums.force_power)
    result.force_spectrum.push_back(std::sqrt(power / static_cast<double>(sums.hits)) / rate);
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!recordings.front().acceleration[axis].empty()) estimate_axis(sums, axis, settings, result);
  for (const FrequencyResponse* response : {&result.h1, &result.h2, &result.hv}) require_sound_response(*response);
  return result;
}

Mode without_added_decay(const Mode& fitted, double added_decay_per_s) {
  const double w = fitted.natural_frequency, seen = fitted.damping_ratio * w, decay = seen - added_decay_per_s;
  if (decay <= 0.0)
    throw std::invalid_argument(sentence("the mode at ", w / kTwoPi, " Hz decays by ", seen,
                                         " 1/s, the exponential window alone by ", added_decay_per_s,
                                         " 1/s: record longer"));
  const double square = w * w - seen * seen + decay * decay;  // damped frequency squared, and the decay's own
  Mode mode = fitted;
  mode.natural_frequency = std::sqrt(square);
  mode.damping_ratio = decay / mode.natural_frequency;
  mode.stiffness = fitted.stiffness * square / (w * w);
  return mode;
}

}  // namespace stillcut
