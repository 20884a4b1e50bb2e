#include "tools/surface_study.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "drivers/files/height_map_file.hpp"
#include "dsp/numbers.hpp"
#include "models/surface_refinement.hpp"
#include "models/surface_resampling.hpp"
#include "models/surface_vibration.hpp"
#include "tools/cell_posture.hpp"
#include "tools/path_surface_study.hpp"
#include "tools/tasks_on_threads.hpp"

namespace stillcut {
namespace {

// With a map its copy less the form is held: two of these are a gigabyte and a half.
constexpr double kMostPoints = 1e8;
// Up to here a grid is halved. Finer ones are rarely needed, and take minutes.
constexpr double kMostRefinedPoints = 6e6;

// What the models' messages begin with, and the key that a user finds it under.
constexpr std::array<std::pair<std::string_view, const char*>, 6> kKeys{{
    {"tilt and lead: ", "cut.tilt_deg, cut.lead_deg: "},
    {"step-over: ", "cut.step_over_mm: "},
    {"runout: ", "tool.runout_mm: "},
    {"feed, step-over and runout: ", "cut.feed_per_tooth_mm, cut.step_over_mm, tool.runout_mm: "},
    {"the cutoff ", "--cutoff: "},
    {"grid: ", "--grid: "},
}};

InputError said_of_cell(const Cell& cell, std::string text) {
  for (const auto& [begin, key] : kKeys) {
    if (!text.starts_with(begin)) continue;
    text.replace(0, begin.size(), key);
    break;
  }
  // Where no step-over is given it is the radial depth.
  constexpr std::string_view kStepOver = "cut.step_over_mm";
  if (cell.cut && cell.cut->step_over == 0.0 && text.starts_with(kStepOver))
    text.replace(0, kStepOver.size(), "cut.radial_depth_mm");
  return {cell.file.string(), 0, text};
}

// The tool as it goes over the surface, whichever path that is.
struct ToolOverSurface {
  CutterMotion motion;
  std::vector<CutterPass> passes;
};

ToolOverSurface vibrating_tool(const Cell& cell, const SurfaceWatch& watch, StudiedSurface& study) {
  const SurfaceQuestion& question = study.question;
  const PredictedPosture predicted = predicted_posture(cell, read_cell_dynamics(cell), question.posture);
  if (predicted.outside) study.warnings.push_back(outside_map_text(predicted) + "; the vibration is an extrapolation");
  const VibrationSetup setup{.tool = study.tool,
                             .material = require(cell, cell.material, "material"),
                             .cut = study.cut,
                             .modes = predicted.posture.modes,
                             .force_noise = question.force_noise,
                             .seed = question.seed,
                             .progress = [&](double share) { watch("vibration", share); }};
  try {
    VibratingCutter cutter = vibrating_cutter(setup, question.along, question.across);
    study.vibration = StudiedVibration{.posture = predicted.posture.id,
                                       .modes = predicted.posture.modes.size(),
                                       .mean = cutter.vibration.mean,
                                       .rms = cutter.vibration.rms,
                                       .peak = cutter.vibration.peak};
    return {std::move(cutter.motion), std::move(cutter.vibration.passes)};
  } catch (const std::exception& error) {  // what cannot be simulated, and a motion that leaves all bounds
    throw InputError(
        cell.file.string(), 0,
        "the vibration cannot be simulated: " + std::string(error.what()) + "; --no-vibration leaves it out");
  }
}

GridSize cells_of(const HeightMap& map) { return {map.along - 1, map.across - 1}; }

// The fewest that show feed marks and scallops.
GridSize fewest_cells(const Cut& cut, const SurfaceQuestion& question) {
  const auto cells = [spacing = coarsest_spacing(cut)](double length) {
    return static_cast<std::size_t>(std::max(1.0, std::ceil(length / spacing * (1.0 - 1e-9))));
  };
  return {cells(question.along), cells(question.across)};
}

double points_of(const GridSize& cells) {
  return (static_cast<double>(cells.along) + 1.0) * (static_cast<double>(cells.across) + 1.0);
}

std::string grid_text(const GridSize& cells) {
  return std::to_string(cells.along) + "x" + std::to_string(cells.across);
}

// Everything about a surface but the tool that leaves it.
class Sweeper {
 public:
  Sweeper(const Cut& cut, const SurfaceQuestion& question, const SurfaceWatch& watch)
      : cut_{cut}, question_{question}, workers_{watched_workers(question.threads, watch)} {}

