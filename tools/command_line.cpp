#include "tools/output_options.hpp"
#include "tools/plot.hpp"
#include "tools/programs.hpp"
#include "tools/recording_options.hpp"

namespace stillcut {

void add_output_options(CLI::App& command, OutputOptions& options, const char* csv, const char* plot) {
  command.add_option("--csv", options.csv, csv + std::string("; - is standard output"));
  command.add_option("--plot", options.plot, plot + std::string(", to a .svg or .png file"));
  command.add_flag("--json", options.json, "One JSON object on standard output");
}

void check_output_options(const OutputOptions& options) {
  if (options.json && options.csv == "-")
    throw CLI::ValidationError("--json", "cannot share standard output with --csv -");
  if (!options.plot.empty()) plot::check_picture_name(options.plot);
}

void add_recording_options(CLI::App& command, PlaybackSource& source) {
  command
      .add_option("--can", source.can,
                  "CAN log as 'candump -L' writes it, also compressed (.zst), or the folder of a recording")
      ->required();
  command.add_option("--lcm", source.lcm, "LCM log as lcm-logger writes it: robot states, acknowledgements");
  command.add_option("--lcm-offset", source.lcm_offset_s, "seconds to add to the LCM log's times")
      ->capture_default_str();
}

int run_stillcut(int argc, char** argv) {
  CLI::App app{"Stillcut: chatter monitor and compensator for robots that mill", "stillcut"};
  app.require_subcommand(1);
  app.set_version_flag("--version", STILLCUT_VERSION);
  add_coefficients_command(app);
  add_directions_command(app);
  add_patterns_command(app);
  add_doctor_command(app);
  add_echo_command(app);
  add_export_command(app);
  add_fit_command(app);
  add_hil_command(app);
  add_hz_command(app);
  add_lobes_command(app);
  add_map_command(app);
  add_passes_command(app);
  add_plant_command(app);
  add_refine_command(app);
  add_replay_command(app);
  add_report_command(app);
  add_scope_command(app);
  add_simulate_command(app);
  add_stability_command(app);
  add_surface_command(app);
  add_tap_command(app);
  add_top_command(app);
  add_trajectory_command(app);
  add_tune_command(app);
  return run_command_line(app, argc, argv);
}

}  // namespace stillcut
