// The tables of a scenario file (scenario.hpp), each read and turned into SI units. All throw InputError.
#pragma once

#include <string_view>

#include "drivers/files/scenario.hpp"
#include "drivers/files/toml_section.hpp"

namespace stillcut {

// start_s and end_s of a table, in order and inside the scenario.
TimeSpan read_time_span(TomlSection& section, double duration);

// A moment that lies inside the scenario.
double read_moment(TomlSection& section, std::string_view key, double duration);

// What goes wrong: [[knock]], [[outside_force]], [[sensor_fault]], [[lost_frames]], [controller] and its [[fault]]s.
void read_disturbances(TomlSection& root, Scenario& scenario);

}  // namespace stillcut
