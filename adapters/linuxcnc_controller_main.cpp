// stillcut-linuxcnc-controller: a simulated LinuxCNC with linuxcncrsh, to try stillcut-linuxcnc with.
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <fstream>
#include <memory>

#include "adapters/adapter_options.hpp"
#include "adapters/adapter_run.hpp"
#include "adapters/linuxcnc_server.hpp"
#include "adapters/simulated_controller.hpp"
#include "adapters/tcp_lines.hpp"
#include "adapters/udp_port.hpp"

namespace stillcut {
namespace {

constexpr int kServeEvery_ms = 1;
constexpr std::int64_t kRowEvery_ns = 50'000'000;

void write_override_row(std::ofstream& csv, const LinuxCncServer& server, double time_s) {
  const double change = server.program().settings().spindle_speed_rpm * (0.01 * server.spindle_percent() - 1.0);
  std::array<char, 160> row{};
  std::snprintf(row.data(), row.size(), "%.4f,%.2f,%.2f,%.4f,0.0000,%d,0\n", time_s,
                server.program().spindle_speed_rpm(), change, 0.01 * server.feed_percent(),
                server.program().stopped() ? 1 : 0);
  csv << row.data() << std::flush;
}

void run_linuxcnc_controller(const SimulatedControllerOptions& options, const std::string& listen) {
  set_up_log(options.program);
  const EndSignal end{options.duration_s};
  std::ofstream csv;
  if (!options.csv.empty()) {
    csv.open(options.csv, std::ios::binary);
    if (!csv) throw InputError(options.csv, 0, "cannot be written; check the folder and its rights");
    csv << kControllerCsvHeader << std::flush;
  }
  const int listening = tcp_listen(ipv4_address(listen));
  LinuxCncServer server{options.settings};
  std::unique_ptr<TcpLines> client;
  spdlog::info("{} mills at {:.0f} rpm and listens on TCP {}", options.program, options.settings.spindle_speed_rpm,
               listen);
  const std::int64_t started = steady_ns();
  std::int64_t before = started, next_row = started;
  while (!end.came()) {
    if (!client) {
      if (const int accepted = tcp_accept(listening, kServeEvery_ms); accepted >= 0)
        client = std::make_unique<TcpLines>(accepted);
    } else if (const auto line = client->next(kServeEvery_ms)) {
      client->send(server.line(*line));
    } else if (client->gone()) {
      client.reset();
      server.disconnected();
    }
    const std::int64_t now = steady_ns();
    server.step(static_cast<double>(now - before) * 1e-9);
    before = now;
    if (csv.is_open() && now >= next_row) {
      next_row = now + kRowEvery_ns;
      write_override_row(csv, server, static_cast<double>(now - started) * 1e-9);
    }
  }
  close(listening);
  spdlog::info("ended: feed {} %, spindle {} %", server.feed_percent(), server.spindle_percent());
}

}  // namespace
}  // namespace stillcut

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
