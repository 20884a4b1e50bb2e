// A controller that sends a packet each cycle and takes what is answered within it, with the simulated machine behind
// it. Where no answer comes in time it falls back to its program and counts. Without sockets and clock: the programs
// stillcut-rsi-controller and stillcut-egm-controller put both around it, the tests use it as it is.
#pragma once

#include <CLI/CLI.hpp>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "adapters/controller_report.hpp"
#include "adapters/simulated_program.hpp"

namespace stillcut {

struct ControllerProtocol {
  std::function<std::string(const ControllerReport&)> report;
  // Nothing: that is no answer to the report.
  std::function<std::optional<MachineInputs>(std::string_view answer, const ControllerReport& sent)> read;
};

class SimulatedController {
 public:
  SimulatedController(ControllerProtocol protocol, const SimulatedProgramSettings& program, double cycle_s,
                      std::int64_t counter_step)
      : protocol_{std::move(protocol)}, program_{program}, cycle_s_{cycle_s}, counter_step_{counter_step} {}

  std::string cycle();                   // the packet of the next cycle
  void answer(std::string_view answer);  // something came within it

  [[nodiscard]] const SimulatedProgram& program() const { return program_; }
  [[nodiscard]] const MachineInputs& inputs() const { return inputs_; }
  [[nodiscard]] std::int64_t late() const { return sent_.late_answers; }
  [[nodiscard]] double time_s() const { return static_cast<double>(cycles_) * cycle_s_; }

 private:
  ControllerProtocol protocol_;
  SimulatedProgram program_;
  double cycle_s_;
  std::int64_t counter_step_, cycles_ = 0;
  ControllerReport sent_;
  MachineInputs inputs_;
  bool answered_ = true;
};

struct SimulatedControllerOptions {
  std::string program;
  std::string adapter;  // ADDRESS:PORT
  std::string csv;      // file for a row each cycle; empty: none
  double cycle_ms = 4.0, duration_s = 0.0;
  SimulatedProgramSettings settings;
};

void add_controller_options(CLI::App& app, SimulatedControllerOptions& options);
// The file of --csv with its header, closed when there is no name. Throws InputError.
std::ofstream open_controller_csv(const std::string& file);
void run_simulated_controller(const SimulatedControllerOptions& options, SimulatedController& controller);

}  // namespace stillcut
