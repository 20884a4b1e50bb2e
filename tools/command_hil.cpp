// `stillcut hil`: the daemon and a simulated machine in closed loop, in one command, scored against what the simulation
// knows of itself. `stillcut plant`: the machine alone, for a daemon in another process.
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "drivers/files/cell.hpp"
#include "drivers/files/scenario.hpp"
#include "drivers/lcm/monitor_listener.hpp"
#include "tools/closed_loop.hpp"
#include "tools/commands.hpp"
#include "tools/compare_runs.hpp"
#include "tools/event_csv.hpp"
#include "tools/hil_score.hpp"
#include "tools/live_loop.hpp"
#include "tools/live_run.hpp"
#include "tools/output_file.hpp"
#include "tools/plant.hpp"
#include "tools/plot_hil.hpp"
#include "tools/progress.hpp"
#include "tools/roughness_json.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kHilOrigin = 1'700'000'000'000'000'000;  // ns: data time carries a date, always the same
constexpr std::int64_t kUntilStart_ns = 300'000'000;            // real time: for the threads to come up
constexpr std::chrono::milliseconds kLastWords{200};            // for what is still on its way at the end

struct HilOptions {
  std::string cell, scenario, plot, events, record;
  bool shadow = false, json = false, data_time = false, live = false, compare = false, audit = false;
};

struct HilRun {
  std::unique_ptr<VirtualMachine> machine;
  Heard heard;
  std::optional<TickTimes> ticks;    // of the monitor's loop, where it ran here in real time
  std::optional<PlantReport> plant;  // in real time
};

template <class T>
nlohmann::ordered_json or_null(const std::optional<T>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json score_json(const HilScore& score, const VirtualMachine& machine,
                                  const std::optional<TickTimes>& ticks, const std::optional<PlantReport>& plant) {
  const bool chatter = !score.spells.empty();
  using Json = nlohmann::ordered_json;
  return {{"detected", or_null(score.detected)},
          {"detection_ms", or_null(score.detection_ms)},
          {"suppressed", or_null(score.suppressed)},
          {"suppression_ms", or_null(score.suppression_ms)},
          {"false_alarms", score.false_alarms},
          {"corrections", score.corrections},
          {"peak_displacement_um", score.peak_displacement_um},
          {"ra_um", um_json(score.roughness, &ProfileRoughness::ra)},
          {"tick_p50_us", ticks ? Json(ticks->p50_us) : Json(nullptr)},
          {"tick_p9999_us", ticks ? Json(ticks->p9999_us) : Json(nullptr)},
          {"tick_max_us", ticks ? Json(ticks->max_us) : Json(nullptr)},
          {"chatter_spells", score.spells.size()},
          {"chatter_s", score.chatter_s},
          {"chatter_start_s", chatter ? Json(score.spells.front().start) : Json(nullptr)},
          {"chatter_frequency_hz", chatter ? Json(score.spells.front().frequency_hz) : Json(nullptr)},
          {"corrections_refused", machine.controller().refused()},
          {"removed_mm3_per_min", or_null(score.removed_mm3_per_min)},
          {"surface", machine.surface().name()},
          {"rq_um", um_json(score.roughness, &ProfileRoughness::rq)},
          {"rt_um", um_json(score.roughness, &ProfileRoughness::rt)},
          {"stopped", score.stopped},
          {"frames_sent", machine.frames_sent()},
          {"frames_lost", machine.frames_lost()},
          {"behind_ms", plant ? Json(std::max(0.0, plant->behind_ms)) : Json(nullptr)}};
}

void print_verdict(const Scenario& scenario, const VirtualMachine& machine, const HilScore& score, bool shadow) {
  std::printf("%s\n", scenario.title.c_str());
  for (const ChatterSpell& spell : score.spells)
    std::printf("  chatter from %.2f to %.2f s at %.1f Hz, up to %.0f µm%s\n", spell.start, spell.end,
                spell.frequency_hz, 1e6 * spell.peak, spell.died_down ? "" : ", until the end");
  if (score.spells.empty()) std::printf("  no chatter\n");
  if (score.detected && *score.detected) std::printf("  heard after %.0f ms\n", *score.detection_ms);
  if (score.detected && !*score.detected) std::printf("  not heard\n");
  if (score.suppressed) std::printf("  %s", *score.suppressed ? "ended in the cut" : "not ended in the cut");
  if (score.suppression_ms) std::printf(", %.0f ms after the alarm", *score.suppression_ms);
  if (score.suppressed) std::printf("\n");
  std::printf("  %d false alarms, %d corrections%s\n", score.false_alarms, score.corrections,
              shadow ? " (shadow: shown, not followed)" : "");
  std::printf("  peak displacement %.0f µm", score.peak_displacement_um);
  if (score.roughness) std::printf(", %s Ra %.2f µm", machine.surface().name(), 1e6 * score.roughness->ra);
  if (score.removed_mm3_per_min) std::printf(", %.0f mm³ a minute", *score.removed_mm3_per_min);
  if (score.stopped) std::printf(", stopped on request");
  std::printf("\n");
}

// A log cannot be sent to.
void check_can_send(const Cell& cell) {
  const CanSettings& can = require(cell, cell.can, "can");
  if (can.bus.starts_with("log:"))
    throw InputError(cell.file.string(), can.line,
                     "can.bus: nothing can be sent to a log; give local:NAME or socketcan:IFACE");
}

void say_late(const PlantReport& plant) {
  constexpr double kTolerable_ms = 20.0;  // the monitor bears it
  if (plant.behind_ms > kTolerable_ms)
    std::cerr << "stillcut: this machine is too busy: the simulated one was up to " << std::lround(plant.behind_ms)
              << " ms behind the clock; close other programs, or use hil --data-time\n";
  if (plant.unsent > 0) std::cerr << "stillcut: the CAN bus did not take " << plant.unsent << " frames\n";
}

// Daemon and machine in this process, in real time. They meet on a bus and an LCM network of their own, so that nothing
// else is needed and nothing real moves, unless the user wants those of the cell.
HilRun run_live(const Cell& cell, const Scenario& scenario, const HilOptions& wanted,
                const std::function<void(double)>& progress) {
  const std::string own_bus = "local:stillcut-hil-" + std::to_string(getpid());
  const std::string bus_name = wanted.live ? cell.can->bus : own_bus;
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("stillcut", std::make_shared<spdlog::sinks::stderr_sink_mt>()));
  spdlog::set_level(spdlog::level::err);
  const LcmConnection lcm = open_lcm(wanted.live ? cell.lcm_url : "memq://");
  const std::unique_ptr<CanBus> bus = open_can_bus(bus_name);
  MonitorInbox inbox;
  const MonitorListener listener{lcm,
                                 {.on_correction = [&](const Correction& c) { inbox.add(Output{c}); }, .on_event = {}},
                                 MonitorListener::Thread::none};
  LiveRunOptions options;
  options.allow_not_real_time = true;  // the machine is a simulated one
  options.record = wanted.record;
  options.cell_records = wanted.live;
  options.audit = wanted.audit;
  options.on_output = [&](const Output& output) {  // corrections come over LCM, as to a real controller
    if (output.type != Output::Type::correction) inbox.add(output);
  };
  LiveRun run{cell, bus_name, lcm, options};
  auto machine = std::make_unique<VirtualMachine>(cell, scenario, realtime_ns() + kUntilStart_ns);
  const PlantReport plant = run_in_real_time(*machine, *bus, lcm, inbox, progress);
  std::this_thread::sleep_for(kLastWords);
  run.stop();
  Heard heard = inbox.take_heard(machine->origin_ns());
  return {std::move(machine), std::move(heard), run.tick_times(), plant};
}

