// stillcut-rsi-controller: a simulated KUKA controller, to try stillcut-rsi with.
#include "adapters/adapter_options.hpp"
#include "adapters/rsi_controller.hpp"

int main(int argc, char** argv) {
  using namespace stillcut;
  CLI::App app{"A simulated KUKA controller with RobotSensorInterface, to try stillcut-rsi with",
               "stillcut-rsi-controller"};
  SimulatedControllerOptions options;
  options.program = "stillcut-rsi-controller";
  options.adapter = "127.0.0.1:49152";
  add_controller_options(app, options);
  app.add_option("--cycle-ms", options.cycle_ms, "4 (IPO_FAST) or 12")
      ->capture_default_str()
      ->check(CLI::IsMember({4.0, 12.0}));
  app.footer("Example:\n  stillcut-rsi-controller --adapter 127.0.0.1:49152 --speed-rpm 8500 --csv asked.csv");
  return run_adapter_program(app, argc, argv, [&] {
    SimulatedController controller{rsi_controller_protocol(), options.settings, 1e-3 * options.cycle_ms,
                                   static_cast<std::int64_t>(options.cycle_ms)};
    run_simulated_controller(options, controller);
  });
}
