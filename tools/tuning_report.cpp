#include "tools/tuning_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "drivers/files/csv.hpp"

namespace stillcut {
namespace {

template <class... Values>
std::string formatted(const char* format, Values... values) {
  std::array<char, 240> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

// A cell of the table: a dash where there is nothing to tell.
std::string table_cell(double value, int width, int decimals) {
  if (std::isnan(value)) return formatted("%*s", width, "-");
  return formatted("%*.*f", width, decimals, value);
}

std::string counted(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string counted_logs(const TuningResult& result) { return counted(result.logs, "log", "logs"); }

// Three digits, of large numbers all before the decimal point.
std::string rounded(double value) { return formatted(value < 100.0 ? "%.3g" : "%.0f", value); }

std::string score_row(const DetectionScore& score) {
  return table_cell(score.detected_percent(), 10, 1) + table_cell(1e3 * score.delay_median_s(), 9, 0) +
         table_cell(1e3 * score.delay_p95_s(), 8, 0) + formatted("%8d", score.false_alarms) +
         table_cell(score.false_alarms_per_hour(), 11, 2) + "\n";
}

// How many stretches were found, and false alarms.
std::string in_words(const DetectionScore& score) {
  std::string text;
  if (score.stretches > 0) text += formatted("%d of %d stretches detected, ", score.detected, score.stretches);
  return text + counted(static_cast<std::size_t>(score.false_alarms), "false alarm", "false alarms") + " in " +
         rounded(score.sound_hours()) + " h";
}

// Only of logs that had no say in the choice: on its own logs a limit looks better than it is.
std::string proof_in_words(const DetectionScore& score) {
  const double proved = proved_rate_per_hour(score.false_alarms, score.sound_hours());
  if (!std::isfinite(proved)) return ", which proves no rate";
  return ", which proves a rate below " + rounded(proved) + " an hour (95 %)";
}

std::string chosen_by_others(const TuningResult& result) {
  const auto& choices = result.cross_validated->choices;
  const auto [least, most] = std::minmax_element(choices.begin(), choices.end(),
                                                 [](const auto& a, const auto& b) { return a.limit < b.limit; });
  const std::string low = rounded(result.limits[least->limit]), high = rounded(result.limits[most->limit]);
  return low == high ? low : low + " to " + high;
}

std::string cross_validated_lines(const TuningResult& result) {
  if (!result.cross_validated)
    return "cross-validated: needs two logs at least; on the logs that chose it a limit looks better than it is\n";
  return "cross-validated: " + in_words(result.cross_validated->score) + proof_in_words(result.cross_validated->score) +
         "\n  (each log judged at the limit that the others choose, here " + chosen_by_others(result) + ")\n";
}

// What it would take to prove the wish, which is easily underrated.
std::string proof_lines(const TuningResult& result) {
  const double hours = result.chosen().sound_hours();
  std::string text =
      counted_logs(result) + " with " + rounded(hours) + " h of sound cutting can prove no more than a rate below " +
      rounded(proved_rate_per_hour(0, hours)) + " an hour,\neven without one false alarm (rule of three).";
  if (result.wished_per_hour > 0.0)
    text += " To prove at most " + rounded(result.wished_per_hour) + " an hour takes " +
            rounded(proved_rate_per_hour(0, result.wished_per_hour)) + " h without one.";
  return text + "\n";
}

}  // namespace

std::vector<double> limit_grid(double low, double high, int count) {
  std::vector<double> limits;
  for (int i = 0; i < count; ++i) {
    const double exact = low * std::pow(high / low, static_cast<double>(i) / (count - 1));
    limits.push_back(std::stod(formatted("%.3g", exact)));
  }
  return limits;
}

std::string tuning_table(const TuningResult& result) {
  std::string text =
      counted_logs(result) + ", " + rounded(result.chosen().sound_hours()) + " h of sound cutting, " +
      counted(static_cast<std::size_t>(result.chosen().stretches), "stretch of chatter", "stretches of chatter") +
      "; false alarms wished: at most " + rounded(result.wished_per_hour) + " an hour\n\n";
  text += "    limit  detected   median     p95   false        per\n";
  text += "                  %       ms      ms  alarms       hour\n";
  for (std::size_t i = 0; i < result.limits.size(); ++i)
    text +=
        formatted("%s %6.3g", i == result.choice.limit ? "->" : "  ", result.limits[i]) + score_row(result.curve[i]);
  text += "\nchosen limit: " + rounded(result.chosen_limit()) + "\n";
  text += "on all logs:     " + in_words(result.chosen()) + "\n" + cross_validated_lines(result) + proof_lines(result);
  return text;
}

std::string wish_warning(const TuningResult& result) {
  if (result.choice.wish_met) return {};
  const std::string wish = rounded(result.wished_per_hour), best = rounded(result.chosen_limit());
  if (result.chosen().false_alarms_per_hour() > result.wished_per_hour)
    return "the wish is not met: the best limit, " + best + ", has " +
           rounded(result.chosen().false_alarms_per_hour()) + " false alarms an hour and not " + wish;
  const auto rest = std::span{result.curve}.subspan(result.choice.limit);
  const auto louder = std::find_if(rest.begin(), rest.end(), [&](const DetectionScore& score) {
    return score.false_alarms_per_hour() > result.wished_per_hour;
  });
  return "the wish is not met for sure: limit " + best + " keeps to " + wish + " an hour, but a larger one, " +
         rounded(result.limits[result.choice.limit + static_cast<std::size_t>(louder - rest.begin())]) + ", has " +
         rounded(louder->false_alarms_per_hour()) + "; that may be luck";
}

void write_tuning_csv(std::ostream& out, const TuningResult& result) {
  out << "limit,stretches,detected,detected_percent,delay_median_s,delay_p95_s,false_alarms,sound_hours,"
         "false_alarms_per_hour\n";
  for (std::size_t i = 0; i < result.limits.size(); ++i) {
    const DetectionScore& score = result.curve[i];
    const std::array<std::string, 9> row{csv_number(result.limits[i]),
                                         std::to_string(score.stretches),
                                         std::to_string(score.detected),
                                         csv_number_or_empty(score.detected_percent()),
                                         csv_number_or_empty(score.delay_median_s()),
                                         csv_number_or_empty(score.delay_p95_s()),
                                         std::to_string(score.false_alarms),
                                         csv_number(score.sound_hours()),
                                         csv_number(score.false_alarms_per_hour())};
    write_csv_row(out, row);
  }
}

void write_monitor_section(std::ostream& out, const TuningResult& result) {
  out << "# By `stillcut tune`: " << counted_logs(result) << ", " << rounded(result.chosen().sound_hours())
      << " h of sound cutting; false alarms an hour: at most " << rounded(result.wished_per_hour) << " wished, "
      << rounded(result.chosen().false_alarms_per_hour()) << " reached.\n"
      << "# On all logs: " << in_words(result.chosen()) << ".\n";
  if (result.cross_validated)
    out << "# Cross-validated: " << in_words(result.cross_validated->score)
        << proof_in_words(result.cross_validated->score) << ".\n";
  if (!result.choice.wish_met) out << "# Here " << wish_warning(result) << ".\n";
  out << "[monitor]\n"
      << "limit = " << csv_number(result.chosen_limit()) << "\n"
      << "release_ratio = " << csv_number(result.release_ratio) << "\n";
}

}  // namespace stillcut