HilRun run_without_clock(const Cell& cell, const Scenario& scenario, const std::function<void(double)>& progress) {
  HilRun run;
  run.machine = std::make_unique<VirtualMachine>(cell, scenario, kHilOrigin);
  run.heard = run_in_data_time(cell, *run.machine, progress);
  return run;
}

void check_outputs(const HilOptions& options) {
  if (options.json && options.events == "-")
    throw CLI::ValidationError("--events", "'-' and --json both want standard output; name a file for the events");
  if (!options.plot.empty()) plot::check_picture_name(options.plot);
}

void report(const HilOptions& options, const Cell& cell, const Scenario& scenario, const HilRun& run) {
  const VirtualMachine& machine = *run.machine;
  if (run.plant) say_late(*run.plant);
  const HilScore score = score_run(machine, run.heard.events);
  if (!options.plot.empty())
    plot::write_figure(hil_figure(scenario.title, cell, machine, run.heard, score), options.plot);
  if (!options.events.empty()) {
    OutputFile file{options.events};
    write_event_header(file.stream());
    for (const Event& event : run.heard.events) write_event(file.stream(), event, machine.origin_ns());
    file.finish();
  }
  if (options.json) std::cout << score_json(score, machine, run.ticks, run.plant).dump() << '\n';
  if (options.json || options.events == "-") return;
  print_verdict(scenario, machine, score, options.shadow);
  if (run.ticks)
    std::printf("  tick %.0f µs (median), %.0f µs (99.99 %%), %.0f µs (longest)\n", run.ticks->p50_us,
                run.ticks->p9999_us, run.ticks->max_us);
}

// The same cut as it chatters, corrected, and at a sound depth.
void compare(const HilOptions& options, const Cell& cell, const Scenario& scenario) {
  Progress progress{"running"};
  const std::vector<ComparedRun> runs =
      compare_runs(cell, scenario, kHilOrigin, [&](double share) { progress.update(share); });
  progress.finish();
  if (!options.plot.empty()) plot::write_figure(comparison_figure(scenario.title, cell, runs), options.plot);
  if (!options.json) {
    std::printf("%s\n", scenario.title.c_str());
    print_comparison(runs);
    return;
  }
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const ComparedRun& run : runs) {
    nlohmann::ordered_json one{{"name", run.name}};
    one.update(score_json(run.score, *run.machine, {}, {}));
    one["ra_at_end_um"] = std::isfinite(run.ra_at_end) ? nlohmann::ordered_json(1e6 * run.ra_at_end) : nullptr;
    all.push_back(std::move(one));
  }
  std::cout << nlohmann::ordered_json{{"runs", all}}.dump() << '\n';
}

