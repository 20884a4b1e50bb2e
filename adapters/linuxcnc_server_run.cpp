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

}  // namespace

void run_linuxcnc_controller(const SimulatedControllerOptions& options, const std::string& listen) {
  set_up_log(options.program);
  const EndSignal end{options.duration_s};
  std::ofstream csv = open_controller_csv(options.csv);
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

}  // namespace stillcut
