#include "tools/pattern_gcode.hpp"

#include <cmath>
#include <stdexcept>

#include "drivers/files/csv.hpp"
#include "drivers/files/gcode_writer.hpp"
#include "models/planned_path.hpp"

namespace stillcut {
namespace {

constexpr double kClearance = 5e-3;  // m

std::string rounded_to(double value, double step) { return csv_number(std::round(value / step) * step); }

// A comment wherever the spindle speed changes.
std::vector<std::pair<std::size_t, std::string>> speed_sections(const ToolPath& path) {
  std::vector<std::pair<std::size_t, std::string>> sections;
  double speed = 0.0;
  for (std::size_t i = 0; i < path.moves.size(); ++i) {
    const PathMove& move = path.moves[i];
    if (!move.cutting || move.spindle_speed == speed) continue;
    speed = move.spindle_speed;
    const Eigen::Vector2d way = (move.to - move.from).head<2>();
    sections.emplace_back(i, "feed along " + rounded_to(rad_to_deg(std::atan2(way.y(), way.x())), 0.1) + " deg at " +
                                 rounded_to(rad_s_to_rpm(speed), 1.0) + " rpm");
  }
  return sections;
}

}  // namespace

double planned_depth(const PatternStudy& study, const RatedPattern& pattern) {
  if (&pattern == &study.optimized) return study.plan.axial_depth;
  return (1.0 - study.question.plan.depth_margin) * pattern.rating.common.depth;
}

void write_pattern_gcode(const Cell& cell, const PatternStudy& study, const RatedPattern& pattern,
                         std::optional<double> depth, std::ostream& out) {
  const double layer = planned_depth(study, pattern);
  if (!(layer > 0.0))
    throw InputError(cell.file.string(), 0,
                     "--gcode: no depth is stable along all of \"" + pattern.name + "\" at one speed");
  if (!(study.conditions.feed_per_tooth > 0.0))
    throw InputError(cell.file.string(), 0, "[cut] feed_per_tooth_mm is 0; the program needs a feed");
  const bool has_speeds = &pattern == &study.optimized && !study.plan.patches.empty();
  try {
    const ToolPath once =
        has_speeds ? pattern.path : with_speed(pattern.path, pattern.rating.common.speed, study.conditions);
    const ToolPath path = in_layers(once, depth.value_or(layer), layer, kClearance);
    GcodeHeader header;
    header.name = pattern.name + " for " + cell.file.filename().string();
    header.remarks = {"limits predicted by stillcut, layers of at most " + rounded_to(layer * 1e3, 1e-4) + " mm",
                      "Z 0 is the top of the part"};
    header.sections = speed_sections(path);
    write_gcode(path, out, header);
  } catch (const std::invalid_argument& error) {
    throw InputError(cell.file.string(), 0, std::string("--gcode: ") + error.what());
  }
}

}  // namespace stillcut
