#include "tools/pattern_gcode.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "drivers/files/gcode_writer.hpp"
#include "dsp/numbers.hpp"
#include "models/planned_path.hpp"

namespace stillcut {
namespace {

std::string with_digits(double value, int digits) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

// A comment wherever the spindle speed or, where lines go one way, the direction changes.
std::vector<std::pair<std::size_t, std::string>> sections_of(const ToolPath& path) {
  std::vector<std::pair<std::size_t, std::string>> sections;
  constexpr double kShortLine = 2e-3;  // m: has the direction of its rounding
  double speed = 0.0, direction = kInfinity;
  for (std::size_t i = 0; i < path.moves.size(); ++i) {
    const PathMove& move = path.moves[i];
    const Eigen::Vector2d way = (move.to - move.from).head<2>();
    if (!move.cutting || way.norm() < kShortLine) continue;
    const double towards = std::atan2(way.y(), way.x());
    if (move.spindle_speed == speed && std::abs(towards - direction) < 1e-3) continue;
    speed = move.spindle_speed;
    direction = towards;
    sections.emplace_back(i, "feed along " + with_digits(rad_to_deg(towards), 1) + " deg at " +
                                 with_digits(rad_s_to_rpm(speed), 0) + " rpm");
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
  if (pattern.source == PatternSource::file)
    throw InputError(pattern.file, 0, "is a program already; --gcode writes patterns and the optimized path");
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
    const ToolPath path = in_layers(once, depth.value_or(layer), layer, PatternSettings{}.clearance);
    GcodeHeader header;
    header.name = pattern.name + " for " + cell.file.filename().string();
    header.remarks = {"limits predicted by stillcut, layers of at most " + with_digits(layer * 1e3, 4) + " mm",
                      "Z 0 is the top of the part"};
    header.sections = has_speeds ? sections_of(path) : std::vector<std::pair<std::size_t, std::string>>{};
    write_gcode(path, out, header);
  } catch (const std::invalid_argument& error) {
    throw InputError(cell.file.string(), 0, std::string("--gcode: ") + error.what());
  }
}

}  // namespace stillcut
