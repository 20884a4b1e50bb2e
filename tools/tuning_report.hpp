// What `stillcut tune` found and how it is told: a table, a CSV of the curve, a [monitor] section for the cell file.
#pragma once

#include <filesystem>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "tools/tuning_score.hpp"

namespace stillcut {

struct TuningResult {
  std::filesystem::path cell;
  std::size_t logs = 0;
  double wished_per_hour = 1.0;       // false alarms
  std::vector<double> limits;         // rising
  std::vector<DetectionScore> curve;  // one a limit, over all logs
  LimitChoice choice;
  std::optional<CrossValidation> cross_validated;  // nothing with a single log
  double release_ratio = 0.0;                      // with which the logs were heard

  [[nodiscard]] double chosen_limit() const { return limits[choice.limit]; }
  [[nodiscard]] const DetectionScore& chosen() const { return curve[choice.limit]; }
};

// `count` limits from `low` to `high`, equally far apart as ratios, to three digits: a limit is not known better.
std::vector<double> limit_grid(double low, double high, int count);

// For people: the curve with the chosen row marked, the figures on all logs and cross-validated, and what they prove.
std::string tuning_table(const TuningResult& result);

// One line that warns where the wish is not met; empty where it is.
std::string wish_warning(const TuningResult& result);

void write_tuning_csv(std::ostream& out, const TuningResult& result);

// A [monitor] section that read_cell takes, with the chosen limit and where it comes from.
void write_monitor_section(std::ostream& out, const TuningResult& result);

}  // namespace stillcut
