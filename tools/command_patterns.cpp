// stillcut patterns: which tool path suits the dynamics under it.
#include <array>
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "drivers/files/cell.hpp"
#include "tools/output_file.hpp"
#include "tools/output_options.hpp"
#include "tools/pattern_gcode.hpp"
#include "tools/pattern_study.hpp"
#include "tools/plot_patterns.hpp"
#include "tools/progress.hpp"

namespace stillcut {
namespace {

struct PatternsOptions : OutputOptions {
  std::string cell;
  std::vector<std::string> paths, postures;
  double step_deg = 5.0, max_depth_mm = 20.0, near_percent = 10.0, turning_percent = 2.0, margin_percent = 10.0;
  double rapid_mm_per_s = 200.0;
  std::string method = "sdm", objective = "asi", picture = "ranking", pattern, gcode, feed_map, milling;
  std::optional<double> radial_depth_mm, grid_mm, reach_mm, depth_mm;
  bool face = false;
  int jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
};

PatternQuestion question_of(const Cell& cell, const PatternsOptions& options) {
  PatternQuestion question;
  question.cut = require(cell, cell.cut, "cut");
  if (options.radial_depth_mm) {
    question.cut.radial_depth = *options.radial_depth_mm * 1e-3;
    question.cut.step_over = 0.0;  // lines as far apart as the cut is wide
  }
  if (question.cut.radial_depth > require(cell, cell.tool, "tool").diameter)
    throw CLI::ValidationError("--radial-depth", "is more than the tool's diameter");
  if (options.milling == "down") question.cut.milling = Milling::down;
  if (options.milling == "up") question.cut.milling = Milling::up;
  question.postures = options.postures;
  question.paths.assign(options.paths.begin(), options.paths.end());
  const double whole = options.method == "paper" ? 90.0 : 180.0, steps = whole / options.step_deg;
  if (std::abs(steps - std::round(steps)) > 1e-9) {
    throw CLI::ValidationError(
        "--step", "must divide " + std::to_string(std::lround(whole)) + " degrees; give 5, 10 or 15, for example");
  }
  question.step = deg_to_rad(options.step_deg);
  question.method = options.method == "sdm"   ? DirectionMethod::floquet
                    : options.method == "zoa" ? DirectionMethod::zeroth_order
                                              : DirectionMethod::paper;
  question.max_depth = options.max_depth_mm * 1e-3;
  question.face = options.face;
  if (options.grid_mm) question.grid = *options.grid_mm * 1e-3;
  if (options.reach_mm) question.reach = *options.reach_mm * 1e-3;
  question.near_optimal = options.near_percent * 1e-2;
  question.plan = {options.objective == "time" ? PlanObjective::time : PlanObjective::absolute,
                   options.turning_percent * 1e-2, options.margin_percent * 1e-2};
  question.rapid_rate = options.rapid_mm_per_s * 1e-3;
  question.threads = options.jobs;
  return question;
}

// The pattern that pictures and G-code are of.
const RatedPattern& asked_pattern(const PatternStudy& study, const PatternsOptions& options) {
  const std::string usual = study.optimized.path.moves.empty() ? study.patterns.front().name : "optimized";
  try {
    return pattern_named(study, options.pattern.empty() ? usual : options.pattern);
  } catch (const std::invalid_argument& error) {
    throw CLI::ValidationError("--pattern", error.what());
  }
}

plot::Figure figure_of(const PatternStudy& study, const PatternsOptions& options) {
  if (options.picture == "ranking") return ranking_figure(study);
  if (options.picture == "field") return field_figure(study);
  const RatedPattern& pattern = asked_pattern(study, options);
  if (options.picture == "lobes") return common_lobes_figure(study, pattern);
  const double depth = planned_depth(study, pattern);
  if (!(depth > 0.0))
    throw InputError(options.cell, 0, "--picture path: no depth is stable along all of \"" + pattern.name + "\"");
  return path_figure(study, pattern, depth, pattern.rating.common.speed);
}

// Each output needs a place of its own.
void check_places_of_output(const PatternsOptions& options) {
  check_output_options(options);
  const std::array<std::pair<const char*, const std::string*>, 4> outputs{{{"--csv", &options.csv},
                                                                           {"--gcode", &options.gcode},
                                                                           {"--feed-map", &options.feed_map},
                                                                           {"--plot", &options.plot}}};
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const auto& [name, file] = outputs[i];
    if (file->empty()) continue;
    if (options.json && *file == "-")
      throw CLI::ValidationError(name, "and --json both go to standard output; give one a file");
    for (std::size_t j = 0; j < i; ++j) {
      if (*file == *outputs[j].second)
        throw CLI::ValidationError(
            name, std::string("goes to the same place as ") + outputs[j].first + "; give it a file of its own");
    }
  }
  if (options.depth_mm && options.gcode.empty())
    throw CLI::ValidationError("--depth", "is of the program; add --gcode FILE");
}

void run(const PatternsOptions& options) {
  check_places_of_output(options);
  const Cell cell = read_cell(options.cell, {.dbc = false, .bus = false});
  Progress progress("patterns");
  const PatternStudy study =
      study_patterns(cell, question_of(cell, options), [&](double share) { progress.update(share); });
  progress.finish();
  for (const std::string& line : study.warnings) std::cerr << "stillcut: " << options.cell << ": " << line << '\n';

  if (!options.csv.empty()) {
    OutputFile file(options.csv);
    write_patterns_csv(study, file.stream());
    file.finish();
  }
  if (!options.feed_map.empty()) {
    OutputFile file(options.feed_map);
    write_feed_map(study, file.stream());
    file.finish();
  }
  if (!options.gcode.empty()) {
    const std::optional<double> depth =
        options.depth_mm ? std::optional<double>(*options.depth_mm * 1e-3) : std::nullopt;
    std::ostringstream program;  // first: an error must not leave an empty file where a program was
    write_pattern_gcode(cell, study, asked_pattern(study, options), depth, program);
    OutputFile file(options.gcode);
    file.stream() << program.str();
    file.finish();
  }
  if (!options.plot.empty()) plot::write_figure(figure_of(study, options), options.plot);
  if (options.json) {
    std::cout << patterns_json(study).dump() << '\n';
  } else if (options.csv != "-" && options.gcode != "-" && options.feed_map != "-") {
    print_patterns(study, std::cout);
  }
}

void add_what_is_computed(CLI::App& command, PatternsOptions& options) {
  command
      .add_option("--path", options.paths,
                  "A tool path to rank with them: G-code or APT cutter locations; again for more")
      ->allow_extra_args(false);
  command
      .add_option("--posture", options.postures,
                  "Id of a posture that is a location (default: every one of the map); again for more")
      ->allow_extra_args(false);
  command
      .add_option("--step", options.step_deg, "Degrees from one direction, and angle of zig and zig-zag, to the next")
      ->capture_default_str()
      ->check(CLI::Range(2.0, 90.0).description(""));
  command
      .add_option("--method", options.method,
                  "sdm: converged Floquet solution; zoa: zeroth order; paper: zeroth order with the receptance "
                  "projected as in Tunc and Stoddart 2017, 0 to 90 degrees, only to compare with that paper")
      ->capture_default_str()
      ->check(CLI::IsMember({"sdm", "zoa", "paper"}));
  command.add_option("--milling", options.milling, "down or up (default: the cell's)")
      ->check(CLI::IsMember({"down", "up"}));
  command.add_option("--radial-depth", options.radial_depth_mm, "mm (default: the cell's)")
      ->check(CLI::Range(1e-6, 1e4).description(""));
  command.add_option("--max-depth", options.max_depth_mm, "Largest depth to look at, mm; a deeper limit counts as it")
      ->capture_default_str()
      ->check(CLI::Range(1e-6, 1e4).description(""));
  command.add_flag("--face", options.face, "A face, not a pocket: the tool may overhang the polygon");
  command
      .add_option("--grid", options.grid_mm,
                  "Locations so many mm apart, predicted, instead of the map's postures (maps without joints)")
      ->check(CLI::Range(0.1, 1e4).description(""))
      ->excludes("--posture");
  command
      .add_option("--reach", options.reach_mm,
                  "How far a location speaks for its surroundings, mm (default: the way to the nearest neighbour, "
                  "where it is longest)")
      ->check(CLI::Range(1e-3, 1e5).description(""));
  command.add_option("--near", options.near_percent, "Per cent below the best that are nearly as good")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 100.0).description(""));
  command.add_option("--rapid", options.rapid_mm_per_s, "Rate of moves through the air, mm/s")
      ->capture_default_str()
      ->check(CLI::Range(1e-3, 1e5).description(""));
  command.add_option("--jobs", options.jobs, "Threads (default: one a processor)")->check(CLI::Range(1, 256));
}

