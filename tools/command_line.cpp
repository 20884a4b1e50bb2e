#include <exception>
#include <iostream>

#include "drivers/files/input_error.hpp"
#include "tools/commands.hpp"
#include "tools/programs.hpp"

namespace stillcut {

int run_command_line(CLI::App& app, int argc, char** argv) {
  const auto complain = [&](const std::exception& error, int code) {
    std::cerr << app.get_name() << ": " << error.what() << '\n';
    return code;
  };
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    std::cerr << app.get_name() << ": " << error.what() << "; see '" << app.get_name() << " --help'\n";
    return kExitUsage;
  } catch (const InputError& error) {
    return complain(error, kExitBadInput);
  } catch (const ComponentError& error) {
    return complain(error, kExitComponentMissing);
  } catch (const std::exception& error) {
    return complain(error, 1);
  }
}

int run_stillcut(int argc, char** argv) {
  CLI::App app{"Stillcut: chatter monitor and compensator for robots that mill", "stillcut"};
  app.require_subcommand(1);
  app.set_version_flag("--version", STILLCUT_VERSION);
  add_hil_command(app);
  add_lobes_command(app);
  add_map_command(app);
  add_plant_command(app);
  add_replay_command(app);
  add_simulate_command(app);
  add_stability_command(app);
  return run_command_line(app, argc, argv);
}

}  // namespace stillcut
