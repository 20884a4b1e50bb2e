// stillcut-egm-controller: a simulated ABB controller, to try stillcut-egm with.
#include "adapters/adapter_options.hpp"
#include "adapters/egm_controller.hpp"
#include "adapters/egm_options.hpp"

int main(int argc, char** argv) {
  using namespace stillcut;
  CLI::App app{"A simulated ABB controller with Externally Guided Motion, to try stillcut-egm with",
               "stillcut-egm-controller"};
  SimulatedControllerOptions options;
  options.program = "stillcut-egm-controller";
  options.adapter = "127.0.0.1:6510";
  EgmAnswer answer = EgmAnswer::data;
  add_controller_options(app, options);
  add_egm_options(app, answer, options.cycle_ms);
  app.footer("Example:\n  stillcut-egm-controller --adapter 127.0.0.1:6510 --speed-rpm 8500 --csv asked.csv");
  return run_adapter_program(app, argc, argv, [&] {
    SimulatedController controller{egm_controller_protocol(answer), options.settings, 1e-3 * options.cycle_ms, 1};
    run_simulated_controller(options, controller);
  });
}
