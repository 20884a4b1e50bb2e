#include "tools/tuning_score.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

// Structural chatter has a detector of its own that no limit moves: told of another stretch it would flatter every
// limit alike.
bool may_tell(const HeardOnset& onset, const ChatterStretch& stretch) {
  return onset.kind != ChatterKind::structural || stretch.kind == ChatterKind::structural;
}

bool lies_in(double time_s, double from_s, double to_s) { return time_s >= from_s && time_s <= to_s; }

// What a stretch of chatter takes from the time in which an onset would be false.
LogSpan excused(const ChatterStretch& stretch) {
  return {stretch.time.from_s - kOnsetBefore_s, stretch.time.to_s + kFadesFor_s};
}

double seconds_outside(std::span<const LogSpan> in_cut, std::span<const ChatterStretch> stretches) {
  std::vector<LogSpan> taken;
  for (const ChatterStretch& stretch : stretches) taken.push_back(excused(stretch));
  std::sort(taken.begin(), taken.end(), [](const LogSpan& a, const LogSpan& b) { return a.from_s < b.from_s; });
  double sum = 0.0;
  for (const LogSpan& span : in_cut) {
    double at = span.from_s;
    for (const LogSpan& out : taken) {
      sum += std::max(0.0, std::min(out.from_s, span.to_s) - at);
      at = std::max(at, out.to_s);
    }
    sum += std::max(0.0, span.to_s - at);
  }
  return sum;
}

// P(X <= count) for a Poisson X: from its last term down, which alone may be too small to be a number.
double poisson_at_most(int count, double mean) {
  double term = std::exp(count * std::log(mean) - mean - std::lgamma(count + 1.0)), sum = term;
  for (int i = count; i > 0; --i) {
    term *= i / mean;
    sum += term;
  }
  return sum;
}

}  // namespace

DetectionScore& DetectionScore::operator+=(const DetectionScore& other) {
  stretches += other.stretches;
  detected += other.detected;
  false_alarms += other.false_alarms;
  sound_s += other.sound_s;
  delays_s.insert(delays_s.end(), other.delays_s.begin(), other.delays_s.end());
  return *this;
}

double DetectionScore::detected_percent() const { return stretches > 0 ? 100.0 * detected / stretches : kNaN; }

double DetectionScore::delay_median_s() const {
  if (delays_s.empty()) return kNaN;
  std::vector<double> sorted = delays_s;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t half = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[half] : 0.5 * (sorted[half - 1] + sorted[half]);
}

double DetectionScore::delay_p95_s() const {
  if (delays_s.empty()) return kNaN;
  std::vector<double> sorted = delays_s;
  std::sort(sorted.begin(), sorted.end());
  return sorted[(95 * sorted.size() + 99) / 100 - 1];
}

double DetectionScore::false_alarms_per_hour() const {
  if (false_alarms == 0) return 0.0;
  return sound_s > 0.0 ? false_alarms / sound_hours() : std::numeric_limits<double>::infinity();
}

DetectionScore score_log(std::span<const ChatterStretch> stretches, const LogHearing& hearing) {
  std::vector<double> first_s(stretches.size(), std::numeric_limits<double>::infinity());
  DetectionScore score;
  for (const HeardOnset& onset : hearing.onsets) {
    // An onset within a stretch is that one's; only one outside all of them may be early for the next.
    bool inside = false, early = false, fading = false;
    for (std::size_t i = 0; i < stretches.size(); ++i) {
      if (!may_tell(onset, stretches[i]) || !lies_in(onset.time_s, stretches[i].time.from_s, stretches[i].time.to_s))
        continue;
      inside = true;
      first_s[i] = std::min(first_s[i], onset.time_s);
    }
    for (std::size_t i = 0; i < stretches.size() && !inside; ++i) {
      if (!may_tell(onset, stretches[i])) continue;
      const auto [from_s, to_s] = stretches[i].time;
      fading = fading || lies_in(onset.time_s, to_s, to_s + kFadesFor_s);
      if (!lies_in(onset.time_s, from_s - kOnsetBefore_s, from_s)) continue;
      early = true;
      first_s[i] = std::min(first_s[i], onset.time_s);
    }
    score.false_alarms += inside || early || fading ? 0 : 1;
  }
  score.stretches = static_cast<int>(stretches.size());
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    if (std::isinf(first_s[i])) continue;
    ++score.detected;
    score.delays_s.push_back(first_s[i] - stretches[i].time.from_s);
  }
  score.sound_s = seconds_outside(hearing.in_cut, stretches);
  return score;
}

std::vector<DetectionScore> pooled_scores(const ScoresOfLogs& scores, std::optional<std::size_t> left_out) {
  std::vector<DetectionScore> curve(scores.empty() ? 0 : scores.front().size());
  for (std::size_t log = 0; log < scores.size(); ++log) {
    if (log == left_out) continue;
    for (std::size_t limit = 0; limit < curve.size(); ++limit) curve[limit] += scores[log][limit];
  }
  return curve;
}

LimitChoice choose_limit(std::span<const DetectionScore> curve, double wished_per_hour) {
  std::size_t first_good = curve.size();
  while (first_good > 0 && curve[first_good - 1].false_alarms_per_hour() <= wished_per_hour) --first_good;
  if (first_good < curve.size()) return {first_good, true};
  const auto fewest = std::min_element(curve.begin(), curve.end(), [](const auto& a, const auto& b) {
    return a.false_alarms_per_hour() < b.false_alarms_per_hour();
  });
  return {static_cast<std::size_t>(fewest - curve.begin()), false};
}

CrossValidation cross_validate(const ScoresOfLogs& scores, double wished_per_hour) {
  CrossValidation result;
  for (std::size_t log = 0; log < scores.size(); ++log) {
    result.choices.push_back(choose_limit(pooled_scores(scores, log), wished_per_hour));
    result.score += scores[log][result.choices.back().limit];
  }
  return result;
}

double proved_rate_per_hour(int false_alarms, double hours) {
  if (!(hours > 0.0)) return std::numeric_limits<double>::infinity();
  constexpr double kDoubt = 0.05;
  constexpr int kHalvings = 60;
  double low = 0.0, high = 10.0 + 2.0 * false_alarms;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (poisson_at_most(false_alarms, middle) > kDoubt ? low : high) = middle;
  }
  return high / hours;
}

}  // namespace stillcut
