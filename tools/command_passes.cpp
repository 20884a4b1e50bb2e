// stillcut passes: the multibody paper's four milling passes with its robot, and one table, the paper beside ours.
#include <array>
#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "drivers/files/csv.hpp"
#include "drivers/files/input_error.hpp"
#include "dsp/numbers.hpp"
#include "tools/commands.hpp"
#include "tools/output_file.hpp"
#include "tools/output_options.hpp"
#include "tools/pass_table.hpp"
#include "tools/plot_passes.hpp"
#include "tools/progress.hpp"

namespace stillcut {
namespace {

constexpr double kDeepestAsked = 40e-3;  // m, of the depth that turns unstable

struct PassesOptions : OutputOptions {
  double steps = 100.0, phase = 0.0, runout_um = 0.0, cutting_time_s = 2.0;
  int chords = 1, discs = 8;
  std::vector<double> place_mm{1100.0, 0.0, 0.0};
  std::string spectrum_plot, wall_plot;
  bool depths = false;
};

HuynhPass pass_of(const PassesOptions& options, PassWay way, Milling milling) {
  HuynhPass pass;
  pass.way = way;
  pass.milling = milling;
  pass.steps_per_turn = options.steps;
  pass.start_angle = options.phase * kTwoPi / options.steps;
  pass.chords = options.chords;
  pass.discs = options.discs;
  pass.runout = options.runout_um * 1e-6;
  pass.cutting_time = options.cutting_time_s;
  pass.place = 1e-3 * Eigen::Vector3d(options.place_mm[0], options.place_mm[1], options.place_mm[2]);
  return pass;
}

// Where the lobes find no depth, the simulation with given immersion is asked at the deepest, and the part, which takes
// long at such depths, not at all.
PassDepths depths_of(const HuynhPass& pass) {
  PassDepths depths{huynh_depth_by_lobes(pass, kDeepestAsked).depth, kNaN, kNaN};
  if (std::isfinite(depths.by_lobes)) {
    depths.in_time = huynh_depth_in_time(pass, depths.by_lobes);
    depths.in_part = huynh_depth_in_part(pass, depths.by_lobes);
  } else if (huynh_multiplier_in_time(pass, kDeepestAsked).modulus < 1.0) {
    depths.in_time = std::numeric_limits<double>::infinity();
  }
  return depths;
}

std::vector<PassRun> run_passes(const PassesOptions& options) {
  std::vector<PassRun> runs;
  Progress progress("milling");
  for (const PassWay way : {PassWay::longitudinal, PassWay::transversal})
    for (const Milling milling : {Milling::down, Milling::up}) {
      PassRun run{pass_of(options, way, milling), {}, {}};
      const auto done = static_cast<double>(runs.size());
      const auto told = [&](double share) { progress.update((done + share) / 4.0); };
      try {
        run.result = run_huynh_pass(run.pass, told);
        if (options.depths) run.depths = depths_of(run.pass);
      } catch (const std::invalid_argument& error) {
        throw CLI::ValidationError(pass_name(run.pass), error.what());
      }
      runs.push_back(std::move(run));
    }
  progress.finish();
  return runs;
}

void write_passes_csv(const std::string& file, const std::vector<PassRun>& runs, const std::vector<PassRow>& rows) {
  OutputFile out(file);
  out.stream() << "pass,quantity,unit,paper,ours\n";
  for (std::size_t i = 0; i < runs.size(); ++i)
    for (const PassRow& row : rows)
      write_csv_row(out.stream(),
                    std::array{csv_text(pass_name(runs[i].pass)), csv_text(row.quantity), csv_text(row.unit),
                               csv_number_or_empty(row.paper[i]), csv_number_or_empty(row.ours[i])});
  out.finish();
}

nlohmann::ordered_json passes_json(const std::vector<PassRun>& runs, const std::vector<PassRow>& rows) {
  const auto number = [](double value) -> nlohmann::ordered_json {
    if (std::isinf(value)) return "inf";
    if (std::isnan(value)) return nullptr;
    return value;
  };
  auto passes = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    auto quantities = nlohmann::ordered_json::array();
    for (const PassRow& row : rows)
      quantities.push_back({{"quantity", row.quantity},
                            {"unit", row.unit},
                            {"paper", number(row.paper[i])},
                            {"ours", number(row.ours[i])}});
    passes.push_back({{"pass", pass_name(runs[i].pass)}, {"quantities", quantities}});
  }
  return {
      {"steps_per_turn", runs.front().pass.steps_per_turn}, {"step_s", runs.front().result.step}, {"passes", passes}};
}

void passes(const PassesOptions& options) {
  check_output_options(options);
  for (const std::string& picture : {options.spectrum_plot, options.wall_plot})
    if (!picture.empty()) plot::check_picture_name(picture);
  const std::vector<PassRun> runs = run_passes(options);
  const std::vector<PassRow> rows = pass_rows(runs);
  if (!options.csv.empty()) write_passes_csv(options.csv, runs, rows);
  if (!options.plot.empty()) plot::write_figure(pass_forces_figure(runs), options.plot);
  if (!options.spectrum_plot.empty()) plot::write_figure(pass_spectrum_figure(runs), options.spectrum_plot);
  if (!options.wall_plot.empty()) plot::write_figure(pass_wall_figure(runs), options.wall_plot);
  if (options.json) {
    std::cout << passes_json(runs, rows).dump() << '\n';
  } else if (options.csv != "-") {
    print_pass_table(std::cout, runs, rows);
  }
}

}  // namespace

void add_passes_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("passes", "The multibody paper's four milling passes with its robot, beside the paper");
  const auto options = std::make_shared<PassesOptions>();
  command->add_option("--steps", options->steps, "Steps a turn of the spindle")
      ->capture_default_str()
      ->check(CLI::Range(30.0, 10000.0));
  command->add_option("--phase", options->phase, "Where tooth 0 stands at the start, in steps")->capture_default_str();
  command->add_option("--chords", options->chords, "Straight segments of an edge's way in a step")
      ->capture_default_str()
      ->check(CLI::Range(1, 100));
  command->add_option("--discs", options->discs, "Slices of the part, discs of the tool")
      ->capture_default_str()
      ->check(CLI::Range(1, 100));
  command->add_option("--place", options->place_mm, "Tool from the robot's foot at the end of a pass, mm: X,Y,Z")
      ->delimiter(',')
      ->expected(3)
      ->capture_default_str();
  command->add_option("--runout", options->runout_um, "Radial runout of the tool, um")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1000.0));
  command->add_option("--cutting-time", options->cutting_time_s, "Length of the plate, s of feed")
      ->capture_default_str()
      ->check(CLI::Range(0.5, 20.0));
  command->add_flag("--depths", options->depths,
                    "Also the depth at which each pass turns unstable, by lobes and in time: takes three minutes");
  add_output_options(*command, *options, "Write the table", "Draw the forces over two turns");
  command->add_option("--plot-spectrum", options->spectrum_plot, "Draw the force's spectrum, to a .svg or .png file");
  command->add_option("--plot-wall", options->wall_plot, "Draw the machined walls, to a .svg or .png file");
  command->footer(
      "The robot, tool, material and cut are those of Huynh et al. 2017; docs/robot-passes.md explains the table.\n"
      "Example:\n"
      "  stillcut passes --depths --plot forces.svg --plot-wall wall.svg");
  command->callback([options] { passes(*options); });
}

}  // namespace stillcut
