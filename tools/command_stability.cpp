// stillcut stability: are these cuts stable? The spectral radius of each cut in a file, at a posture.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "drivers/files/cell.hpp"
#include "drivers/files/csv.hpp"
#include "models/cut_stability.hpp"
#include "models/linear_cut.hpp"
#include "models/receptance.hpp"
#include "tools/cell_posture.hpp"
#include "tools/cut_points.hpp"
#include "tools/output_file.hpp"
#include "tools/output_options.hpp"
#include "tools/plot_lobes.hpp"
#include "tools/progress.hpp"

namespace stillcut {
namespace {

struct StabilityOptions : OutputOptions {
  std::string cell, points, posture;
  std::optional<double> feed_direction_deg;
};

struct Judged {
  Cell cell;
  PredictedPosture predicted;
  Cut cut;
  bool unequal_pitch = false;  // the cut then repeats from turn to turn, else from tooth to tooth
  std::vector<CutPoint> points;
  std::vector<CutStability> answers;  // one a point
};

constexpr std::array kVerdicts{"stable", "near the limit", "unstable"};
constexpr std::array kKinds{"hopf", "flip", "fold"};
const char* name_of(Verdict verdict) { return kVerdicts.at(static_cast<std::size_t>(verdict)); }
const char* name_of(Instability kind) { return kKinds.at(static_cast<std::size_t>(kind)); }

LinearCut linear_cut_of(const Cell& cell, const Cut& cut, std::span<const Mode> modes) {
  try {
    check_modes(modes);
    return linear_cut(require(cell, cell.tool, "tool"), require(cell, cell.material, "material"), cut);
  } catch (const std::invalid_argument& error) {
    throw InputError(cell.file.string(), 0, error.what());
  }
}

// The two depths beside the asked one are looked at only for an output that shows the verdict.
CutStability judge(const LinearCut& cut, std::span<const Mode> modes, const CutPoint& point, bool with_verdict) {
  const double speed = rpm_to_rad_s(point.spindle_speed_rpm), depth = point.axial_depth_mm * 1e-3;
  if (with_verdict) return cut_stability(cut, modes, speed, depth);
  return {floquet_point(cut, modes, speed, depth), Verdict::stable};
}

Judged compute(const StabilityOptions& options, bool with_verdicts) {
  Judged judged{.cell = read_cell(options.cell, {.dbc = false, .bus = false}),
                .predicted = {},
                .cut = {},
                .points = {},
                .answers = {}};
  const Cell& cell = judged.cell;
  judged.cut = require(cell, cell.cut, "cut");
  if (options.feed_direction_deg) judged.cut.feed_direction = deg_to_rad(*options.feed_direction_deg);
  judged.predicted = stability_posture(cell, read_cell_dynamics(cell), options.posture);
  const LinearCut linear = linear_cut_of(cell, judged.cut, judged.predicted.posture.modes);
  judged.unequal_pitch = !linear.pitch.empty();
  judged.points = read_cut_points(options.points);
  const std::vector<Mode> modes = modes_in_feed_frame(judged.predicted.posture.modes, judged.cut.feed_direction);
  Progress progress("stability");
  for (const CutPoint& point : judged.points) {
    try {
      judged.answers.push_back(judge(linear, modes, point, with_verdicts));
    } catch (const std::invalid_argument& error) {
      throw InputError(options.points, point.line, std::string("spindle_speed_rpm, axial_depth_mm: ") + error.what());
    }
    progress.update(static_cast<double>(judged.answers.size()) / static_cast<double>(judged.points.size()));
  }
  progress.finish();
  for (const std::string& line : stability_warnings(*cell.tool, judged.cut, judged.predicted)) {
    std::cerr << "stillcut: " << options.cell << ": " << line << '\n';
  }
  return judged;
}

void write_csv(const Judged& judged, const std::string& name) {
  OutputFile file(name);
  file.stream() << "spindle_speed_rpm,axial_depth_mm,spectral_radius,chatter_frequency_hz,period_s\n";
  for (std::size_t i = 0; i < judged.points.size(); ++i) {
    const FloquetPoint& answer = judged.answers[i].point;
    const std::string fields[] = {csv_number(judged.points[i].spindle_speed_rpm),
                                  csv_number(judged.points[i].axial_depth_mm), csv_number(answer.spectral_radius),
                                  csv_number_or_empty(answer.chatter_frequency / kTwoPi), csv_number(answer.period)};
    write_csv_row(file.stream(), fields);
  }
  file.finish();
}

void print_json(const Judged& judged) {
  nlohmann::ordered_json points = nlohmann::json::array();
  for (std::size_t i = 0; i < judged.points.size(); ++i) {
    const auto& [answer, verdict] = judged.answers[i];
    points.push_back({{"spindle_speed_rpm", judged.points[i].spindle_speed_rpm},
                      {"axial_depth_mm", judged.points[i].axial_depth_mm},
                      {"spectral_radius", answer.spectral_radius},
                      {"chatter_frequency_hz", answer.chatter_frequency / kTwoPi},
                      {"period_s", answer.period},
                      {"verdict", name_of(verdict)},
                      {"instability", name_of(answer.instability)},
                      {"error_estimate", answer.error_estimate}});
  }
  const nlohmann::ordered_json object{{"posture", judged.predicted.posture.id},
                                      {"nearest_posture", judged.predicted.nearest},
                                      {"outside_map", judged.predicted.outside},
                                      {"feed_direction_deg", rad_to_deg(judged.cut.feed_direction)},
                                      {"points", points}};
  std::cout << object.dump() << '\n';
}

void print_table(const Judged& judged) {
  std::printf("posture %s, feed direction %g°; radius of the vibration from one %s to the next, stable below 1\n\n",
              judged.predicted.posture.id.c_str(), rad_to_deg(judged.cut.feed_direction),
              judged.unequal_pitch ? "turn" : "tooth");
  std::printf("%10s %10s %10s %9s  %-15s %-5s %11s\n", "speed", "depth", "radius", "± error", "verdict", "kind",
              "frequency");
  std::printf("%10s %10s %10s %9s  %-15s %-5s %11s\n", "rpm", "mm", "", "", "", "", "Hz");
  for (std::size_t i = 0; i < judged.points.size(); ++i) {
    const auto& [answer, verdict] = judged.answers[i];
    std::printf("%10.6g %10.6g %10.5f %9.1e  %-15s %-5s %11.2f\n", judged.points[i].spindle_speed_rpm,
                judged.points[i].axial_depth_mm, answer.spectral_radius, answer.error_estimate, name_of(verdict),
                name_of(answer.instability), answer.chatter_frequency / kTwoPi);
  }
  std::printf("\nnear the limit: %g %% more or less depth would turn the verdict\n", 100.0 * kNearLimitDepth);
}

// The cuts on the lobes of their speeds.
void draw(const Judged& judged, const StabilityOptions& options) {
  std::vector<MeasuredCut> cuts;
  double slowest = judged.points.front().spindle_speed_rpm, fastest = slowest, deepest = 0.0;
  for (std::size_t i = 0; i < judged.points.size(); ++i) {
    cuts.push_back({judged.points[i], judged.answers[i].verdict});
    slowest = std::min(slowest, judged.points[i].spindle_speed_rpm);
    fastest = std::max(fastest, judged.points[i].spindle_speed_rpm);
    deepest = std::max(deepest, judged.points[i].axial_depth_mm * 1e-3);
  }
  constexpr int kSpeeds = 151;
  constexpr double kAround = 0.05, kAbove = 1.5;  // what is shown beside and above the cuts, relative
  constexpr double kShallowest = 1e-3;            // m, of the picture where every cut has depth 0
  LobeQuestion question;
  if (!options.posture.empty()) question.postures = {options.posture};
  question.feed_directions = {judged.cut.feed_direction};
  question.speeds =
      equally_spaced_speeds(rpm_to_rad_s(slowest * (1.0 - kAround)), rpm_to_rad_s(fastest * (1.0 + kAround)), kSpeeds);
  question.settings.max_depth = deepest > 0.0 ? kAbove * deepest : kShallowest;
  Progress progress("lobes");
  const LobeStudy study = study_lobes(judged.cell, question, [&](double share) { progress.update(share); });
  plot::write_figure(lobe_figure(study, cuts, kPredictedCuts), options.plot);
}

void run(const StabilityOptions& options) {
  check_output_options(options);
  const bool table = !options.json && options.csv.empty();
  const Judged judged = compute(options, table || options.json || !options.plot.empty());
  if (!options.csv.empty()) write_csv(judged, options.csv);
  if (!options.plot.empty()) draw(judged, options);
  if (options.json) print_json(judged);
  if (table) print_table(judged);
}

}  // namespace

void add_stability_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("stability", "Is this cut stable: the spectral radius of each cut in a file");
  const auto options = std::make_shared<StabilityOptions>();
  command->add_option("CELL", options->cell, "Cell file")->required();
  command->add_option("--points", options->points, "CSV file of cuts, columns spindle_speed_rpm,axial_depth_mm")
      ->required();
  command->add_option("--posture", options->posture,
                      "Id of a measured posture, j1,...,j6 in degrees, or x,y,z in mm where the machine has no joints "
                      "(default: the cell's)");
  command->add_option("--feed-direction", options->feed_direction_deg,
                      "Degrees from +X toward +Y (default: the cell's)");
  add_output_options(*command, *options, "Write radius, frequency and period of each cut",
                     "Draw the cuts on their lobes");
  command->footer(
      "Example: is the cell's cut stable, and would it be at 7570 rpm?\n"
      "  printf 'spindle_speed_rpm,axial_depth_mm\\n8500,3.6\\n7570,3.6\\n' > cuts.csv\n"
      "  stillcut stability examples/demo-cell/cell.toml --points cuts.csv");
  command->callback([options] { run(*options); });
}

}  // namespace stillcut
