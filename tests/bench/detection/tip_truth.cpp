#include "tests/bench/detection/tip_truth.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "dsp/numbers.hpp"
#include "models/machining.hpp"

namespace stillcut::detection {
namespace {

constexpr double kCycles = 4.0, kSlowCycles = 2.0;  // of the window; two put the zero of the window on a standing shift
constexpr int kMostRevolutions = 4;
constexpr double kLeastGain = 0.25;  // a line that nearly repeats every revolution is not amplified beyond this
constexpr std::size_t kStands_ms = 20;
constexpr std::size_t kAngles = 360;  // of a revolution, in between straight lines

using Complex = std::complex<double>;

struct Residual {
  std::vector<Complex> motion;  // x + i y
  std::size_t first = 0;
};

double turns_a_second(const TipMotion& motion) {
  return (motion.angle.back() - motion.angle.front()) / kTwoPi /
         (static_cast<double>(motion.angle.size() - 1) / motion.rate_hz);
}

// Fast growth needs few earlier revolutions, and is then soon free of what a change of depth left in them.
int revolutions_for(const TipMotion& motion, const TipLine& line) {
  const double a_turn = line.growth_per_s / turns_a_second(motion);
  return a_turn > 0.0 ? std::clamp(static_cast<int>(1.0 / a_turn), 1, kMostRevolutions) : kMostRevolutions;
}

Residual without_revolutions(const TipMotion& motion, const TipLine& line) {
  const std::size_t n = motion.x.size();
  Residual left;
  left.motion.resize(n);
  const int revolutions = line.slow ? 0 : revolutions_for(motion, line);
  std::vector<std::size_t> past(static_cast<std::size_t>(revolutions), 0);
  for (std::size_t i = 0; i < n; ++i) {
    const Complex now{motion.x[i], motion.y[i]};
    Complex mean = 0.0;
    if (motion.angle[i] - motion.angle[0] < kTwoPi * revolutions) {
      left.first = i + 1;
      continue;
    }
    for (int r = 0; r < revolutions; ++r) {
      const double wanted = motion.angle[i] - kTwoPi * (r + 1);
      std::size_t& at = past[static_cast<std::size_t>(r)];
      while (motion.angle[at + 1] <= wanted) ++at;
      const double part = (wanted - motion.angle[at]) / (motion.angle[at + 1] - motion.angle[at]);
      const Complex a{motion.x[at], motion.y[at]}, b{motion.x[at + 1], motion.y[at + 1]};
      mean += a + part * (b - a);
    }
    left.motion[i] = revolutions > 0 ? now - mean / static_cast<double>(revolutions) : now;
  }
  return left;
}

// What subtraction and window make of a line of amplitude 1 that grows as theory says.
double gain_of(const TipMotion& motion, const TipLine& line, double window_s) {
  double gain = 1.0;
  if (!line.slow) {
    const int revolutions = revolutions_for(motion, line);
    const Complex turn = std::exp(Complex{line.growth_per_s, kTwoPi * line.frequency_hz} / turns_a_second(motion));
    Complex mean = 0.0, before = 1.0;
    for (int r = 0; r < revolutions; ++r) mean += before /= turn;
    gain = std::max(kLeastGain, std::abs(1.0 - mean / static_cast<double>(revolutions)));
  }
  double sum = 0.0, weights = 0.0;
  for (int i = 0; i <= 64; ++i) {
    const double at = i / 64.0 - 0.5, weight = 0.5 + 0.5 * std::cos(kTwoPi * at);
    sum += weight * std::exp(line.growth_per_s * window_s * at);
    weights += weight;
  }
  return gain * sum / weights;
}

struct Phasors {
  Complex x, y;
};

Phasors phasors_at(const TipMotion& motion, const Residual& left, double hz, double at, double window_s) {
  const double centre = at * motion.rate_hz, half = 0.5 * window_s * motion.rate_hz;
  const auto from = static_cast<long>(std::ceil(centre - half)), to = static_cast<long>(std::floor(centre + half));
  if (from < static_cast<long>(left.first) || to >= static_cast<long>(left.motion.size())) return {};
  const Complex step = std::polar(1.0, -kTwoPi * hz / motion.rate_hz);
  Complex turn = std::polar(1.0, -kTwoPi * hz * static_cast<double>(from) / motion.rate_hz);
  Phasors sum;
  double weights = 0.0;
  for (long i = from; i <= to; ++i, turn *= step) {
    const double weight = 0.5 + 0.5 * std::cos(0.5 * kTwoPi * (static_cast<double>(i) - centre) / half);
    const Complex& value = left.motion[static_cast<std::size_t>(i)];
    sum.x += weight * value.real() * turn;
    sum.y += weight * value.imag() * turn;
    weights += weight;
  }
  return {2.0 / weights * sum.x, 2.0 / weights * sum.y};
}

double window_of(const TipLine& line) { return (line.slow ? kSlowCycles : kCycles) / line.frequency_hz; }

}  // namespace

void remove_repetition(TipMotion& motion, double from, double to, const std::vector<double>& share) {
  std::vector<Complex> sum(kAngles), wave(kAngles);
  std::vector<double> weight(kAngles);
  const auto place = [&](std::size_t i) {  // among the angles, with a part of one
    const double turns = motion.angle[i] / kTwoPi;
    return static_cast<double>(kAngles) * (turns - std::floor(turns));
  };
  const auto last = std::min(motion.x.size(), static_cast<std::size_t>(to * motion.rate_hz));
  for (auto i = static_cast<std::size_t>(from * motion.rate_hz); i < last; ++i) {
    const auto at = static_cast<std::size_t>(place(i) + 0.5) % kAngles;
    sum[at] += Complex{motion.x[i], motion.y[i]};
    weight[at] += 1.0;
  }
  for (std::size_t k = 0; k < kAngles; ++k)
    wave[k] = weight[k] > 0.0 ? sum[k] / weight[k] : wave[(k + kAngles - 1) % kAngles];
  for (std::size_t i = 0; i < motion.x.size(); ++i) {
    const double at = place(i);
    const auto low = static_cast<std::size_t>(at) % kAngles;
    const Complex expected = share[i] * (wave[low] + (at - std::floor(at)) * (wave[(low + 1) % kAngles] - wave[low]));
    motion.x[i] -= expected.real();
    motion.y[i] -= expected.imag();
  }
}

std::vector<double> line_amplitude(const TipMotion& motion, const TipLine& line) {
  const Residual left = without_revolutions(motion, line);
  const double window_s = window_of(line), gain = gain_of(motion, line, window_s);
  std::vector<double> amplitude(static_cast<std::size_t>(1e3 * static_cast<double>(motion.x.size()) / motion.rate_hz));
  for (std::size_t ms = 0; ms < amplitude.size(); ++ms) {
    const Phasors p = phasors_at(motion, left, line.frequency_hz, 1e-3 * static_cast<double>(ms), window_s);
    amplitude[ms] = std::sqrt(std::norm(p.x) + std::norm(p.y)) / gain;
  }
  return amplitude;
}

double line_frequency(const TipMotion& motion, const TipLine& line, double at, double length) {
  const Residual left = without_revolutions(motion, line);
  const double window_s = window_of(line), step = 0.25 / line.frequency_hz;
  Complex turned = 0.0;
  Phasors before = phasors_at(motion, left, line.frequency_hz, at - 0.5 * length, window_s);
  for (double t = at - 0.5 * length + step; t <= at + 0.5 * length; t += step) {
    const Phasors now = phasors_at(motion, left, line.frequency_hz, t, window_s);
    turned += now.x * std::conj(before.x) + now.y * std::conj(before.y);
    before = now;
  }
  return turned == Complex{} ? kNaN : line.frequency_hz + std::arg(turned) / (kTwoPi * step);
}

double forced_amplitude(const TipMotion& motion, double from, double to) {
  const auto first = static_cast<std::size_t>(from * motion.rate_hz);
  const auto last = std::min(motion.x.size(), static_cast<std::size_t>(to * motion.rate_hz));
  double x = 0.0, y = 0.0, square = 0.0;
  const auto n = static_cast<double>(last - first);
  for (std::size_t i = first; i < last; ++i) {
    x += motion.x[i];
    y += motion.y[i];
    square += motion.x[i] * motion.x[i] + motion.y[i] * motion.y[i];
  }
  return std::sqrt(2.0 * std::max(0.0, square / n - (x * x + y * y) / (n * n)));
}

Rise rise_of(const std::vector<double>& amplitude, double limit, double proof, double from) {
  std::size_t stood = 0;
  for (auto ms = static_cast<std::size_t>(1e3 * from); ms < amplitude.size(); ++ms) {
    stood = amplitude[ms] >= proof ? stood + 1 : 0;
    if (stood < kStands_ms) continue;
    const std::size_t proved = ms + 1 - kStands_ms;
    std::size_t start = proved;
    while (start > 0 && 1e-3 * static_cast<double>(start) > from && amplitude[start - 1] >= limit) --start;
    return {1e-3 * static_cast<double>(start), 1e-3 * static_cast<double>(proved)};
  }
  return {kNaN, kNaN};
}

}  // namespace stillcut::detection
