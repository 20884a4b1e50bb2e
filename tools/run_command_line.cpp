#include <exception>
#include <iostream>

#include "drivers/files/input_error.hpp"
#include "tools/commands.hpp"

namespace stillcut {

int run_command_line(CLI::App& app, int argc, char** argv) {
  const auto complain = [&](const std::exception& error, int code) {
    std::cerr << app.get_name() << ": " << error.what() << '\n';
    return code;
  };
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::RuntimeError& error) {  // a command's own verdict, which it has told
    return error.get_exit_code();
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

}  // namespace stillcut
