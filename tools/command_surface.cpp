// stillcut surface: the surface that the cell's cut leaves, and how rough it is.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <thread>

#include "drivers/files/cell.hpp"
#include "drivers/files/height_map_file.hpp"
#include "drivers/files/sdf_file.hpp"
#include "tools/output_file.hpp"
#include "tools/output_options.hpp"
#include "tools/plot_surface.hpp"
#include "tools/plot_surface_study.hpp"
#include "tools/progress.hpp"
#include "tools/surface_output.hpp"
#include "tools/surface_study.hpp"

namespace stillcut {
namespace {

struct SurfaceOptions : OutputOptions {
  std::string cell, size = "2x2", grid, resample, posture, compare, sdf, stl, relief;
  std::string path, corner;
  std::string profile = "across", form;
  std::optional<double> cutoff_mm;
  bool still = false, allow_coarse = false;
  double force_noise = SurfaceQuestion{}.force_noise;
  std::uint64_t seed = SurfaceQuestion{}.seed;
  int jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
};

// "NxM", both within the bounds.
template <typename Number>
std::pair<Number, Number> parse_pair(const char* option, const std::string& text, Number least, Number most,
                                     const std::string& wanted) {
  const std::size_t x = std::min(text.find('x'), text.size());
  Number along{}, across{};
  const auto fits = [&](Number value) { return value >= least && value <= most; };  // false for NaN
  const bool good = x < text.size() && CLI::detail::lexical_cast(text.substr(0, x), along) &&
                    CLI::detail::lexical_cast(text.substr(x + 1), across) && fits(along) && fits(across);
  if (!good) throw CLI::ValidationError(option, "'" + text + "' is not " + wanted);
  return {along, across};
}

GridSize parse_grid(const char* option, const std::string& text, int least, const char* wanted) {
  constexpr int kMost = 1'000'000;
  const auto [along, across] = parse_pair<int>(option, text, least, kMost, wanted);
  return {static_cast<std::size_t>(along), static_cast<std::size_t>(across)};
}

SurfaceQuestion question_of(const SurfaceOptions& options) {
  SurfaceQuestion question;
  const auto [along, across] =
      parse_pair<double>("--size", options.size, 1e-6, 1e4, "ALONGxACROSS the feed in mm, such as 2x2 or 5x0.8");
  question.along = 1e-3 * along;
  question.across = 1e-3 * across;
  if (!options.grid.empty())
    question.cells = parse_grid("--grid", options.grid, 2, "ALONGxACROSS the feed in cells, such as 500x500");
  if (!options.resample.empty())
    question.points = parse_grid("--resample", options.resample, 3, "ALONGxACROSS the feed in points, such as 100x100");
  question.allow_coarse = options.allow_coarse;
  question.path = options.path;
  const bool along_path = !options.path.empty();
  if (!along_path && (!options.corner.empty() || options.form == "envelope"))
    throw CLI::ValidationError("--path", "--corner and --form envelope are said of a tool path");
  if (!options.corner.empty())
    question.corner = parse_pair<double>("--corner", options.corner, -1e5, 1e5, "XxY in mm, such as 10x25");
  if (question.corner) question.corner->first *= 1e-3, question.corner->second *= 1e-3;
  question.less_envelope = options.form == "envelope";
  question.vibration = !options.still && !along_path;
  question.posture = options.posture;
  question.profile = options.profile == "along" ? ProfileDirection::along : ProfileDirection::across;
  const bool quadratic = options.form.empty() ? along_path : options.form == "quadratic";
  question.roughness = {quadratic ? SurfaceForm::quadratic : SurfaceForm::linear,
                        options.cutoff_mm ? 1e-3 * *options.cutoff_mm : 0.0};
  question.force_noise = options.force_noise;
  question.seed = options.seed;
  question.threads = options.jobs;
  return question;
}

bool writes_to_standard_output(const SurfaceOptions& options) {
  return options.csv == "-" || options.sdf == "-" || options.stl == "-";
}

void check_surface_usage(const SurfaceOptions& options) {
  check_output_options(options);
  const char* taken = options.json ? "--json" : nullptr;
  for (const auto& [option, file] : {std::pair<const char*, const std::string&>{"--csv", options.csv},
                                     {"--sdf", options.sdf},
                                     {"--stl", options.stl}}) {
    if (file != "-") continue;
    if (taken != nullptr) throw CLI::ValidationError(option, std::string("cannot share standard output with ") + taken);
    taken = option;
  }
  if (!options.relief.empty()) plot::check_picture_name(options.relief);
}

template <typename Write>
void write_map(const std::string& name, const HeightMap& map, Write write) {
  if (name.empty()) return;
  OutputFile file(name);
  try {
    write(file.stream(), map);
  } catch (const std::invalid_argument& error) {  // the format has no room for the map
    throw InputError(name, 0, error.what());
  }
  file.finish();
}

void surface(const SurfaceOptions& options) {
  check_surface_usage(options);
  const SurfaceQuestion question = question_of(options);
  const Cell cell = read_cell(options.cell, {.map = question.vibration, .dbc = false, .bus = false});
  std::optional<MeasuredSurface> measured;
  if (!options.compare.empty()) measured = measured_surface(options.compare, question);
  const MeasuredSurface* beside = measured ? &*measured : nullptr;

  std::optional<Progress> progress;
  std::string task;
  const StudiedSurface study = study_surface(cell, question, [&](const char* now, double share) {
    if (task != now) progress.emplace(task = now);
    progress->update(share);
  });
  progress.reset();
  for (const std::string& line : study.warnings) std::cerr << "stillcut: " << options.cell << ": " << line << '\n';

  write_map(options.csv, study.map, write_height_map_csv);
  write_map(options.sdf, study.map, write_sdf);
  write_map(options.stl, study.map, write_height_map_stl);
  if (!options.plot.empty()) plot::write_figure(surface_study_figure(study, beside), options.plot);
  if (!options.relief.empty()) write_relief(study.map, surface_title(study), options.relief);
  if (options.json) {
    std::cout << surface_json(study, beside).dump() << '\n';
  } else if (!writes_to_standard_output(options)) {
    print_surface(study, beside, std::cout);
  }
}

void add_surface_figures_options(CLI::App& command, SurfaceOptions& options) {
  command.add_option("--profile", options.profile, "R_a, R_q, R_t are means over profiles across the feed or along it")
      ->capture_default_str()
      ->check(CLI::IsMember({"across", "along"}));
  command
      .add_option("--form", options.form,
                  "Removed before: least-squares line or plane (linear, the default), polynomial of order two "
                  "(quadratic, the default along a path), what the ball's body alone leaves along it (envelope)")
      ->check(CLI::IsMember({"linear", "quadratic", "envelope"}));
  command
      .add_option("--cutoff", options.cutoff_mm,
                  "Gaussian filter's λ_c in mm: longer waves are left out (default: no filter)")
      ->check(CLI::Range(1e-6, 1e4).description(""));
  command.add_option("--resample", options.resample,
                     "ALONGxACROSS points that the surface is resampled to before all else, bilinear");
  command.add_option("--compare", options.compare, "Measured map, .csv or .sdf: its figures beside the predicted ones");
}

}  // namespace

void add_surface_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("surface", "The surface that a cut leaves: topography and roughness, vibration included");
  const auto options = std::make_shared<SurfaceOptions>();
  command->add_option("CELL", options->cell, "Cell file")->required();
  command->add_option("--size", options->size, "Of the surface in mm, along the feed x across it")
      ->capture_default_str();
  command->add_option("--grid", options->grid,
                      "Cells, along the feed x across it (default: halved until R_a stands still within 1 %)");
  command->add_flag("--allow-coarse", options->allow_coarse, "Take a grid too coarse for feed marks and scallops");
  command->add_flag("--no-vibration", options->still, "Leave the tool's vibration out; needs no [dynamics]");
  command->add_option("--posture", options->posture,
                      "Id of a measured posture, j1,...,j6 in degrees, or x,y,z in mm where the machine has no joints "
                      "(default: the cell's)");
  command->add_option("--path", options->path,
                      "Tool path, G-code or APT CL, on any form, instead of the cell's passes; without vibration");
  command->add_option("--corner", options->corner,
                      "XxY in mm, where on the workpiece its surface begins (default: the middle of the path)");
  add_surface_figures_options(*command, *options);
  add_output_options(*command, *options, "Write the heights: x_mm,y_mm,z_mm, a row a point",
                     "Draw heights, profiles and spectra");
  command->add_option("--sdf", options->sdf,
                      "Write the heights as a surface data file, for metrology programs; - is standard output");
  command->add_option("--stl", options->stl,
                      "Write the surface as triangles in mm, for CAD programs; - is standard output");
  command->add_option("--relief", options->relief, "Draw the surface in three dimensions, to a .svg or .png file");
  command->add_option("--force-noise", options->force_noise, "Variation of the cutting force, rms, relative")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0).description(""));
  command->add_option("--seed", options->seed, "Of that noise")->capture_default_str();
  command->add_option("--jobs", options->jobs, "Threads (default: one a processor)")
      ->check(CLI::Range(1, 256).description(""));
  command->footer(
      "Examples: what a cell's cut leaves, as a table and a picture; at another posture, beside a measured map; along\n"
      "a tool path:\n"
      "  stillcut surface examples/surface-cell/cell.toml --force-noise 0.6 --plot surface.png\n"
      "  stillcut surface examples/surface-cell/cell.toml --grid 500x500 --resample 100x100 --posture B \\\n"
      "    --compare measured.sdf --relief relief.png\n"
      "  stillcut surface examples/surface-cell/cell.toml --path part.cls --size 3x3 --relief relief.png");
  command->callback([options] { surface(*options); });
}

}  // namespace stillcut
