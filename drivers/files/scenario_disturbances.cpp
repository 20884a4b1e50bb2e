#include <algorithm>

#include "drivers/files/csv.hpp"
#include "drivers/files/scenario_sections.hpp"

namespace stillcut {
namespace {

constexpr double kMs = 1e-3;

// Three numbers, x, y and z in workpiece axes.
std::array<double, 3> read_vector(TomlSection& section, std::string_view key) {
  const std::vector<double> numbers = section.numbers(key, from(-1e6, 1e6));
  std::array<double, 3> vector{};
  if (numbers.size() != vector.size()) section.fail(key, "is not three numbers; give [x, y, z] in workpiece axes");
  std::copy(numbers.begin(), numbers.end(), vector.begin());
  return vector;
}

void read_knocks(TomlSection& root, Scenario& scenario) {
  for (TomlSection section : root.tables("knock")) {
    Knock knock;
    knock.time = read_moment(section, "time_s", scenario.duration);
    knock.impulse = read_vector(section, "impulse_n_s");
    section.finish();
    scenario.knocks.push_back(knock);
  }
}

void read_outside_forces(TomlSection& root, Scenario& scenario) {
  for (TomlSection section : root.tables("outside_force")) {
    OutsideForce force;
    force.span = read_time_span(section, scenario.duration);
    force.frequency_hz = section.number("frequency_hz", above(0, 1e4));
    force.force = read_vector(section, "force_n");
    section.finish();
    scenario.forces.push_back(force);
  }
}

bool same_axis(const SensorFault& a, const SensorFault& b) { return a.axis < 0 || b.axis < 0 || a.axis == b.axis; }

void read_sensor_faults(TomlSection& root, Scenario& scenario) {
  using Kind = SensorFaultKind;
  for (TomlSection section : root.tables("sensor_fault")) {
    SensorFault fault;
    fault.line = section.line();
    fault.span = read_time_span(section, scenario.duration);
    fault.kind = section.choice<Kind>("kind", {{"stuck", Kind::stuck},
                                               {"saturated", Kind::saturated},
                                               {"offset", Kind::offset},
                                               {"nan", Kind::nan},
                                               {"dead", Kind::dead},
                                               {"silent", Kind::silent}});
    fault.axis = section.choice<int>("axis", {{"all", -1}, {"x", 0}, {"y", 1}, {"z", 2}}, -1);
    fault.offset = section.number("offset_m_per_s2", from(-1e5, 1e5), 0.0);
    section.finish();
    if (section.has("offset_m_per_s2") != (fault.kind == Kind::offset))
      section.fail("offset_m_per_s2", fault.kind == Kind::offset ? "is missing; say what the sensor adds"
                                                                 : "belongs to kind = \"offset\" only; remove it");
    if (fault.kind == Kind::silent && fault.axis >= 0)
      section.fail("axis", "of a silent sensor all are silent; remove it, or use kind = \"dead\"");
    for (const SensorFault& other : scenario.sensor_faults)
      if (same_axis(fault, other) && fault.span.start < other.span.end && other.span.start < fault.span.end)
        section.fail("start_s", "the axis already has a fault from " + csv_number(other.span.start) + " to " +
                                    csv_number(other.span.end) + " s; one at a time");
    scenario.sensor_faults.push_back(fault);
  }
}

void read_losses(TomlSection& root, Scenario& scenario) {
  for (TomlSection section : root.tables("lost_frames")) {
    FrameLoss loss;
    loss.span = read_time_span(section, scenario.duration);
    loss.rate = section.number("rate", above(0, 1));
    section.finish();
    scenario.losses.push_back(loss);
  }
}

// The kinds of correction that the controller can do; a release belongs to each.
void read_accepts(TomlSection& section, ControllerScript& script) {
  using Kind = CorrectionKind;
  const std::vector<std::pair<std::string, Kind>> kinds{{"spindle_speed", Kind::spindle_speed},
                                                        {"speed_variation", Kind::speed_variation},
                                                        {"feed_direction", Kind::feed_direction},
                                                        {"feed_override", Kind::feed_override},
                                                        {"stop", Kind::stop_request}};
  std::vector<std::string> known;
  known.reserve(kinds.size());
  for (const auto& [name, kind] : kinds) known.push_back(name);
  const std::vector<std::string> given = section.names("accepts", known);
  if (!section.has("accepts")) return;
  script.accepts.clear();
  for (const auto& [name, kind] : kinds)
    if (std::find(given.begin(), given.end(), name) != given.end()) script.accepts.push_back(kind);
}

void read_controller(TomlSection section, Scenario& scenario) {
  using Kind = ControllerFaultKind;
  ControllerScript& script = scenario.controller;
  script.cycle = kMs * section.number("cycle_ms", from(4, 12), script.cycle / kMs);
  script.lag = kMs * section.number("lag_ms", from(10, 20), script.lag / kMs);
  script.spindle_time_constant =
      section.number("spindle_time_constant_s", from(0.2, 0.5), script.spindle_time_constant);
  script.spindle_acceleration = rpm_to_rad_s(section.number("spindle_acceleration_rpm_per_s", above(0, 1e6), 1.0));
  if (!section.has("spindle_acceleration_rpm_per_s")) script.spindle_acceleration = 0.0;
  script.turn_rate = deg_to_rad(section.number("turn_rate_deg_per_s", above(0, 3600), rad_to_deg(script.turn_rate)));
  read_accepts(section, script);
  for (TomlSection entry : section.tables("fault")) {
    ControllerFault fault;
    fault.span = read_time_span(entry, scenario.duration);
    fault.kind =
        entry.choice<Kind>("kind", {{"silent", Kind::silent}, {"refuses", Kind::refuses}, {"mute", Kind::mute}});
    entry.finish();
    if (!script.faults.empty() && fault.span.start < script.faults.back().span.end)
      entry.fail("start_s", "lies in the fault before; put them in order, one at a time");
    script.faults.push_back(fault);
  }
  section.finish();
}

}  // namespace

double read_moment(TomlSection& section, std::string_view key, double duration) {
  const double time = section.number(key, from(0));
  if (time > duration)
    section.fail(key,
                 csv_number(time) + " s lies after the end; give a time up to duration_s, " + csv_number(duration));
  return time;
}

TimeSpan read_time_span(TomlSection& section, double duration) {
  const double start = read_moment(section, "start_s", duration);
  const double end = section.has("end_s") ? read_moment(section, "end_s", duration) : duration;
  if (!section.has("end_s")) (void)section.number("end_s", from(0), duration);
  if (section.has("start_s") && end <= start)
    section.fail("end_s", csv_number(end) + " s is not after start_s, " + csv_number(start) + " s");
  return {start, end};
}

void read_disturbances(TomlSection& root, Scenario& scenario) {
  read_knocks(root, scenario);
  read_outside_forces(root, scenario);
  read_sensor_faults(root, scenario);
  read_losses(root, scenario);
  if (auto section = root.table("controller")) read_controller(*section, scenario);
}

}  // namespace stillcut
