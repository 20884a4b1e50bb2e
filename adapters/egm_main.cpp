// stillcut-egm: Stillcut's corrections for an ABB controller with Externally Guided Motion.
#include "adapters/adapter_options.hpp"
#include "adapters/adapter_run.hpp"
#include "adapters/egm_options.hpp"

int main(int argc, char** argv) {
  using namespace stillcut;
  CLI::App app{"Stillcut's corrections for ABB Externally Guided Motion: answers each packet of the controller (UDP)",
               "stillcut-egm"};
  UdpAdapterOptions options;
  options.program = "stillcut-egm";
  options.listen = "6510";
  EgmAnswer answer = EgmAnswer::data;
  add_adapter_options(app, options.adapter);
  app.add_option("--listen", options.listen, "UDP port, or ADDRESS:PORT, that the controller's UdpUc device names")
      ->check(complain_of_address)
      ->capture_default_str();
  add_egm_options(app, answer, options.adapter.cycle_ms);
  app.add_option("--path-offset", options.adapter.max_path_offset_mm,
                 "with --answer path: how far the path may be moved aside, mm (default: not at all)")
      ->check(CLI::Range(0.0, 10.0));
  app.footer("Example:\n  stillcut-egm cell.toml --listen 192.168.125.99:6510 --answer data\nSee docs/adapters.md.");
  return run_adapter_program(app, argc, argv, [&] {
    AdapterSettings settings = adapter_settings(options.adapter, egm_refusals(answer));
    if (answer == EgmAnswer::path && options.adapter.max_path_offset_mm <= 0.0)
      settings.session.follower.refusals[3] = "the path may not be moved aside; allow it with --path-offset";
    run_udp_adapter(options, settings, egm_protocol(answer));
  });
}
