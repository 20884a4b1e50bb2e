#include "drivers/files/scenario.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/files/csv.hpp"
#include "drivers/files/dynamics_map_file.hpp"
#include "drivers/files/scenario_sections.hpp"
#include "drivers/files/toml_file.hpp"
#include "models/posture.hpp"

namespace stillcut {
namespace {

constexpr double kMilliOf = 1e-3;            // mm -> m
constexpr double kLongestScenario = 3600.0;  // s
constexpr double kSpeedTolerance = 1e-9;     // relative: rpm and rad/s are the same number but for the last bits

void check_times(const TomlSection& section, std::string_view key, const Schedule& schedule, double duration) {
  for (std::size_t i = 0; i < schedule.size(); ++i) {
    const double time = schedule[i].time;
    if (time > duration)
      section.fail(key,
                   csv_number(time) + " s lies after the end; give times up to duration_s, " + csv_number(duration));
    if (i > 0 && time < schedule[i - 1].time)
      section.fail(key, "goes back in time, from " + csv_number(schedule[i - 1].time) + " to " + csv_number(time) +
                            " s; put the points in order");
    if (i > 1 && time == schedule[i - 2].time)
      section.fail(key, "has more than two values at " + csv_number(time) + " s; a step has one before and one after");
  }
}

// [[time_s, value], ...]: straight lines between, two points at one time make a step.
Schedule read_schedule(TomlSection& section, std::string_view key, Bounds bounds, double unit, double duration) {
  Schedule schedule;
  for (const auto& [time, value] : section.pairs(key, from(0), bounds)) schedule.push_back({time, value * unit});
  check_times(section, key, schedule, duration);
  return schedule;
}

void check_speeds(const TomlSection& section, const Schedule& schedule, const Cell& cell) {
  const SpindleLimits& spindle = require(cell, cell.spindle, "spindle");
  for (const SchedulePoint& point : schedule) {
    if (point.value >= spindle.min_speed * (1.0 - kSpeedTolerance) &&
        point.value <= spindle.max_speed * (1.0 + kSpeedTolerance))
      continue;
    section.fail("spindle_speed_rpm", csv_number(std::round(rad_s_to_rpm(point.value))) +
                                          " is outside the spindle; give speeds from " +
                                          csv_number(std::round(rad_s_to_rpm(spindle.min_speed))) + " to " +
                                          csv_number(std::round(rad_s_to_rpm(spindle.max_speed))));
  }
}

void check_radial_depth(const TomlSection& section, const Schedule& schedule, const Cell& cell) {
  const Tool& tool = require(cell, cell.tool, "tool");
  for (const SchedulePoint& point : schedule)
    if (point.value > tool.diameter)
      section.fail("radial_depth_mm",
                   csv_number(point.value / kMilliOf) + " is out of range; give numbers up to the tool's diameter");
}

void check_posture(const TomlSection& section, std::string_view key, const std::string& id, const Cell& cell) {
  const DynamicsMap map = read_dynamics_map(require(cell, cell.dynamics, "dynamics").map);
  try {
    (void)find_posture(map, id);
  } catch (const std::invalid_argument& error) {
    section.fail(key, error.what());
  }
}

void read_program(TomlSection section, const Cell& cell, Scenario& scenario) {
  const double duration = scenario.duration;
  const Milling milling = section.choice<Milling>(
      "milling", {{"down", Milling::down}, {"up", Milling::up}, {"slot", Milling::slot}}, Milling::unknown);
  if (milling != Milling::unknown) scenario.milling = milling;
  scenario.axial_depth = read_schedule(section, "axial_depth_mm", from(0, 1e3), kMilliOf, duration);
  scenario.radial_depth = read_schedule(section, "radial_depth_mm", above(0, 1e3), kMilliOf, duration);
  scenario.spindle_speed = read_schedule(section, "spindle_speed_rpm", above(0, 1e6), rpm_to_rad_s(1.0), duration);
  scenario.feed_direction = read_schedule(section, "feed_direction_deg", from(-360, 360), deg_to_rad(1.0), duration);
  scenario.posture = section.text("posture", "");
  section.finish();
  check_radial_depth(section, scenario.radial_depth, cell);
  check_speeds(section, scenario.spindle_speed, cell);
  if (!scenario.posture.empty()) check_posture(section, "posture", scenario.posture, cell);
}

void read_moves(TomlSection& root, const Cell& cell, Scenario& scenario) {
  for (TomlSection section : root.tables("posture_move")) {
    PostureMove move;
    move.span = read_time_span(section, scenario.duration);
    move.to = section.text("to");
    section.finish();
    check_posture(section, "to", move.to, cell);
    if (!scenario.moves.empty() && move.span.start < scenario.moves.back().span.end)
      section.fail("start_s", csv_number(move.span.start) + " s lies in the move before, which ends at " +
                                  csv_number(scenario.moves.back().span.end) + " s; one move at a time, in order");
    scenario.moves.push_back(move);
  }
}

void read_interruptions(TomlSection& root, Scenario& scenario) {
  for (TomlSection section : root.tables("interrupted")) {
    InterruptedCut cut;
    cut.span = read_time_span(section, scenario.duration);
    cut.in_cut = section.number("in_cut_s", above(0));
    cut.in_air = section.number("in_air_s", above(0));
    section.finish();
    if (!scenario.interrupted.empty() && cut.span.start < scenario.interrupted.back().span.end)
      section.fail("start_s", "lies in the interruption before; put them in order, one at a time");
    scenario.interrupted.push_back(cut);
  }
}

Scenario read_for(const std::filesystem::path& file, const Cell* given) {
  const toml::table table = read_toml_file(file);
  TomlSection root(file.string(), "", 0, table);
  Scenario scenario;
  scenario.file = file;
  const std::string named = root.text("cell");
  scenario.cell = (std::filesystem::absolute(file).parent_path() / named).lexically_normal();
  scenario.title = root.text("title", file.stem().string());
  scenario.duration = root.number("duration_s", above(0, kLongestScenario));
  scenario.seed = static_cast<std::uint64_t>(root.number("seed", from(0, 1e9), 1.0));
  scenario.sensor_noise = root.number("sensor_noise_m_per_s2", from(0, 1e4), scenario.sensor_noise);
  scenario.force_noise = root.number("force_noise", from(0, 0.5), scenario.force_noise);
  constexpr int kNotSaid = -1;
  const int chatter = root.choice<int>("chatter", {{"none", 0}, {"expected", 1}}, kNotSaid);
  if (chatter != kNotSaid) scenario.chatter = chatter == 1;
  std::error_code error;
  if (named.empty()) root.fail("cell", "is missing; name the cell file, cell = \"cell.toml\"");
  if (!std::filesystem::is_regular_file(scenario.cell, error))
    root.fail("cell", "no file " + scenario.cell.string() + "; correct the path, which starts at this file's folder");
  if (!root.has("duration_s")) root.fail("duration_s", "is missing; say how long the scenario lasts");
  std::optional<Cell> own;
  if (given == nullptr) own = read_cell(scenario.cell, {.bus = false});
  const Cell& cell = given != nullptr ? *given : *own;

  if (auto section = root.table("program")) read_program(*section, cell, scenario);
  read_moves(root, cell, scenario);
  read_interruptions(root, scenario);
  read_disturbances(root, scenario);
  root.finish();
  return scenario;
}

}  // namespace

Scenario read_scenario(const std::filesystem::path& file, const Cell& cell) { return read_for(file, &cell); }
Scenario read_scenario(const std::filesystem::path& file) { return read_for(file, nullptr); }

}  // namespace stillcut
