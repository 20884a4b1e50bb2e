// `stillcut tune`: which alarm limit suits this machine, from logs whose stretches of chatter somebody has labelled.
#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "drivers/files/cell.hpp"
#include "tools/commands.hpp"
#include "tools/output_file.hpp"
#include "tools/output_options.hpp"
#include "tools/pipeline.hpp"
#include "tools/plot_tuning.hpp"
#include "tools/predictor.hpp"
#include "tools/progress.hpp"
#include "tools/tuning_labels.hpp"
#include "tools/tuning_replay.hpp"
#include "tools/tuning_report.hpp"

namespace stillcut {
namespace {

// From where noise alone is called chatter to where only what is loud already is.
constexpr double kLowestLimit = 5.0, kHighestLimit = 200.0;
constexpr int kLimits = 16;

struct TuneOptions : OutputOptions {
  std::string cell, logs, out;
  double false_alarms_per_hour = 1.0;
  int jobs = 0;
};

void refuse_to_overwrite_the_cell(const TuneOptions& options) {
  std::error_code error;
  if (!options.out.empty() && std::filesystem::equivalent(options.out, options.cell, error))
    throw InputError(options.out, 0, "is the cell file itself; name another file and copy the section from there");
}

int cores() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

ScoresOfLogs hear_and_score(const TuneOptions& options, const Cell& cell, const std::vector<LabelledLog>& labelled,
                            const std::vector<double>& limits) {
  const NominalPrediction prediction = Predictor{cell}.nominal();
  if (!prediction.warning.empty()) std::cerr << "stillcut: " << prediction.warning << '\n';
  std::vector<std::filesystem::path> files;
  files.reserve(labelled.size());
  for (const LabelledLog& log : labelled) files.push_back(log.file);
  Progress progress{"tuning"};
  const std::vector<HeardLog> heard =
      hear_logs(cell, prediction.diagram, files, limits, options.jobs > 0 ? options.jobs : cores(),
                [&](double share) { progress.update(share); });
  progress.finish();

  ScoresOfLogs scores;
  double sound_s = 0.0;
  for (std::size_t i = 0; i < heard.size(); ++i) {
    check_labels_end(options.logs, labelled[i], heard[i].duration_s);
    if (!heard[i].warning.empty()) std::cerr << "stillcut: " << heard[i].warning << '\n';
    std::vector<DetectionScore>& at_limit = scores.emplace_back();
    for (const LogHearing& hearing : heard[i].at_limit) {
      at_limit.push_back(score_log(labelled[i].stretches, hearing));
      sound_s += at_limit.back().sound_s;
    }
  }
  if (!(sound_s > 0.0))
    throw InputError(options.logs, 0, "holds no cutting outside the labelled stretches; add logs of sound cuts");
  return scores;
}

nlohmann::ordered_json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json detection_json(const DetectionScore& score) {
  const double hours = score.sound_hours();
  return {{"stretches", score.stretches},
          {"detected", score.detected},
          {"detected_percent", number_or_null(score.detected_percent())},
          {"delay_median_s", number_or_null(score.delay_median_s())},
          {"delay_p95_s", number_or_null(score.delay_p95_s())},
          {"false_alarms", score.false_alarms},
          {"hours", hours},
          {"false_alarms_per_hour", number_or_null(score.false_alarms_per_hour())},
          {"proved_below_per_hour", number_or_null(proved_rate_per_hour(score.false_alarms, hours))}};
}

nlohmann::ordered_json limit_json(const TuningResult& result, std::size_t limit) {
  nlohmann::ordered_json row = {{"limit", result.limits[limit]}};
  row.update(detection_json(result.curve[limit]));
  return row;
}

void print_tuning_json(const TuningResult& result, const std::vector<LabelledLog>& labelled) {
  nlohmann::ordered_json roc = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < result.limits.size(); ++i) roc.push_back(limit_json(result, i));
  nlohmann::ordered_json chosen = limit_json(result, result.choice.limit);
  chosen.erase("proved_below_per_hour");  // a choice proves nothing on the logs that it was made on
  chosen["release_ratio"] = result.release_ratio;
  chosen["wished_per_hour"] = result.wished_per_hour;
  chosen["wish_met"] = result.choice.wish_met;
  nlohmann::ordered_json cross_validated = nullptr;
  if (result.cross_validated) {
    cross_validated = detection_json(result.cross_validated->score);
    nlohmann::ordered_json& folds = cross_validated["left_out"] = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < labelled.size(); ++i)
      folds.push_back({{"log", labelled[i].file.filename().string()},
                       {"limit", result.limits[result.cross_validated->choices[i].limit]},
                       {"wish_met", result.cross_validated->choices[i].wish_met}});
  }
  const nlohmann::ordered_json object = {{"logs", result.logs},
                                         {"hours", result.chosen().sound_hours()},
                                         {"roc", roc},
                                         {"chosen", chosen},
                                         {"cross_validated", cross_validated}};
  std::cout << object.dump() << '\n';
}

