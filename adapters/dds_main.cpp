// stillcut-dds: what Stillcut's monitor tells, for ROS 2 and other DDS participants.
#include <spdlog/spdlog.h>

#include <chrono>
#include <iostream>
#include <thread>

#include "adapters/adapter_options.hpp"
#include "adapters/adapter_run.hpp"
#include "adapters/dds_options.hpp"
#include "adapters/udp_port.hpp"
#include "drivers/dds/telemetry_bridge.hpp"
#include "drivers/dds/telemetry_ear.hpp"
#include "drivers/lcm/telemetry_listener.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kServerPatience_ns = 3'000'000'000;

std::int64_t since_1970_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

// Says once each time that the monitor falls silent, and that it is back.
class SilenceWatch {
 public:
  SilenceWatch(std::string lcm_url, std::int64_t now_ns) : lcm_url_{std::move(lcm_url)}, began_ns_{now_ns} {}
  void look(std::int64_t heard_ns, std::int64_t now_ns) {
    const bool silent = now_ns - std::max(heard_ns, began_ns_) > kStaleAfter_ns;
    if (silent && !silent_)
      spdlog::warn(
          "nothing is heard of a monitor on {}: is `stillcutd CELL` running with this cell? `stillcut doctor CELL` "
          "checks LCM's network",
          lcm_url_);
    if (!silent && silent_) spdlog::info("the monitor is heard again");
    silent_ = silent;
  }

 private:
  std::string lcm_url_;
  std::int64_t began_ns_;
  bool silent_ = false;
};

void publish(const DdsOptions& options) {
  set_up_log("stillcut-dds");
  const Cell cell = read_cell(options.cell, {.map = false, .dbc = false, .bus = false});
  const std::string lcm_url = options.lcm.empty() ? cell.lcm_url : options.lcm;
  const EndSignal end{options.duration_s};
  const LcmConnection lcm = open_lcm(lcm_url);
  TelemetryBridge bridge{options.dds, options.name, options.cell};
  const TelemetryListener listener{
      lcm,
      {.on_message = [&bridge](const TelemetryMessage& message) { bridge.hear(message, steady_ns()); },
       .on_bad =
           [said = false](std::string_view channel, const char* why_not) mutable {
             if (!said) spdlog::warn("{} is left out: {}; is the daemon of this version?", channel, why_not);
             said = true;
           }}};
  const std::int64_t began_ns = steady_ns();
  spdlog::info("DDS domain {}, topics rt/{}/..., LCM {}", options.dds.domain, options.name, lcm_url);
  SilenceWatch silence{lcm_url, began_ns};
  int readers = 0;
  bool server_missed = options.dds.discovery_server.empty();
  while (!end.came()) {
    const std::int64_t now_ns = steady_ns();
    bridge.turn(now_ns, since_1970_ns());
    silence.look(bridge.heard_ns(), now_ns);
    if (const int now = bridge.readers(); now != readers) spdlog::info("readers connected: {}", readers = now);
    if (!server_missed && now_ns - began_ns > kServerPatience_ns && bridge.others() == 0) {
      server_missed = true;
      spdlog::warn("the discovery server {} does not answer; start it there: fast-discovery-server -i 0 -p PORT",
                   options.dds.discovery_server);
    }
    std::this_thread::sleep_for(std::chrono::nanoseconds(TelemetryBridge::kTurn_ns));
  }
  spdlog::info("ended: {} messages heard, {} bad; {} samples written, {} not", listener.received(), listener.bad(),
               bridge.written(), bridge.failed());
}

void print(const std::vector<HeardTopic>& topics) {
  for (const HeardTopic& topic : topics)
    std::cout << fmt::format("{:<28} {:>7} messages {:>7.1f}/s {:>5} lost {:>2} writers  {}\n", topic.topic,
                             topic.messages, topic.rate_hz, topic.lost, topic.writers, topic.newest);
  std::cout << std::endl;
}

void listen(const DdsOptions& options) {
  const EndSignal end{options.duration_s};
  const TelemetryEar ear{options.dds, options.name};
  for (std::int64_t print_ns = steady_ns() + 1'000'000'000; !end.came();
       std::this_thread::sleep_for(std::chrono::milliseconds(20))) {
    if (options.duration_s > 0.0 || steady_ns() < print_ns) continue;
    print(ear.heard());
    print_ns += 1'000'000'000;
  }
  print(ear.heard());
  for (const HeardTopic& topic : ear.heard())
    if (topic.messages > 0) return;
  throw ComponentError("nothing was heard: " + ear.advice());
}

}  // namespace
}  // namespace stillcut

int main(int argc, char** argv) {
  using namespace stillcut;
  CLI::App app{"What Stillcut's monitor tells, for ROS 2 and other participants of DDS", "stillcut-dds"};
  DdsOptions options;
  add_dds_options(app, options);
  app.footer(
      "Example:\n  stillcut-dds /etc/stillcut/cell/cell.toml --domain 5\n  stillcut-dds --listen --domain 5\n"
      "See docs/ros2.md.");
  return run_adapter_program(app, argc, argv, [&] {
    if (options.listen == !options.cell.empty()) throw CLI::RequiredError("either CELL or --listen");
    options.listen ? listen(options) : publish(options);
  });
}
