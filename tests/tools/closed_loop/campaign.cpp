// closed_loop_campaign: random cells in closed loop, monitor and simulated machine in data time, measured by what a
// correction is to reach. `--help` has an example.
#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <mutex>
#include <thread>

#include "drivers/files/csv.hpp"
#include "tests/drivers/files/temp_folder.hpp"
#include "tests/tools/closed_loop/summary.hpp"

namespace stillcut::campaign {
namespace {

struct Options {
  CellClass kind = CellClass::pocket;
  int cells = 200, jobs = 2, only = -1, at_least = 0;
  std::uint64_t seed = 1;
  double duration = 60.0;
  MapError error;
  bool list = false;
  std::string csv, folder = "campaign-cell";
};

CellRun run_one(const Options& options, int index, const std::filesystem::path& folder) {
  CellRun run{
      index,
      random_cell(options.kind, options.seed, static_cast<std::uint64_t>(index), options.duration, options.error),
      {},
      {}};
  try {
    run.metrics = run_cell(run.cell, folder);
  } catch (const std::runtime_error& problem) {
    run.problem = problem.what();
  }
  return run;
}

std::vector<CellRun> run_all(const Options& options) {
  std::vector<CellRun> runs(static_cast<std::size_t>(options.cells));
  std::atomic<int> next = 0;
  std::mutex printing;
  const auto work = [&] {
    for (int i = next++; i < options.cells; i = next++) {
      const TempFolder folder;
      CellRun run = run_one(options, i, folder.path());
      const std::scoped_lock lock{printing};
      if (options.list) std::cout << line_of(run) << std::endl;
      runs[static_cast<std::size_t>(i)] = std::move(run);
    }
  };
  std::vector<std::jthread> threads;
  for (int j = 1; j < options.jobs; ++j) threads.emplace_back(work);
  work();
  threads.clear();
  return runs;
}

void write_csv(const std::string& file, const std::vector<CellRun>& runs) {
  std::ofstream stream{file};
  stream << csv_header();
  for (const CellRun& run : runs) stream << csv_row(run);
  stream.close();
  if (!stream) throw std::runtime_error(file + ": cannot be written");
}

int run_campaign(int argc, char** argv) {
  CLI::App app{
      "Random cells in closed loop: is chatter ended, in time, without hunting for it; are sound cuts left alone?\n"
      "Example: closed_loop_campaign --class pocket --cells 200 --duration 60\n"
      "Exit status 0: every criterion was met, 1: not."};
  Options options;
  const std::map<std::string, CellClass> kinds{
      {"pocket", CellClass::pocket}, {"none", CellClass::none}, {"stable", CellClass::stable}};
  app.add_option("--class", options.kind, "pocket: another speed is stable; none: no speed is; stable: never chatters")
      ->transform(CLI::CheckedTransformer(kinds));
  app.add_option("--cells", options.cells, "How many")->check(CLI::PositiveNumber);
  app.add_option("--seed", options.seed, "Of all that is drawn");
  app.add_option("--duration", options.duration, "Of a run, s")->check(CLI::Range(5.0, 3600.0));
  app.add_option("--map-error", options.error.share,
                 "Of the monitor's map: 1 is 1 % of frequency, 10 % of stiffness, 20 % of damping")
      ->check(CLI::Range(0.0, 3.0));
  app.add_option("--jobs", options.jobs, "Threads")->check(CLI::PositiveNumber);
  app.add_flag("--list", options.list, "Print a line a cell as it is done");
  app.add_option("--csv", options.csv, "Write a row a cell");
  app.add_option("--only", options.only, "Run this cell alone and keep its files, for `stillcut hil` by hand");
  app.add_option("--folder", options.folder, "Where --only keeps them");
  CLI11_PARSE(app, argc, argv);
  if (options.only >= 0) {
    const CellRun run = run_one(options, options.only, options.folder);
    std::cout << line_of(run) << '\n'
              << settings_text(run) << "kept; look at it with\n  stillcut hil " << options.folder
              << "/cell.toml --scenario " << options.folder << "/scenario.toml --data-time --plot run.png\n";
    return 0;
  }
  const std::vector<CellRun> runs = run_all(options);
  if (!options.csv.empty()) write_csv(options.csv, runs);
  const Summary summary = summarise(runs);
  std::cout << summary.text;
  return summary.met ? 0 : 1;
}

}  // namespace
}  // namespace stillcut::campaign

int main(int argc, char** argv) try {
  return stillcut::campaign::run_campaign(argc, argv);
} catch (const std::exception& problem) {
  std::cerr << "closed_loop_campaign: " << problem.what() << '\n';
  return 3;
}
