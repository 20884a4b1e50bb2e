// The daemon's command line; what it does is in daemon.cpp. Linked without the commands, whose pictures would bring a
// window system's libraries into locked memory.
#include "tools/commands.hpp"
#include "tools/daemon.hpp"

int main(int argc, char** argv) {
  using namespace stillcut;
  CLI::App app{"Stillcut daemon: hears the cut over CAN, detects chatter, publishes corrections over LCM", "stillcutd"};
  app.set_version_flag("--version", STILLCUT_VERSION);
  DaemonOptions options;
  app.add_option("CELL", options.cell, "cell file")->required();
  app.add_option(
      "--record", options.record,
      "FILE.log: write every frame that was used, as 'candump -L' would; a folder: record all that goes in and comes "
      "out, compressed, for 'stillcut replay CELL --can FOLDER' (SIGUSR1 marks what is to be kept)");
  app.add_option("--events", options.events, "write the events to FILE as CSV");
  app.add_option("--duration", options.duration_s, "end after this many seconds (default: on SIGTERM)");
  app.add_option("--priority", options.priority, "SCHED_FIFO priority of the loop")
      ->capture_default_str()
      ->check(CLI::Range(1, 99));
  app.add_option("--cpu", options.cpu, "processor of the loop (default: any)");
  app.add_flag("--json", options.json, "at the end print one JSON object");
  app.add_flag("--allow-not-real-time", options.allow_not_real_time,
               "on the bench: run active mode though this host cannot keep time, and release nothing when it does not");
  app.add_flag("!--no-telemetry", options.telemetry,
               "publish only corrections, events, status and latency: nothing more for scope, top and stillcut-dds");
  app.add_flag("--audit", options.audit,
               "abort (status 134) at the loop's first system call but receive, sleep and clock");
  app.footer(
      "Example:\n  stillcutd /etc/stillcut/cell.toml --record cut.log --events events.csv\n"
      "  stillcutd /etc/stillcut/cell.toml --record /var/lib/stillcut/recording");
  app.callback([&] { run_daemon(options); });
  return run_command_line(app, argc, argv);
}
