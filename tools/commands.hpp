// The commands of `stillcut`: each add_*_command (in command_NAME.cpp) adds one subcommand to the application. A
// command throws InputError for bad input (exit 3) and ComponentError for a missing component (exit 4);
// run_command_line (run_command_line.cpp) turns them into the one line and the exit code that contracts promise.
#pragma once

#include <CLI/CLI.hpp>

namespace stillcut {

void add_coefficients_command(CLI::App& app);
void add_directions_command(CLI::App& app);
void add_patterns_command(CLI::App& app);
void add_doctor_command(CLI::App& app);
void add_echo_command(CLI::App& app);
void add_export_command(CLI::App& app);
void add_fit_command(CLI::App& app);
void add_hil_command(CLI::App& app);
void add_hz_command(CLI::App& app);
void add_lobes_command(CLI::App& app);
void add_map_command(CLI::App& app);
void add_passes_command(CLI::App& app);
void add_plant_command(CLI::App& app);
void add_refine_command(CLI::App& app);
void add_replay_command(CLI::App& app);
void add_report_command(CLI::App& app);
void add_scope_command(CLI::App& app);
void add_simulate_command(CLI::App& app);
void add_stability_command(CLI::App& app);
void add_surface_command(CLI::App& app);
void add_tap_command(CLI::App& app);
void add_top_command(CLI::App& app);
void add_trajectory_command(CLI::App& app);
void add_tune_command(CLI::App& app);

inline constexpr int kExitUsage = 2, kExitBadInput = 3, kExitComponentMissing = 4;

// Parses the command line and runs what it asks for; prints errors as "PROGRAM: ..." and returns the exit code.
int run_command_line(CLI::App& app, int argc, char** argv);

}  // namespace stillcut