void add_what_is_planned(CLI::App& command, PatternsOptions& options) {
  command
      .add_option("--objective", options.objective,
                  "What the optimized path is to have: asi, the highest absolute "
                  "index, or time, the least time at a stable depth")
      ->capture_default_str()
      ->check(CLI::IsMember({"asi", "time"}));
  command
      .add_option(
          "--turning-cost", options.turning_percent,
          "What going on to a patch turned by 90 degrees costs, per cent of index or time; to one not turned, half")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 100.0).description(""));
  command.add_option("--margin", options.margin_percent, "How far below the limit the planned depth stays, per cent")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 90.0).description(""));
  command.add_option("--pattern", options.pattern,
                     "What --gcode and the pictures lobes and path show, such as \"zig 45\" (default: optimized)");
  command.add_option("--gcode", options.gcode, "Write the pattern as G-code, spindle speeds and feeds in it");
  command.add_option("--depth", options.depth_mm, "With --gcode: mm to cut, in layers (default: one layer)")
      ->check(CLI::Range(1e-3, 1e4).description(""));
  command.add_option("--feed-map", options.feed_map,
                     "Write where to feed in which direction, for [compensation] feed_map of the daemon");
  command
      .add_option("--picture", options.picture,
                  "What --plot draws: ranking, field of directions, lobes of all locations, or path by its margin")
      ->capture_default_str()
      ->check(CLI::IsMember({"ranking", "field", "lobes", "path"}));
}

}  // namespace

void add_patterns_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("patterns", "Rank tool path patterns by chatter, and put a better one together");
  const auto options = std::make_shared<PatternsOptions>();
  command->add_option("CELL", options->cell, "Cell file; its [region] is filled")->required();
  add_what_is_computed(*command, *options);
  add_what_is_planned(*command, *options);
  add_output_options(*command, *options, "Write one row a pattern", "Draw what --picture names");
  command->footer(
      "ASI: mean over the locations of a_abs along the pattern over a_abs of the best direction there.\n"
      "Examples:\n"
      "  stillcut patterns examples/hexapod-pocket/cell.toml\n"
      "  stillcut patterns examples/hexapod-pocket/cell.toml --objective time --gcode pocket.nc --depth 5 \\\n"
      "    --picture path --plot path.svg");
  command->callback([options] { run(*options); });
}

}  // namespace stillcut