  [[nodiscard]] HeightMap swept(const ToolOverSurface& tool, const GridSize& cells) const {
    HeightMap map = uncut_map(question_.along, question_.across, cells.along, cells.across);
    const SurfaceSweep sweep(tool.motion, cut_, map.spacing_along, map.spacing_across, true);
    sweep_all(sweep, map, tool.passes, workers_);
    return map;
  }

  [[nodiscard]] double roughness_of(const HeightMap& map) const {
    return mean_roughness(map, question_.profile, question_.roughness).mean.ra;
  }

  // The first grid is there to be compared with: the second one is the coarsest that shows everything.
  [[nodiscard]] RefinedSurface refined(const ToolOverSurface& tool) const {
    return refined_surface(tool.motion, cut_, tool.passes,
                           {.along = question_.along,
                            .across = question_.across,
                            .spacing = 2.0 * coarsest_spacing(cut_),
                            .allow_coarse = true,
                            .most_points = static_cast<std::size_t>(kMostRefinedPoints),
                            .figure = [this](const HeightMap& map) { return roughness_of(map); },
                            .workers = workers_});
  }

  // Resampled where that was asked for.
  [[nodiscard]] HeightMap as_asked(HeightMap map) const {
    return question_.points ? resampled(map, question_.points->along, question_.points->across) : std::move(map);
  }
  [[nodiscard]] SurfaceFigures figures_of(const HeightMap& map) const {
    return surface_figures(map, question_.profile, question_.roughness);
  }

