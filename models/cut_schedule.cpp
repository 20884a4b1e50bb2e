#include "models/cut_schedule.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace stillcut {
namespace {

void check_schedule(const Schedule& schedule, const char* what) {
  for (std::size_t i = 0; i < schedule.size(); ++i) {
    if (!std::isfinite(schedule[i].time) || !std::isfinite(schedule[i].value) || schedule[i].value < 0.0)
      throw std::invalid_argument(std::string(what) + ": times and values must be finite numbers, values from 0 up");
    if (i > 0 && schedule[i].time < schedule[i - 1].time)
      throw std::invalid_argument(std::string(what) + ": times must not go back");
  }
}

}  // namespace

MillingSetup scheduled(MillingSetup setup, const CutSchedule& schedule) {
  check_schedule(schedule.axial_depth, "axial depth");
  check_schedule(schedule.spindle_speed, "spindle speed");
  for (const SchedulePoint& point : schedule.axial_depth) setup.deepest = std::max(setup.deepest, point.value);
  setup.deepest = std::max(setup.deepest, setup.cut.axial_depth);
  const Schedule& speed = schedule.spindle_speed;
  const auto by_value = [](const SchedulePoint& a, const SchedulePoint& b) { return a.value < b.value; };
  if (!speed.empty()) {
    const auto [low, high] = std::minmax_element(speed.begin(), speed.end(), by_value);
    setup.slowest = low->value;
    setup.fastest = high->value;
  }
  const MillingConditions start = conditions_at(setup, schedule, 0.0);
  setup.cut.axial_depth = start.axial_depth;
  setup.cut.spindle_speed = start.spindle_speed;
  return setup;
}

MillingConditions conditions_at(const MillingSetup& setup, const CutSchedule& schedule, double time) {
  MillingConditions conditions = milling_conditions(setup.cut);
  if (!schedule.axial_depth.empty()) conditions.axial_depth = value_at(schedule.axial_depth, time);
  if (!schedule.spindle_speed.empty()) conditions.spindle_speed = value_at(schedule.spindle_speed, time);
  return conditions;
}

}  // namespace stillcut
