#include "adapters/simulated_controller.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "adapters/adapter_options.hpp"
#include "adapters/adapter_run.hpp"
#include "adapters/udp_port.hpp"
#include "drivers/files/input_error.hpp"
#include "models/machining.hpp"

namespace stillcut {
namespace {

// A posture that a six-axis robot could have; the simulated machine does not reckon with joints.
constexpr std::array<double, 6> kSomePosture_deg{0.0, -90.0, 90.0, 0.0, 45.0, 0.0};

void write_row(std::ofstream& csv, const SimulatedController& controller) {
  const MachineInputs& in = controller.inputs();
  std::array<char, 160> row{};
  std::snprintf(row.data(), row.size(), "%.4f,%.2f,%.2f,%.4f,%.4f,%d,%lld\n", controller.time_s(),
                controller.program().spindle_speed_rpm(), in.spindle_change_rpm, in.feed_override, 1e3 * in.path_offset,
                controller.program().stopped() ? 1 : 0, static_cast<long long>(controller.late()));
  csv << row.data() << std::flush;
}

}  // namespace

std::string SimulatedController::cycle() {
  if (!answered_) {
    ++sent_.late_answers;
    inputs_ = {};
  }
  program_.step(cycle_s_, inputs_);
  ++cycles_;
  answered_ = false;
  sent_.counter = cycles_ * counter_step_;
  sent_.clock_us = static_cast<std::int64_t>(time_s() * 1e6);
  sent_.position = program_.position();
  for (std::size_t i = 0; i < kSomePosture_deg.size(); ++i) sent_.joints[i] = deg_to_rad(kSomePosture_deg[i]);
  sent_.spindle_speed_rpm = program_.settings().spindle_speed_rpm;
  sent_.block = program_.block();
  return protocol_.report(sent_);
}

void SimulatedController::answer(std::string_view answer) {
  const auto inputs = protocol_.read(answer, sent_);
  if (!inputs) return;
  inputs_ = *inputs;
  answered_ = true;
}

void add_controller_options(CLI::App& app, SimulatedControllerOptions& options) {
  app.add_option("--adapter", options.adapter, "where the adapter listens, ADDRESS:PORT")
      ->check(complain_of_address)
      ->capture_default_str();
  app.add_option("--csv", options.csv, "write what it was asked for to FILE, a row a cycle");
  app.add_option("--duration", options.duration_s, "end after this many seconds (default: on SIGTERM)");
  app.add_option("--speed-rpm", options.settings.spindle_speed_rpm, "programmed spindle speed")->capture_default_str();
  app.add_option_function<double>(
         "--feed-mm-per-s", [&](double feed) { options.settings.feed_m_per_s = 1e-3 * feed; }, "programmed feed")
      ->default_str("25");
}

std::ofstream open_controller_csv(const std::string& file) {
  std::ofstream csv;
  if (file.empty()) return csv;
  csv.open(file, std::ios::binary);
  if (!csv) throw InputError(file, 0, "cannot be written; check the folder and its rights");
  csv << "time_s,spindle_speed_rpm,spindle_change_rpm,feed_override,path_offset_mm,stopped,late\n" << std::flush;
  return csv;
}

void run_simulated_controller(const SimulatedControllerOptions& options, SimulatedController& controller) {
  set_up_log(options.program);
  const EndSignal end{options.duration_s};
  std::ofstream csv = open_controller_csv(options.csv);
  UdpPort port{ipv4_address("0.0.0.0:0")};
  const sockaddr_in adapter = ipv4_address(options.adapter);
  const auto cycle_ns = static_cast<std::int64_t>(options.cycle_ms * 1e6);
  std::int64_t next = steady_ns();
  spdlog::info("{} mills at {:.0f} rpm and talks to {}", options.program, options.settings.spindle_speed_rpm,
               options.adapter);
  while (!end.came()) {
    port.send(adapter, controller.cycle());
    next += cycle_ns;
    for (std::int64_t left = cycle_ns; left > 0; left = next - steady_ns()) {
      const auto packet = port.receive(static_cast<int>(std::max<std::int64_t>(left / 1'000'000, 1)));
      if (!packet.bytes.empty())
        controller.answer({reinterpret_cast<const char*>(packet.bytes.data()), packet.bytes.size()});
    }
    if (csv.is_open()) write_row(csv, controller);
  }
  spdlog::info("ended: {:.1f} s, cycles without an answer {}", controller.time_s(), controller.late());
}

}  // namespace stillcut
