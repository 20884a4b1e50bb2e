// How well the monitor does on labelled logs at each of several alarm limits, which limit to take, and what the logs
// prove. Pure functions of what was labelled and what was heard; docs/tune.md says the rules in words.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "dsp/signals.hpp"

namespace stillcut {

struct LogSpan {
  double from_s = 0.0, to_s = 0.0;  // after the log's first frame
};

// A stretch of a log in which somebody who knows says that there was chatter.
struct ChatterStretch {
  LogSpan time;
  ChatterKind kind = ChatterKind::unknown;  // unknown: not told either
};

struct HeardOnset {
  double time_s = 0.0;
  ChatterKind kind = ChatterKind::unknown;
};

// What the monitor made of one log at one limit.
struct LogHearing {
  std::vector<HeardOnset> onsets;
  std::vector<LogSpan> in_cut;  // when it took the tool to be cutting; in order, apart from each other
};

// An onset may come this long before the stretch that it belongs to (labels are set by eye); one that comes this long
// after a stretch is neither found nor false, as chatter fades.
inline constexpr double kOnsetBefore_s = 0.1, kFadesFor_s = 0.2;

struct DetectionScore {
  int stretches = 0, detected = 0, false_alarms = 0;
  double sound_s = 0.0;            // in the cut, where an onset would be false
  std::vector<double> delays_s{};  // of the detected, after the stretch's beginning; may be negative

  DetectionScore& operator+=(const DetectionScore& other);

  [[nodiscard]] double detected_percent() const;  // NaN without stretches
  [[nodiscard]] double delay_median_s() const;    // NaN where nothing was detected
  [[nodiscard]] double delay_p95_s() const;       // the smallest delay that 95 % do not exceed
  [[nodiscard]] double sound_hours() const { return sound_s / 3600.0; }
  [[nodiscard]] double false_alarms_per_hour() const;  // 0 without an alarm, infinite where no time can hold it
};

DetectionScore score_log(std::span<const ChatterStretch> stretches, const LogHearing& hearing);

// A score for each log and, within it, for each limit; limits in rising order.
using ScoresOfLogs = std::vector<std::vector<DetectionScore>>;

// One score a limit, over all logs but one.
std::vector<DetectionScore> pooled_scores(const ScoresOfLogs& scores, std::optional<std::size_t> left_out = {});

struct LimitChoice {
  std::size_t limit = 0;  // its index
  bool wish_met = false;
};

// The smallest limit from which on, for it and every larger one, false alarms are no more frequent than wished: a limit
// that does well by luck between two that do not is not taken. Where there is none, the one of fewest false alarms.
LimitChoice choose_limit(std::span<const DetectionScore> curve, double wished_per_hour);

struct CrossValidation {
  std::vector<LimitChoice> choices;  // one a log: made on the others
  DetectionScore score;              // of each log at the limit that the others chose
};

// Leave one log out in turn. Needs two logs.
CrossValidation cross_validate(const ScoresOfLogs& scores, double wished_per_hour);

// The rate below which the true one lies with 95 % confidence, given so many false alarms in so long a time: the exact
// limit of a Poisson count (Garwood 1936, https://doi.org/10.1093/biomet/28.3-4.437). Without an alarm it is the "rule
// of three", 3 over the time.
double proved_rate_per_hour(int false_alarms, double hours);

}  // namespace stillcut
