// stillcut-rsi: Stillcut's corrections for a KUKA controller with RobotSensorInterface.
#include "adapters/adapter_options.hpp"
#include "adapters/adapter_run.hpp"
#include "adapters/rsi_xml.hpp"

int main(int argc, char** argv) {
  using namespace stillcut;
  CLI::App app{"Stillcut's corrections for KUKA RobotSensorInterface: answers each packet of the controller (XML, UDP)",
               "stillcut-rsi"};
  UdpAdapterOptions options;
  options.program = "stillcut-rsi";
  options.listen = "49152";
  add_adapter_options(app, options.adapter);
  app.add_option("--listen", options.listen, "UDP port, or ADDRESS:PORT, that the RSI configuration names")
      ->check(complain_of_address)
      ->capture_default_str();
  app.add_option("--cycle-ms", options.adapter.cycle_ms, "4 (IPO_FAST) or 12")
      ->capture_default_str()
      ->check(CLI::IsMember({4.0, 12.0}));
  app.footer("Example:\n  stillcut-rsi cell.toml --listen 192.168.1.2:49152 --cycle-ms 12\nSee docs/adapters.md.");
  return run_adapter_program(app, argc, argv, [&] {
    AdapterSettings settings = adapter_settings(options.adapter, rsi_refusals());
    settings.session.counter_step = static_cast<std::int64_t>(options.adapter.cycle_ms);  // IPOC counts ms
    run_udp_adapter(options, settings,
                    {parse_rsi, [](const ControllerReport& report, const Setpoint& setpoint, const AnswerHead&) {
                       return build_rsi(report.counter, setpoint);
                     }});
  });
}
