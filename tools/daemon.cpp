#include "tools/daemon.hpp"

#include <signal.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "drivers/files/cell.hpp"
#include "rt/periodic.hpp"
#include "rt/snapshot.hpp"
#include "tools/live_run.hpp"
#include "tools/service_notify.hpp"

namespace stillcut {
namespace {

// Sleeps until a signal, the end of the loop, or the wanted duration; tells the service manager how the loop gets on.
// SIGUSR1 marks the recording.
void wait_for_the_end(const sigset_t& signals, LiveRun& run, Snapshot<Status>& newest, ServiceNotify& service,
                      double duration_s) {
  const auto started = std::chrono::steady_clock::now();
  while (!run.ended()) {
    newest.update();
    service.progress(run.ticks(), newest.value(), monotonic_ns());
    const timespec tenth{0, 100'000'000};
    const int signal = sigtimedwait(&signals, nullptr, &tenth);
    if (signal == SIGUSR1) {
      spdlog::info("SIGUSR1 received: the recording is marked");
      run.mark("operator");
    } else if (signal > 0) {
      spdlog::info("{} received", signal == SIGTERM ? "SIGTERM" : "SIGINT");
      return;
    }
    const std::chrono::duration<double> ran = std::chrono::steady_clock::now() - started;
    if (duration_s > 0.0 && ran.count() >= duration_s) return;
  }
}

}  // namespace

void run_daemon(const DaemonOptions& options) {
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("stillcutd", std::make_shared<spdlog::sinks::stderr_sink_mt>()));
  spdlog::set_pattern("%H:%M:%S.%e %l %v");
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGUSR1);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // before any thread: all inherit it, only this one waits for them

  const Cell cell = read_cell(options.cell);
  ServiceNotify service;
  Snapshot<Status> newest{Status{.mode = cell.mode}};
  LiveRun run{cell,
              require(cell, cell.can, "can").bus,
              open_lcm(cell.lcm_url),
              {.record = options.record,
               .cell_records = true,
               .events = options.events,
               .priority = options.priority,
               .cpu = options.cpu,
               .audit = options.audit,
               .allow_not_real_time = options.allow_not_real_time,
               .telemetry = options.telemetry,
               .on_output = [&newest](const Output& output) {
                 if (output.type == Output::Type::status) newest.publish(output.status);
               }}};
  wait_for_the_end(signals, run, newest, service, options.duration_s);
  service.stopping();
  run.stop();

  const nlohmann::ordered_json summary = run.summary();
  if (options.json) {
    std::cout << summary.dump() << std::endl;
  } else {
    spdlog::info("ended: {}", summary.dump());
  }
}

}  // namespace stillcut
