#include "tools/pattern_paths.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "drivers/files/csv.hpp"
#include "drivers/files/tool_path_file.hpp"
#include "models/places.hpp"

namespace stillcut {
namespace {

RatedPattern made(const Cell& cell, PatternKind kind, double angle, const PatternSettings& settings) {
  const bool lines = kind == PatternKind::zig || kind == PatternKind::zig_zag;
  RatedPattern pattern;
  try {
    pattern.path = make_pattern(require(cell, cell.region, "region"), kind, angle, settings);
  } catch (const std::invalid_argument& error) {
    throw InputError(cell.file.string(), 0, std::string("[region] ") + error.what());
  }
  pattern.name = pattern.path.name;
  pattern.source = lines ? PatternSource::lines : PatternSource::loops;
  pattern.file = cell.file.string();
  return pattern;
}

// Files that only differ in folder, or are called like a pattern, stay apart.
RatedPattern read(const std::filesystem::path& file, std::set<std::string>& names) {
  RatedPattern pattern;
  pattern.path = read_tool_path(file);
  pattern.name = names.contains(file.stem().string()) ? file.string() : file.stem().string();
  pattern.path.name = pattern.name;
  pattern.source = PatternSource::file;
  pattern.file = file.string();
  names.insert(pattern.name);
  return pattern;
}

std::string to_tenths_mm(double metres) { return csv_number(std::round(metres * 1e4) / 10.0) + " mm"; }

}  // namespace

PatternSettings pattern_settings(const Cell& cell, const PatternQuestion& question) {
  PatternSettings settings;
  settings.tool_radius = 0.5 * require(cell, cell.tool, "tool").diameter;
  settings.step_over = question.cut.step_over > 0.0 ? question.cut.step_over : question.cut.radial_depth;
  settings.milling = question.cut.milling == Milling::up ? Milling::up : Milling::down;
  settings.face = question.face;
  return settings;
}

std::vector<RatedPattern> paths_to_rank(const Cell& cell, const PatternQuestion& question,
                                        const std::vector<double>& angles, const std::vector<Eigen::Vector2d>& places) {
  std::vector<RatedPattern> patterns;
  if (cell.region || question.paths.empty()) {
    const PatternSettings settings = pattern_settings(cell, question);
    for (const PatternKind kind : {PatternKind::zig, PatternKind::zig_zag})
      for (const double angle : angles) patterns.push_back(made(cell, kind, angle, settings));
    for (const PatternKind kind :
         {PatternKind::periphery_in, PatternKind::periphery_out, PatternKind::spiral_in, PatternKind::spiral_out})
      patterns.push_back(made(cell, kind, 0.0, settings));
  }
  std::set<std::string> names{"optimized"};
  for (const RatedPattern& pattern : patterns) names.insert(pattern.name);
  for (const std::filesystem::path& file : question.paths) patterns.push_back(read(file, names));
  for (RatedPattern& pattern : patterns) {
    pattern.on = path_on_locations(pattern.path, places);
    if (pattern.on.cuts.empty())
      throw InputError(pattern.file, 0, "cuts nowhere in the plane: it has no feed move across X and Y");
  }
  return patterns;
}

std::vector<std::size_t> used_locations(const std::vector<RatedPattern>& patterns) {
  std::set<std::size_t> used;
  for (const RatedPattern& pattern : patterns)
    for (const LocalCut& cut : pattern.on.cuts) used.insert(cut.location);
  return {used.begin(), used.end()};
}

void check_covered(const std::vector<RatedPattern>& patterns, const std::vector<Eigen::Vector2d>& places,
                   std::optional<double> reach) {
  if (!reach) {  // of those used, so that a posture far away from all of this makes nothing seem near
    const std::vector<std::size_t> used = used_locations(patterns);
    std::vector<Eigen::Vector2d> used_places;
    used_places.reserve(used.size());
    for (const std::size_t i : used) used_places.push_back(places[i]);
    reach = used.size() > 1 ? reach_of(used_places) : reach_of(places);
  }
  for (const RatedPattern& pattern : patterns) {
    if (pattern.on.farthest <= *reach) continue;
    throw InputError(pattern.file, 0,
                     pattern.name + " goes to (" + to_tenths_mm(pattern.on.farthest_place.x()) + ", " +
                         to_tenths_mm(pattern.on.farthest_place.y()) + "), " + to_tenths_mm(pattern.on.farthest) +
                         " from the nearest posture of the map, which speaks for " + to_tenths_mm(*reach) +
                         " around it; measure there, or say with --reach how far a posture holds");
  }
}

std::vector<std::string> path_warnings(const Cell& cell, const PatternQuestion& question,
                                       const std::vector<RatedPattern>& patterns) {
  std::vector<std::string> lines;
  if (cell.region && pattern_settings(cell, question).step_over > question.cut.radial_depth * (1.0 + 1e-9)) {
    lines.push_back(
        "[cut] step_over_mm is more than radial_depth_mm: lines lie wider apart than the cut that the limits "
        "are for; give them alike");
  }
  for (const RatedPattern& pattern : patterns) {
    constexpr double kUpright = 0.9999;  // 0.8 degrees
    if (std::any_of(pattern.path.moves.begin(), pattern.path.moves.end(),
                    [](const PathMove& move) { return move.cutting && move.tool_axis.z() < kUpright; }))
      lines.push_back(pattern.file + " tilts the tool; it is rated as if upright");
  }
  return lines;
}

}  // namespace stillcut
