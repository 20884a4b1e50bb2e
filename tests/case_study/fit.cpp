// case_study_fit: finds the parameters of the reconstructed map anew, and writes the shipped maps.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <thread>

#include "drivers/files/cell.hpp"
#include "drivers/files/csv.hpp"
#include "drivers/files/dynamics_map_file.hpp"
#include "models/lobes.hpp"
#include "tests/case_study/differential_evolution.hpp"
#include "tests/case_study/plate_study.hpp"
#include "tests/case_study/slender_map.hpp"
#include "tests/case_study/table1_fit.hpp"
#include "tools/progress.hpp"

namespace {

using namespace stillcut;
using namespace stillcut::case_study;

PocketParameters as_parameters(std::span<const double> values) {
  PocketParameters result{};
  std::copy(values.begin(), values.end(), result.begin());
  return result;
}

void print_found(const Found& found, const PlateFigures& figures) {
  for (std::size_t i = 0; i < kPocketParameters; ++i)
    std::cout << kPocketRanges[i].name << ' ' << csv_number(found.at[i]) << '\n';
  for (std::size_t i = 0; i < kPatterns; ++i) {
    const PatternFigures& ours = figures.table[i];
    std::printf("%-17s min %.3f mm, max %.3f mm, ASI %.1f %%\n", kPatternNames[i], ours.min_mm, ours.max_mm,
                ours.asi_percent);
  }
  std::printf("cost %.5f; best zig %.0f deg; ZIG0 over ZIG90: %.2f absolute, %.2f in the common pocket\n",
              table1_cost(figures.table), figures.best_zig_deg, figures.absolute_gain, figures.pocket_gain);
}

void search_map(const std::string& file, Search search) {
  // Fewer speeds and directions than the figures are judged by: the directions near the best and those of the patterns.
  constexpr int kSpeeds = 41;
  const std::vector<double> directions{0, 20, 35, 40, 45, 50, 55, 65, 90};
  const Cell cell = read_cell(file, {.map = false});
  const SpindleLimits& spindle = require(cell, cell.spindle, "spindle");
  const LinearCut cut = linear_cut(require(cell, cell.tool, "tool"), require(cell, cell.material, "material"),
                                   require(cell, cell.cut, "cut"));
  const std::vector<double> speeds = equally_spaced_speeds(spindle.min_speed, spindle.max_speed, kSpeeds);
  for (const ParameterRange& range : kPocketRanges) search.bounds.emplace_back(range.low, range.high);
  Progress progress("generations");
  const Found found = minimum(
      search,
      [&](std::span<const double> at) {
        return table1_cost(coarse_figures(cut, speeds, directions, as_parameters(at)).table);
      },
      [&](int generation, const Found&) { progress.update((generation + 1.0) / search.generations); });
  progress.finish();
  print_found(found,
              plate_figures(plate_limits(cell, pocket_map(as_parameters(found.at)), DirectionMethod::paper,
                                         directions_of(DirectionMethod::paper), 201, search.jobs, [](double) {})));
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{"The reconstructed maps of docs/feed-direction-case-study.md."};
  app.require_subcommand(1);
  std::string cell, map, folder;
  Search search;
  search.population = 36;
  search.generations = 80;
  search.jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  CLI::App* find =
      app.add_subcommand("search", "Fit the plate's map to Table 1, some minutes, and print its parameters");
  find->add_option("CELL", cell, "Cell file of the case study; its map is not read")->required();
  find->add_option("--seed", search.seed, "Of the search")->capture_default_str();
  find->add_option("--generations", search.generations, "Of the search")->capture_default_str();
  find->add_option("--jobs", search.jobs, "Threads; the result is the same with any number")->check(CLI::Range(1, 256));
  find->callback([&] { search_map(cell, search); });
  CLI::App* write = app.add_subcommand("write", "Write postures.csv and modes.csv of the stored parameters");
  write->add_option("MAP", map, "Which")->required()->check(CLI::IsMember({"pocket", "slender"}));
  write->add_option("FOLDER", folder, "Folder of the map")->required();
  write->callback([&] { write_dynamics_map(folder, map == "pocket" ? pocket_map(kFittedPocket) : slender_map()); });
  app.footer(
      "Examples:\n"
      "  case_study_fit search examples/hexapod-pocket/cell.toml --seed 1\n"
      "  case_study_fit write pocket examples/hexapod-pocket/map");
  CLI11_PARSE(app, argc, argv);
} catch (const std::exception& error) {
  std::cerr << "case_study_fit: " << error.what() << '\n';
  return 3;
}