 private:
  Cut cut_;
  SurfaceQuestion question_;
  Workers workers_;
};

// As a refinement estimates it: what a grid twice as coarse would change. Grids of a few cells tell nothing.
double error_beside(const StudiedSurface& study, const Sweeper& sweeper, const ToolOverSurface& tool,
                    double roughness) {
  constexpr std::size_t kLeastCells = 16;
  if (std::min(study.cells.along, study.cells.across) < kLeastCells) return kInfinity;
  const GridSize half{(study.cells.along + 1) / 2, (study.cells.across + 1) / 2};
  const double coarse = sweeper.roughness_of(sweeper.swept(tool, half));
  return std::abs(coarse - roughness) / std::max(std::abs(roughness), 1e-12);
}

void check_grid(const Cell& cell, const StudiedSurface& study) {
  const SurfaceQuestion& question = study.question;
  const GridSize &cells = study.cells, &needed = study.needed;
  std::array<char, 240> text{};
  if (points_of(cells) > kMostPoints) {
    std::snprintf(text.data(), text.size(),
                  "--grid: %s cells over %g x %g mm have more than %.0f million points; make the surface smaller with "
                  "--size, or give a coarser --grid%s",
                  grid_text(cells).c_str(), 1e3 * question.along, 1e3 * question.across, 1e-6 * kMostPoints,
                  points_of(needed) > kMostPoints ? " with --allow-coarse" : "");
    throw InputError(cell.file.string(), 0, text.data());
  }
  if (question.points &&
      static_cast<double>(question.points->along) * static_cast<double>(question.points->across) > kMostPoints) {
    std::snprintf(text.data(), text.size(), "--resample: %s are more than %.0f million points; ask for fewer",
                  grid_text(*question.points).c_str(), 1e-6 * kMostPoints);
    throw InputError(cell.file.string(), 0, text.data());
  }
  if (question.allow_coarse || (cells.along >= needed.along && cells.across >= needed.across)) return;
  const double spacing =
      std::max(question.along / static_cast<double>(cells.along), question.across / static_cast<double>(cells.across));
  std::snprintf(
      text.data(), text.size(),
      "--grid: %.4g mm between points is too coarse for this feed and step-over, at most %.4g mm; use --grid %s "
      "or finer, or --allow-coarse",
      1e3 * spacing, 1e3 * coarsest_spacing(study.cut), grid_text(needed).c_str());
  throw InputError(cell.file.string(), 0, text.data());
}

void sweep_with_and_without(const ToolOverSurface& still, const std::optional<ToolOverSurface>& vibrates,
                            const SurfaceWatch& watch, StudiedSurface& study) {
  const Sweeper sweeper(study.cut, study.question, watch);
  const ToolOverSurface& tool = vibrates ? *vibrates : still;
  HeightMap map;
  if (!study.question.cells && points_of(study.cells) <= kMostRefinedPoints) {
    RefinedSurface refined = sweeper.refined(tool);
    map = std::move(refined.map);
    study.cells = cells_of(map);
    study.error = refined.error;
  }
  // On the same passes and grid, and before a large map is held, so that there is but one at a time.
  if (vibrates) {
    const HeightMap smooth = sweeper.as_asked(sweeper.swept({still.motion, vibrates->passes}, study.cells));
    study.without_vibration = sweeper.figures_of(smooth);
  }
  if (map.heights.empty()) {
    map = sweeper.swept(tool, study.cells);
    study.error = error_beside(study, sweeper, tool, sweeper.roughness_of(map));
  }
  study.map = sweeper.as_asked(std::move(map));
  study.figures = sweeper.figures_of(study.map);
}

double interval_of(const HeightMap& map, ProfileDirection direction) {
  try {
    return texture_interval(texture_spectrum(map, direction)).interval;
  } catch (const std::invalid_argument&) {  // too few points, or too few of them known
    return kNaN;
  }
}

}  // namespace

Workers watched_workers(int threads, const SurfaceWatch& watch) {
  return [threads, &watch](std::size_t count, const std::function<void(std::size_t)>& task) {
    std::atomic<std::size_t> done{0};
    const auto counted = [&](std::size_t i) {
      task(i);
      ++done;
    };
    run_tasks(count, threads, counted,
              [&] { watch("surface", static_cast<double>(done) / static_cast<double>(count)); });
  };
}

SurfaceFigures surface_figures(const HeightMap& map, ProfileDirection profile, const RoughnessSettings& settings) {
  return {.profiles = mean_roughness(map, profile, settings),
          .area = areal_roughness(map, settings),
          .interval_along = interval_of(map, ProfileDirection::along),
          .interval_across = interval_of(map, ProfileDirection::across)};
}

MeasuredSurface measured_surface(const std::filesystem::path& file, const SurfaceQuestion& question) {
  MeasuredSurface measured{.file = file.filename().string(), .map = read_height_map(file), .figures = {}};
  try {
    measured.figures = surface_figures(measured.map, question.profile, question.roughness);
  } catch (const std::invalid_argument& error) {
    throw InputError(file.string(), 0, error.what());
  }
  return measured;
}

StudiedSurface study_surface(const Cell& cell, const SurfaceQuestion& question, const SurfaceWatch& watch) {
  StudiedSurface study;
  study.question = question;
  study.tool = require(cell, cell.tool, "tool");
  study.cut = require(cell, cell.cut, "cut");
  if (cell.material) study.material = cell.material->name;
  if (!question.path.empty()) {
    study_path_surface(watch, study);
    return study;
  }
  try {
    ToolOverSurface still{.motion = cutter_motion(study.tool, study.cut), .passes = {}};
    still.passes = passes_over(still.motion, study.cut, question.along, question.across);
    study.needed = fewest_cells(study.cut, question);
    study.cells = question.cells.value_or(study.needed);
    check_grid(cell, study);
    std::optional<ToolOverSurface> vibrates;
    if (question.vibration) vibrates = vibrating_tool(cell, watch, study);
    sweep_with_and_without(still, vibrates, watch, study);
  } catch (const std::invalid_argument& error) {
    throw said_of_cell(cell, error.what());
  }
  return study;
}

}  // namespace stillcut