void hil(const HilOptions& options) {
  if (options.compare && (options.live || options.shadow || !options.events.empty()))
    throw CLI::ValidationError("--compare", "runs several times in data time; leave --live, --shadow, --events out");
  if (options.data_time && options.live)
    throw CLI::ValidationError("--live", "--data-time has neither bus nor LCM; leave one of the two out");
  if (!options.record.empty() && (options.data_time || options.compare))
    throw CLI::ValidationError("--record", "records a run in real time; leave --data-time and --compare out");
  if (options.audit && (options.data_time || options.compare))
    throw CLI::ValidationError("--audit",
                               "watches the loop of a run in real time; leave --data-time and --compare out");
  check_outputs(options);
  Cell cell = read_cell(options.cell, {.bus = options.live});
  if (options.live) check_can_send(cell);
  cell.measures = false;
  cell.mode = options.shadow ? RuntimeMode::shadow : RuntimeMode::active;
  const Scenario scenario = read_scenario(options.scenario, cell);
  if (options.compare) return compare(options, cell, scenario);
  Progress progress{"running"};
  const auto show = [&](double share) { progress.update(share); };
  const HilRun run =
      options.data_time ? run_without_clock(cell, scenario, show) : run_live(cell, scenario, options, show);
  progress.finish();
  report(options, cell, scenario, run);
}

void run_plant(const HilOptions& options) {
  check_outputs(options);
  const Cell cell = read_cell(options.cell);
  check_can_send(cell);
  const Scenario scenario = read_scenario(options.scenario, cell);
  const LcmConnection lcm = open_lcm(cell.lcm_url);
  const std::unique_ptr<CanBus> bus = open_can_bus(require(cell, cell.can, "can").bus);
  MonitorInbox inbox;
  const MonitorListener listener{lcm,
                                 {.on_correction = [&](const Correction& c) { inbox.add(Output{c}); },
                                  .on_event = [&](const Event& e) { inbox.add(Output{e}); }},
                                 MonitorListener::Thread::own};
  auto machine = std::make_unique<VirtualMachine>(cell, scenario, realtime_ns() + kUntilStart_ns);
  Progress progress{"milling"};
  const PlantReport plant = run_in_real_time(*machine, *bus, lcm, inbox, [&](double share) { progress.update(share); });
  std::this_thread::sleep_for(kLastWords);
  progress.finish();
  Heard heard = inbox.take_heard(machine->origin_ns());
  report(options, cell, scenario, {std::move(machine), std::move(heard), {}, plant});
}

void add_common_options(CLI::App* command, HilOptions& options) {
  command->add_option("CELL", options.cell, "cell file")->required();
  command->add_option("--scenario", options.scenario, "what is cut and what goes wrong (TOML)")->required();
  command->add_option("--plot", options.plot, "draw the run to a .svg or .png file");
  command->add_option("--events", options.events, "write what the monitor told as CSV");
  command->add_flag("--json", options.json, "print one JSON object");
}

}  // namespace

void add_hil_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("hil", "Run the daemon and a simulated machine in closed loop and score the run");
  auto options = std::make_shared<HilOptions>();
  add_common_options(command, *options);
  command->add_flag("--shadow", options->shadow, "corrections are shown and not followed");
  command->add_flag("--data-time", options->data_time, "as fast as it goes, without clock and threads: repeatable");
  command->add_flag("--compare", options->compare,
                    "the cut not corrected, corrected, and at a depth that is sound as programmed (data time)");
  command->add_option("--record", options->record, "record as stillcutd does, FILE.log or a folder (not in data time)");
  command->add_flag("--audit", options->audit,
                    "abort (status 134) at the loop's first system call but receive, sleep and clock");
  command->add_flag("--live", options->live,
                    "on the bus and the LCM network that the cell names (default: on private ones)");
  command->footer(
      "Example:\n  stillcut hil examples/robot-cell/cell.toml --scenario examples/scenarios/depth-step.toml\n"
      "  stillcut hil examples/demo-cell/cell.toml --scenario examples/scenarios/depth-step.toml --compare --plot "
      "c.svg");
  command->callback([options] { hil(*options); });
}

void add_plant_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "plant", "Simulate the machine in real time, on the CAN bus and the LCM network that the cell names");
  auto options = std::make_shared<HilOptions>();
  add_common_options(command, *options);
  command->footer(
      "Example, with the daemon in another terminal on the same local: bus:\n"
      "  stillcut plant examples/robot-cell/cell.toml --scenario examples/scenarios/robot-mode.toml");
  command->callback([options] { run_plant(*options); });
}

}  // namespace stillcut
