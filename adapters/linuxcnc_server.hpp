// A simulated LinuxCNC: the part of linuxcncrsh that the adapter uses, with the simulated machine behind it. The class
// has neither socket nor clock; run_linuxcnc_controller puts both around it.
#pragma once

#include <string>
#include <string_view>

#include "adapters/simulated_controller.hpp"

namespace stillcut {

class LinuxCncServer {
 public:
  explicit LinuxCncServer(const SimulatedProgramSettings& settings) : program_{settings} {}

  void step(double seconds);
  // The reply to a line of a client, its end included; may be empty, or be several lines.
  std::string line(std::string_view text);
  void disconnected() { linked_ = enabled_ = verbose_ = false; }

  // What an operator does.
  void set_feed_override(int percent) { feed_percent_ = percent; }
  void set_spindle_override(int percent) { spindle_percent_ = percent; }
  void resume() { program_.start_again(); }
  void switch_machine(bool on) { machine_on_ = on; }

  [[nodiscard]] const SimulatedProgram& program() const { return program_; }
  [[nodiscard]] int feed_percent() const { return feed_percent_; }
  [[nodiscard]] int spindle_percent() const { return spindle_percent_; }

 private:
  [[nodiscard]] MachineInputs inputs(bool stop) const;
  std::string set(std::string_view name, std::string_view value);
  [[nodiscard]] std::string get(std::string_view name) const;

  SimulatedProgram program_;
  int feed_percent_ = 100, spindle_percent_ = 100;
  bool linked_ = false, enabled_ = false, verbose_ = false, machine_on_ = true;
};

// Serves one client after the other at `listen`, until a signal or the end of the duration.
void run_linuxcnc_controller(const SimulatedControllerOptions& options, const std::string& listen);

}  // namespace stillcut
