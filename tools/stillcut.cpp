// The command line: `stillcut COMMAND ...`. One file a command, see commands.hpp.
#include "tools/commands.hpp"

int main(int argc, char** argv) {
  CLI::App app{"Stillcut: chatter monitor and compensator for robots that mill", "stillcut"};
  app.require_subcommand(1);
  app.set_version_flag("--version", STILLCUT_VERSION);
  stillcut::add_lobes_command(app);
  stillcut::add_replay_command(app);
  stillcut::add_simulate_command(app);
  stillcut::add_stability_command(app);
  return stillcut::run_command_line(app, argc, argv);
}
