#include "models/chatter_truth.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "models/machining.hpp"

namespace stillcut {
namespace {

constexpr double kMillisecond = 1e-3;
// How long a motion must last not to be ringing: the envelope's memory is more than half a period of its slowest.
struct Band {
  double ChatterTruth::Millisecond::*peak;
  std::size_t memory_ms, lasting_ms;
};
constexpr Band kAll{&ChatterTruth::Millisecond::peak, 80, 400}, kFast{&ChatterTruth::Millisecond::fast_peak, 20, 100};
constexpr double kFastFrom = 80.0;      // Hz
constexpr double kNotDecayed = 0.8;     // of the envelope, after that time
constexpr double kDiedDown = 0.1;       // of the peak
constexpr std::size_t kQuiet_ms = 100;  // below that for so long
constexpr std::size_t kKeptOf = 8;      // samples: what is left follows motions up to a kHz and a half
constexpr double kSpectrum = 0.5;       // s about the peak
constexpr double kLowestLine = 5.0, kHighestLine = 1500.0;  // Hz

using Milliseconds = std::vector<ChatterTruth::Millisecond>;

// A spell by the milliseconds' indices.
struct Found {
  std::size_t start, end, peak;
  bool died_down;
};

std::vector<double> envelope_of(const Milliseconds& ms, const Band& band) {
  std::vector<double> envelope(ms.size());
  for (std::size_t i = 0; i < ms.size(); ++i)
    for (std::size_t j = i < band.memory_ms ? 0 : i - band.memory_ms; j <= i; ++j)
      envelope[i] = std::max(envelope[i], ms[j].*band.peak);
  return envelope;
}

// Follows a spell from where it began to where it has been quiet for a while.
Found follow(const Milliseconds& ms, const std::vector<double>& height, const Band& band, std::size_t start,
             std::size_t certain) {
  std::size_t quiet = 0, j = start, peak = start;
  for (; j < ms.size() && quiet < kQuiet_ms; ++j) {
    if (ms[j].*band.peak > ms[peak].*band.peak) peak = j;
    const double low = std::max(ChatterTruth::kLimit, kDiedDown * ms[peak].*band.peak);
    quiet = height[j] < low && j > certain ? quiet + 1 : 0;
  }
  const bool died_down = quiet == kQuiet_ms;
  return {start, died_down ? std::max(start, j - kQuiet_ms - band.memory_ms) : ms.size(), peak, died_down};
}

std::vector<Found> find_spells(const Milliseconds& ms, const Band& band) {
  const std::vector<double> height = envelope_of(ms, band);
  const auto at = [&](std::size_t i) { return height.begin() + static_cast<std::ptrdiff_t>(i); };
  std::vector<Found> found;
  std::size_t begin = 0, settled = 0;  // since then: above the limit and undisturbed; settled
  for (std::size_t i = 0; i < ms.size(); ++i) {
    if (ms[i].unsettled) settled = i + 1;
    if (!(height[i] > ChatterTruth::kLimit) || ms[i].disturbed) begin = i;
    if (i < settled + band.memory_ms + band.lasting_ms) continue;
    const std::size_t from = i - band.lasting_ms;
    if (height[i] < kNotDecayed * height[from] || begin > from) continue;
    const auto start = static_cast<std::size_t>(std::min_element(at(begin), at(from) + 1) - height.begin());
    found.push_back(follow(ms, height, band, start, i));
    i = begin = settled = found.back().end + band.memory_ms;
  }
  return found;
}

}  // namespace

// Less the mean at this spindle angle in the revolutions before.
Eigen::Vector3d ChatterTruth::without_repetition(double angle, const Eigen::Vector3d& displacement) {
  past_.push_back({angle, displacement});
  if (angle - past_.front().angle < static_cast<double>(kRevolutions) * kTwoPi) return Eigen::Vector3d::Zero();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t r = 0; r < kRevolutions; ++r) {
    const double wanted = angle - static_cast<double>(r + 1) * kTwoPi;
    std::size_t& at = before_[r];
    while (past_[at + 1].angle <= wanted) ++at;
    const Sample &a = past_[at], &b = past_[at + 1];
    mean += a.displacement + (wanted - a.angle) / (b.angle - a.angle) * (b.displacement - a.displacement);
  }
  return displacement - mean / static_cast<double>(kRevolutions);
}

