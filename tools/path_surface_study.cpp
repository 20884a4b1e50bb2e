#include "tools/path_surface_study.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>

#include "drivers/files/tool_path_file.hpp"
#include "models/path_envelope.hpp"
#include "models/path_surface.hpp"
#include "models/surface_resampling.hpp"

namespace stillcut {
namespace {

std::string counted(const char* format, auto... values) {
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

// What a reader of the figures has to know of the path.
std::vector<std::string> path_warnings(const PathSurface& surface, const std::string& file) {
  std::vector<std::string> warnings;
  if (surface.uncovered > 0)
    warnings.push_back(
        counted("%zu points are reached by no move of %s; they are left out", surface.uncovered, file.c_str()));
  if (surface.on_shank > 0)
    warnings.push_back(counted("%s:%d: the tool's shank, not its ball, would make %zu points; they are left out",
                               file.c_str(), surface.shank_line, surface.on_shank));
  if (surface.struck > 0)
    warnings.push_back(
        counted("%s:%d: a move that does not cut passes up to %.3g mm below the surface, over %zu points", file.c_str(),
                surface.strike_line, 1e3 * surface.deepest_strike, surface.struck));
  return warnings;
}

}  // namespace

void study_path_surface(const SurfaceWatch& watch, StudiedSurface& study) {
  const SurfaceQuestion& question = study.question;
  const std::string file = question.path.string();
  try {
    const double feed_rate = study.cut.feed_per_tooth * study.tool.teeth * study.cut.spindle_speed / kTwoPi;
    const CutterPath path =
        cutter_path(study.tool, read_tool_path(question.path),
                    {.feed_rate = feed_rate, .spindle_speed = study.cut.spindle_speed, .angle = study.cut.redundancy});
    PathWindow window = middle_of(path, question.along, question.across);
    if (question.corner) window.x = question.corner->first, window.y = question.corner->second;
    PathSurfaceSetup setup;
    if (question.cells)
      setup.spacing = std::min(question.along / static_cast<double>(question.cells->along),
                               question.across / static_cast<double>(question.cells->across));
    setup.allow_coarse = question.allow_coarse;
    setup.keep_envelope = question.less_envelope;
    setup.workers = watched_workers(question.threads, watch);
    PathSurface surface = path_surface(path, window, setup);
    study.cells = {surface.map.along - 1, surface.map.across - 1};
    study.error = std::numeric_limits<double>::infinity();
    study.question.corner = {window.x, window.y};
    if (question.less_envelope) remove_envelope(surface.map, surface.envelope);
    study.map = question.points ? resampled(surface.map, question.points->along, question.points->across)
                                : std::move(surface.map);
    study.figures = surface_figures(study.map, question.profile, question.roughness);
    study.warnings = path_warnings(surface, file);
  } catch (const std::invalid_argument& error) {
    throw InputError(file, 0, error.what());
  }
}

}  // namespace stillcut
