// stillcut-linuxcnc: Stillcut's corrections for LinuxCNC, through linuxcncrsh.
#include "adapters/linuxcnc_run.hpp"

int main(int argc, char** argv) {
  using namespace stillcut;
  CLI::App app{"Stillcut's corrections for LinuxCNC: feed and spindle overrides through linuxcncrsh (TCP)",
               "stillcut-linuxcnc"};
  LinuxCncOptions options;
  options.adapter.cycle_ms = 50.0;
  add_adapter_options(app, options.adapter);
  app.add_option("--server", options.server, "where linuxcncrsh listens, ADDRESS:PORT")
      ->check(complain_of_address)
      ->capture_default_str();
  app.add_option("--connect-password", options.login.connect_password, "of linuxcncrsh")->capture_default_str();
  app.add_option("--enable-password", options.login.enable_password, "of linuxcncrsh")->capture_default_str();
  app.add_option("--cycle-ms", options.adapter.cycle_ms, "how often it is asked, and overrides set")
      ->capture_default_str()
      ->check(CLI::Range(20.0, 200.0));
  app.footer("Example:\n  stillcut-linuxcnc cell.toml --server 192.168.1.20:5007\nSee docs/adapters.md.");
  return run_adapter_program(app, argc, argv, [&] { run_linuxcnc_adapter(options); });
}