Eigen::Vector3d ChatterTruth::fast_part(const Eigen::Vector3d& motion, double step) {
  const double taken = -std::expm1(-kTwoPi * kFastFrom * step);
  Eigen::Vector3d rest = motion;
  for (Eigen::Vector3d& slow : slow_) {
    slow += taken * (rest - slow);
    rest -= slow;
  }
  return rest;
}

void ChatterTruth::add(double time, double spindle_angle, const Eigen::Vector3d& displacement, bool disturbed) {
  const Eigen::Vector3d motion = without_repetition(spindle_angle, displacement);
  const Eigen::Vector3d fast = fast_part(motion, time - time_);
  time_ = time;
  if (past_.size() % kKeptOf == 0)
    motion_.push_back({time, static_cast<float>(motion.x()), static_cast<float>(motion.y())});
  if (disturbed || past_.size() == 1) settled_from_ = spindle_angle + static_cast<double>(kRevolutions) * kTwoPi;
  const auto millisecond = static_cast<std::size_t>(time / kMillisecond);
  milliseconds_.resize(std::max(milliseconds_.size(), millisecond + 1));
  Millisecond& now = milliseconds_[millisecond];
  now.peak = std::max(now.peak, motion.norm());
  now.fast_peak = std::max(now.fast_peak, fast.norm());
  now.square += motion.squaredNorm();
  now.fast_square += fast.squaredNorm();
  ++now.samples;
  now.disturbed = now.disturbed || disturbed;
  now.unsettled = now.unsettled || spindle_angle < settled_from_;
}

double ChatterTruth::strongest_line_hz(double time) const {
  const auto from = std::lower_bound(motion_.begin(), motion_.end(), time - 0.5 * kSpectrum,
                                     [](const Unrepeated& sample, double t) { return sample.time < t; });
  const auto to = std::lower_bound(from, motion_.end(), time + 0.5 * kSpectrum,
                                   [](const Unrepeated& sample, double t) { return sample.time < t; });
  if (to - from < 16) return 0.0;
  const double start = from->time, length = (to - 1)->time - start, step = length / static_cast<double>(to - from - 1);
  double strongest = 0.0, found_hz = 0.0;
  for (double hz = kLowestLine; hz <= std::min(kHighestLine, 0.45 / step); hz += 1.0) {
    const std::complex<double> turn = std::polar(1.0, kTwoPi * hz * step);
    std::complex<double> phase = 1.0, x = 0.0, y = 0.0;
    for (auto sample = from; sample != to; ++sample, phase *= turn) {
      const double window = 0.5 - 0.5 * std::cos(kTwoPi * (sample->time - start) / length);
      x += window * sample->x * phase;
      y += window * sample->y * phase;
    }
    const double power = std::norm(x) + std::norm(y);
    if (power > strongest) strongest = power, found_hz = hz;
  }
  return found_hz;
}

std::vector<ChatterSpell> ChatterTruth::spells() const {
  std::vector<Found> found = find_spells(milliseconds_, kAll);
  const std::vector<Found> fast = find_spells(milliseconds_, kFast);
  found.insert(found.end(), fast.begin(), fast.end());
  std::sort(found.begin(), found.end(), [](const Found& a, const Found& b) { return a.start < b.start; });
  std::vector<ChatterSpell> spells;
  for (std::size_t i = 0; i < found.size();) {
    Found whole = found[i++];
    for (; i < found.size() && found[i].start <= whole.end; ++i) {  // one spell, seen twice
      if (milliseconds_[found[i].peak].peak > milliseconds_[whole.peak].peak) whole.peak = found[i].peak;
      whole.died_down = found[i].end > whole.end ? found[i].died_down : whole.died_down;
      whole.end = std::max(whole.end, found[i].end);
    }
    spells.push_back({static_cast<double>(whole.start) * kMillisecond, static_cast<double>(whole.end) * kMillisecond,
                      whole.died_down, milliseconds_[whole.peak].peak,
                      strongest_line_hz(static_cast<double>(whole.peak) * kMillisecond)});
  }
  return spells;
}

}  // namespace stillcut
