// stillcut-linuxcnc-controller: a simulated LinuxCNC with linuxcncrsh, to try stillcut-linuxcnc with.
#include "adapters/adapter_options.hpp"
#include "adapters/linuxcnc_server.hpp"

int main(int argc, char** argv) {
  using namespace stillcut;
  CLI::App app{"A simulated LinuxCNC with linuxcncrsh, to try stillcut-linuxcnc with", "stillcut-linuxcnc-controller"};
  SimulatedControllerOptions options;
  options.program = "stillcut-linuxcnc-controller";
  std::string listen = "127.0.0.1:5007";
  app.add_option("--listen", listen, "ADDRESS:PORT or PORT")->check(complain_of_address)->capture_default_str();
  app.add_option("--csv", options.csv, "write its overrides to FILE, a row every 50 ms");
  app.add_option("--duration", options.duration_s, "end after this many seconds (default: on SIGTERM)");
  app.add_option("--speed-rpm", options.settings.spindle_speed_rpm, "programmed spindle speed")->capture_default_str();
  app.footer("Example:\n  stillcut-linuxcnc-controller --listen 5007 --speed-rpm 8500 --csv asked.csv");
  return run_adapter_program(app, argc, argv, [&] { run_linuxcnc_controller(options, listen); });
}
