#include <cmath>

#include "drivers/files/cell_sections.hpp"
#include "drivers/files/csv.hpp"

namespace stillcut {
namespace {

constexpr double kMilli = 1e-3;              // mm -> m
constexpr double kMega = 1e6;                // MPa -> Pa
constexpr double kKilo = 1e3;                // N/mm -> N/m
constexpr Bounds kLengthMm = above(0, 1e3);  // of tools and cuts; a larger number is one in the wrong unit
constexpr Bounds kSpeedRpm = above(0, 1e6);
constexpr Bounds kAngleDeg = from(-360, 360);
constexpr Bounds kInclineDeg{-90, 90};
constexpr double kPitchSumToleranceDeg = 0.01;

std::vector<double> read_pitch(TomlSection& section, int teeth) {
  std::vector<double> pitch = section.numbers("pitch_deg", above(0, 360));
  if (pitch.empty() && !section.has("pitch_deg")) return std::vector<double>(teeth, kTwoPi / teeth);
  if (pitch.size() != static_cast<std::size_t>(teeth)) {
    section.fail("pitch_deg", "has " + std::to_string(pitch.size()) + " angles for " + std::to_string(teeth) +
                                  " teeth; give one a tooth");
  }
  double sum = 0.0;
  for (const double angle : pitch) sum += angle;
  if (std::abs(sum - 360.0) > kPitchSumToleranceDeg) {
    section.fail("pitch_deg", "adds up to " + csv_number(sum) + " degrees; the angles of a turn add up to 360");
  }
  for (double& angle : pitch) angle = deg_to_rad(angle);
  return pitch;
}

Contour contour_in_metres(const std::vector<std::array<double, 2>>& points_mm) {
  Contour contour;
  for (const auto& [x, y] : points_mm) contour.emplace_back(x * kMilli, y * kMilli);
  return without_repeats(contour);
}

}  // namespace

Tool read_tool(TomlSection section) {
  Tool tool;
  tool.shape = section.choice<ToolShape>("shape", {{"end", ToolShape::end}, {"ball", ToolShape::ball}});
  tool.diameter = section.number("diameter_mm", kLengthMm) * kMilli;
  tool.teeth = section.whole_number("teeth", 1, 100);
  const bool teeth_known = section.has("teeth");
  tool.pitch = teeth_known ? read_pitch(section, tool.teeth) : section.numbers("pitch_deg", kAnyNumber);
  tool.helix = deg_to_rad(section.number("helix_deg", from(-89, 89), 0.0));
  tool.runout = section.number("runout_mm", from(0, 10), 0.0) * kMilli;
  tool.runout_angle = deg_to_rad(section.number("runout_angle_deg", kAngleDeg, 0.0));
  tool.axial_runout = section.number("axial_runout_mm", from(-10, 10), 0.0) * kMilli;
  section.finish();
  return tool;
}

Material read_material(TomlSection section) {
  Material material;
  material.name = section.text("name");
  material.ktc = section.number("ktc_mpa", above(0, 1e6)) * kMega;
  material.krc = section.number("krc_mpa", from(0, 1e6)) * kMega;
  material.kac = section.number("kac_mpa", from(-1e6, 1e6), 0.0) * kMega;
  material.kte = section.number("kte_n_per_mm", from(0, 1e6), 0.0) * kKilo;
  material.kre = section.number("kre_n_per_mm", from(0, 1e6), 0.0) * kKilo;
  material.kae = section.number("kae_n_per_mm", from(-1e6, 1e6), 0.0) * kKilo;
  material.process_damping = section.number("process_damping_n_per_m", from(0, 1e12), 0.0);
  section.finish();
  return material;
}

Cut read_cut(TomlSection section, const std::optional<Tool>& tool) {
  Cut cut;
  cut.milling =
      section.choice<Milling>("milling", {{"down", Milling::down}, {"up", Milling::up}, {"slot", Milling::slot}});
  const double radial_depth_mm = section.number("radial_depth_mm", kLengthMm);
  cut.radial_depth = radial_depth_mm * kMilli;
  cut.axial_depth = section.number("axial_depth_mm", kLengthMm) * kMilli;
  cut.feed_per_tooth = section.number("feed_per_tooth_mm", above(0, 100)) * kMilli;
  cut.spindle_speed = rpm_to_rad_s(section.number("spindle_speed_rpm", kSpeedRpm));
  cut.feed_direction = deg_to_rad(section.number("feed_direction_deg", kAngleDeg));
  cut.tilt = deg_to_rad(section.number("tilt_deg", kInclineDeg, 0.0));
  cut.lead = deg_to_rad(section.number("lead_deg", kInclineDeg, 0.0));
  cut.redundancy = deg_to_rad(section.number("redundancy_deg", kAngleDeg, 0.0));
  cut.step_over = section.number("step_over_mm", from(0, 1e3), 0.0) * kMilli;
  cut.path = section.choice<PathKind>(
      "path", {{"unidirectional", PathKind::unidirectional}, {"zigzag", PathKind::zigzag}}, PathKind::unidirectional);
  section.finish();
  // Compared in metres as read, both scaled by the same factor: equal numbers in the file are equal here.
  if (tool && cut.radial_depth > tool->diameter) {
    section.fail("radial_depth_mm",
                 csv_number(radial_depth_mm) + " is out of range; give a number up to the tool's " + "diameter");
  }
  return cut;
}

Region read_region(TomlSection section) {
  const auto polygon_mm = section.points("polygon_mm");
  const auto islands_mm = section.lists_of_points("islands_mm");
  section.finish();
  Region region{contour_in_metres(polygon_mm), {}};
  if (const auto fault = polygon_fault(region.polygon)) section.fail("polygon_mm", *fault);
  for (const auto& island : islands_mm) region.islands.push_back(contour_in_metres(island));
  if (const auto fault = islands_fault(region)) section.fail("islands_mm", *fault);
  return region;
}

SpindleLimits read_spindle(TomlSection section) {
  SpindleLimits limits;
  const double min_rpm = section.number("min_rpm", kSpeedRpm);
  const double max_rpm = section.number("max_rpm", kSpeedRpm);
  limits.min_speed = rpm_to_rad_s(min_rpm);
  limits.max_speed = rpm_to_rad_s(max_rpm);
  limits.acceleration = rpm_to_rad_s(section.number("acceleration_rpm_per_s", above(0, 1e9)));
  limits.jerk = rpm_to_rad_s(section.number("jerk_rpm_per_s2", above(0, 1e12)));
  section.finish();
  if (min_rpm >= max_rpm) {
    section.fail("max_rpm",
                 csv_number(max_rpm) + " is out of range; give a number above min_rpm, " + csv_number(min_rpm));
  }
  return limits;
}

}  // namespace stillcut
