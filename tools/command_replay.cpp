// `stillcut replay`: plays a CAN log through the daemon's own code, as fast as it goes, and writes down what was
// decided.
#include <algorithm>
#include <chrono>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "drivers/files/cell.hpp"
#include "drivers/lcm/connection.hpp"
#include "drivers/lcm/publisher.hpp"
#include "tools/commands.hpp"
#include "tools/event_csv.hpp"
#include "tools/event_tally.hpp"
#include "tools/output_comparison.hpp"
#include "tools/pipeline.hpp"
#include "tools/plot_replay.hpp"
#include "tools/predictor.hpp"
#include "tools/progress.hpp"
#include "tools/recorded_frames.hpp"
#include "tools/replay_trace.hpp"
#include "tools/robot_playback.hpp"

namespace stillcut {
namespace {

struct ReplayOptions {
  std::string cell, can, lcm, events, plot, publish;
  double lcm_offset_s = 0.0;
  bool json = false;
};

std::ofstream open_for_writing(const std::string& file) {
  std::ofstream out{file, std::ios::binary};
  if (!out) throw InputError(file, 0, "cannot be written; check the folder and its rights");
  return out;
}

void replay(const ReplayOptions& options) {
  if (options.json && options.events == "-") {
    throw CLI::ValidationError("--events", "'-' and --json both want standard output; name a file for the events");
  }
  const Cell cell = read_cell(options.cell, {.bus = false});
  Pipeline pipeline{cell};
  Core& core = pipeline.core();
  Predictor predictor{cell};
  const PlaybackFiles files = playback_files(options.can, options.lcm);
  refuse_to_overwrite(files, {options.events, options.plot});
  if (!files.note.empty()) std::cerr << "stillcut: " << files.note << '\n';
  RecordedFrames log{files.can};
  RobotPlayback robot{files.lcm, options.lcm_offset_s, predictor};
  std::optional<Publisher> publisher;
  if (!options.publish.empty()) publisher.emplace(open_lcm(options.publish));
  const NominalPrediction prediction = predictor.nominal();
  if (!prediction.warning.empty()) std::cerr << "stillcut: " << prediction.warning << '\n';
  if (!cell.measures) core.add_lobes(prediction.diagram);  // as the daemon

  std::ofstream events_file;
  const bool events_to_stdout = options.events == "-";
  if (!options.events.empty() && !events_to_stdout) events_file = open_for_writing(options.events);
  std::ostream& events = events_to_stdout ? std::cout : events_file;
  if (!options.events.empty()) write_event_header(events);
  const bool tell = !options.json && !events_to_stdout;

  std::optional<TraceCollector> trace;
  if (!options.plot.empty()) trace.emplace(cell);
  EventTally tally;
  OutputComparison comparison;
  const auto take_outputs = [&] {
    for (const Output& output : core.outputs()) {
      if (publisher) publisher->publish(output);
      comparison.add(output, robot);
      if (output.type != Output::Type::event) continue;
      tally.count(output.event);
      if (!options.events.empty()) write_event(events, output.event, core.origin_ns());
      if (tell) std::cout << event_line(output.event, core.origin_ns()) << std::endl;
      if (trace) trace->add(output.event, core.origin_ns());
    }
    core.clear_outputs();
  };
  Progress progress{"replaying"};
  constexpr double kBytesAFrame = 150.0;  // about; for the bar only
  std::int64_t last_ns = 0;
  const auto started = std::chrono::steady_clock::now();
  CanFrame frame;
  while (log.next(frame)) {
    if (frame.stamp_ns >= last_ns) robot.feed_until(last_ns = frame.stamp_ns, core, take_outputs);
    const bool heard = pipeline.feed(frame);
    if (trace && heard) trace->add(pipeline);
    take_outputs();
    if ((log.frames() & 0x3FF) == 0) progress.update(static_cast<double>(log.frames()) * kBytesAFrame / log.bytes());
  }
  robot.finish(core, take_outputs);
  take_outputs();
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  const double signal_s = static_cast<double>(last_ns - core.origin_ns()) * 1e-9;

  if (!options.events.empty() && !events.flush()) {
    throw InputError(options.events, 0, "cannot be written to its end; is the disk full?");
  }
  if (const std::string warning = log.warning(); !warning.empty()) std::cerr << "stillcut: " << warning << '\n';
  if (robot.bad() > 0)
    std::cerr << "stillcut: " << files.lcm.front().string() << ": " << robot.bad() << " bad messages passed over\n";
  for (const std::string& warning : comparison.warnings(robot, files.from_the_start))
    std::cerr << "stillcut: " << warning << '\n';
  if (trace) plot_replay(trace->finish(), options.plot);
  const std::int64_t bad = log.frames_bad() + pipeline.decoder().counters().frames_bad;
  if (options.json) {
    nlohmann::ordered_json summary = {{"signal_s", signal_s},
                                      {"wall_s", wall_s},
                                      {"frames", log.frames()},
                                      {"frames_lost", core.counters().frames_lost},
                                      {"frames_bad", bad},
                                      {"frames_out_of_order", core.counters().frames_out_of_order},
                                      {"chatter_onsets", tally.chatter_onsets},
                                      {"corrections", tally.corrections},
                                      {"faults", tally.faults}};
    summary["start_utime"] = core.origin_ns() / 1000;
    if (robot.is_recording()) {
      summary["recorded_outputs"] = robot.published().size();
      summary["replayed_outputs"] = comparison.count();
      summary["same_outputs"] = comparison.same_as(robot.published());
    }
    std::cout << summary.dump() << '\n';
  } else if (tell) {
    std::cout << signal_s << " s of signal in " << wall_s << " s (" << std::llround(signal_s / wall_s)
              << " x real time), " << log.frames() << " frames, " << core.counters().frames_lost << " lost, " << bad
              << " bad; " << tally.chatter_onsets << " chatter onsets, " << tally.corrections << " corrections\n";
  }
}

}  // namespace

void add_replay_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("replay", "Play a CAN log through the daemon's own code and list what it decides");
  auto options = std::make_shared<ReplayOptions>();
  command->add_option("CELL", options->cell, "cell file")->required();
  command
      ->add_option("--can", options->can,
                   "CAN log as 'candump -L' writes it, also compressed (.zst), or the folder of a recording")
      ->required();
  command->add_option("--lcm", options->lcm, "LCM log as lcm-logger writes it: robot states and acknowledgements");
  command->add_option("--lcm-offset", options->lcm_offset_s, "seconds to add to the LCM log's times")
      ->capture_default_str();
  command->add_option("--events", options->events, "write the events as CSV ('-': standard output)");
  command->add_option("--plot", options->plot, "draw vibration, spectrogram, indicator and speed (.svg or .png)");
  command->add_option("--publish", options->publish, "publish on LCM as the daemon would, e.g. memq:// or udpm://...");
  command->add_flag("--json", options->json, "print one JSON object");
  command->footer(
      "Example:\n  stillcut replay cell.toml --can cut.log --events events.csv --plot cut.png\n"
      "  stillcut replay cell.toml --can /var/lib/stillcut/recording --events events.csv");
  command->callback([options] { replay(*options); });
}

}  // namespace stillcut