void tune(const TuneOptions& options) {
  check_output_options(options);
  refuse_to_overwrite_the_cell(options);
  const Cell cell = read_cell(options.cell, {.bus = false});
  const CoreSettings settings = core_settings(cell);
  const std::vector<LabelledLog> labelled = read_labelled_logs(options.logs);

  TuningResult result;
  result.cell = cell.file;
  result.logs = labelled.size();
  result.wished_per_hour = options.false_alarms_per_hour;
  result.release_ratio = settings.monitor.release_ratio;
  result.limits = limit_grid(kLowestLimit, kHighestLimit, kLimits);
  const ScoresOfLogs scores = hear_and_score(options, cell, labelled, result.limits);
  result.curve = pooled_scores(scores);
  result.choice = choose_limit(result.curve, result.wished_per_hour);
  if (scores.size() > 1) result.cross_validated = cross_validate(scores, result.wished_per_hour);

  if (const std::string warning = wish_warning(result); !warning.empty()) std::cerr << "stillcut: " << warning << '\n';
  if (!options.csv.empty()) {
    OutputFile file{options.csv};
    write_tuning_csv(file.stream(), result);
    file.finish();
  }
  if (!options.out.empty()) {
    OutputFile file{options.out};
    write_monitor_section(file.stream(), result);
    file.finish();
  }
  if (!options.plot.empty()) plot::write_figure(tuning_figure(result), options.plot);
  if (options.json) print_tuning_json(result, labelled);
  if (!options.json && options.csv != "-") std::cout << tuning_table(result);
}

}  // namespace

void add_tune_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("tune", "Find the alarm limit that suits a machine, from labelled logs");
  const auto options = std::make_shared<TuneOptions>();
  command->add_option("CELL", options->cell, "Cell file")->required();
  command->add_option("--logs", options->logs, "Folder of CAN logs (*.log) and labels.csv (log,from_s,to_s,kind)")
      ->required();
  command
      ->add_option("--false-alarms-per-hour", options->false_alarms_per_hour,
                   "How often an alarm may be wrong, per hour of sound cutting")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  command->add_option("--out", options->out, "Write the chosen limit as a [monitor] section for the cell file");
  command->add_option("--jobs", options->jobs, "How many logs to play at a time (default: one a core)")
      ->check(CLI::Range(1, 1024));
  add_output_options(*command, *options, "Write the curve, a row for each limit",
                     "Draw detected share, false alarms and delay");
  command->footer(
      "labels.csv has a row for each stretch of chatter, in seconds after the log's first frame, and one with empty\n"
      "times for a log without chatter:\n"
      "  log,from_s,to_s,kind\n"
      "  monday.log,12.4,15.1,regenerative\n"
      "  tuesday.log,,,\n"
      "Example:\n"
      "  stillcut tune cell.toml --logs logs --false-alarms-per-hour 2 --out monitor.toml --plot tuning.png");
  command->callback([options] { tune(*options); });
}

}  // namespace stillcut
