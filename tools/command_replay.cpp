// `stillcut replay`: plays a CAN log through the daemon's own code, as fast as it goes, and writes down what was
// decided.
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
#include "tools/playback.hpp"
#include "tools/plot_replay.hpp"
#include "tools/recorded_frames.hpp"
#include "tools/recording_options.hpp"
#include "tools/replay_trace.hpp"

namespace stillcut {
namespace {

struct ReplayOptions {
  PlaybackSource source;
  std::string cell, events, plot, publish;
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
  refuse_to_overwrite(playback_files(options.source.can, options.source.lcm), {options.events, options.plot});
  std::optional<Publisher> publisher;
  if (!options.publish.empty()) publisher.emplace(open_lcm(options.publish));

  std::ofstream events_file;
  const bool events_to_stdout = options.events == "-";
  if (!options.events.empty() && !events_to_stdout) events_file = open_for_writing(options.events);
  std::ostream& events = events_to_stdout ? std::cout : events_file;
  if (!options.events.empty()) write_event_header(events);
  const bool tell = !options.json && !events_to_stdout;

  std::optional<TraceCollector> trace;
  if (!options.plot.empty()) trace.emplace(cell);
  EventTally tally;
  PlaybackListener listener;
  if (trace) listener.on_frame = [&](const Pipeline& pipeline) { trace->add(pipeline); };
  listener.on_output = [&](const Output& output, const Core& core) {
    if (publisher) publisher->publish(output);
    if (output.type != Output::Type::event) return;
    tally.count(output.event);
    if (!options.events.empty()) write_event(events, output.event, core.origin_ns());
    if (tell) std::cout << event_line(output.event, core.origin_ns()) << std::endl;
    if (trace) trace->add(output.event, core.origin_ns());
  };
  const PlaybackSummary played = play(cell, options.source, true, kInfinity, listener);

  if (!options.events.empty() && !events.flush()) {
    throw InputError(options.events, 0, "cannot be written to its end; is the disk full?");
  }
  for (const std::string& warning : played.warnings) std::cerr << "stillcut: " << warning << '\n';
  if (trace) plot_replay(trace->finish(), options.plot);
  if (options.json) {
    nlohmann::ordered_json summary = {{"signal_s", played.played_s},
                                      {"wall_s", played.wall_s},
                                      {"frames", played.frames},
                                      {"frames_lost", played.frames_lost},
                                      {"frames_bad", played.frames_bad},
                                      {"frames_out_of_order", played.frames_out_of_order},
                                      {"chatter_onsets", tally.chatter_onsets},
                                      {"corrections", tally.corrections},
                                      {"faults", tally.faults}};
    summary["start_utime"] = played.origin_ns / 1000;
    if (played.is_recording) {
      summary["recorded_outputs"] = played.outputs_recorded;
      summary["replayed_outputs"] = played.outputs_decided;
      summary["same_outputs"] = played.outputs_same;
    }
    std::cout << summary.dump() << '\n';
  } else if (tell) {
    std::cout << played.played_s << " s of signal in " << played.wall_s << " s ("
              << std::llround(played.played_s / played.wall_s) << " x real time), " << played.frames << " frames, "
              << played.frames_lost << " lost, " << played.frames_bad << " bad; " << tally.chatter_onsets
              << " chatter onsets, " << tally.corrections << " corrections\n";
  }
}

}  // namespace

void add_replay_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("replay", "Play a CAN log through the daemon's own code and list what it decides");
  auto options = std::make_shared<ReplayOptions>();
  command->add_option("CELL", options->cell, "cell file")->required();
  add_recording_options(*command, options->source);
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
