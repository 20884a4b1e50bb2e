// `stillcut report`: what happened in a shift or a cut, as one page for people.
#include <iostream>
#include <nlohmann/json.hpp>

#include "drivers/files/cell.hpp"
#include "tools/commands.hpp"
#include "tools/output_file.hpp"
#include "tools/playback.hpp"
#include "tools/recorded_frames.hpp"
#include "tools/recording_options.hpp"
#include "tools/report_collector.hpp"
#include "tools/report_page.hpp"
#include "tools/report_words.hpp"

namespace stillcut {
namespace {

struct ReportOptions {
  std::string cell, out;
  PlaybackSource source;
  int pictures = 6;
  bool json = false;
};

void write_report(const ReportOptions& options) {
  if (options.out.empty() && !options.json) throw CLI::RequiredError("--out or --json");
  if (options.out == "-" && options.json)
    throw CLI::ValidationError("--out", "'-' and --json both want standard output; name a file for the page");
  const Cell cell = read_cell(options.cell, {.bus = false});
  refuse_to_overwrite(playback_files(options.source.can, options.source.lcm), {options.out});
  ReportCollector collector{cell, options.out.empty() ? 0 : options.pictures};
  std::optional<OutputFile> page;
  if (!options.out.empty()) page.emplace(options.out);
  const PlaybackSummary played = play(cell, options.source, true, kInfinity, collector.listener());
  for (const std::string& warning : played.warnings) std::cerr << "stillcut: " << warning << '\n';
  Report report = collector.finish(played);
  report.recording = options.source.can;
  if (page) {
    write_report_page(report, page->stream());
    page->finish();
  }
  if (options.json)
    std::cout << report_json(report).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
  else if (options.out != "-")
    std::cout << verdict_of(report).text << '\n';
}

}  // namespace

void add_report_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("report", "What happened in a recording, as one page for people");
  auto options = std::make_shared<ReportOptions>();
  command->add_option("CELL", options->cell, "cell file")->required();
  add_recording_options(*command, options->source);
  command->add_option("--out", options->out, "write the page: HTML, all in one file ('-': standard output)");
  command->add_option("--pictures", options->pictures, "episodes of chatter to picture, the worst")
      ->check(CLI::Range(0, 100))
      ->capture_default_str();
  command->add_flag("--json", options->json, "print the figures as one JSON object");
  command->footer("Example:\n  stillcut report cell.toml --can /var/lib/stillcut/recording --out report.html");
  command->callback([options] { write_report(*options); });
}

}  // namespace stillcut
