// `stillcut scope`: the live page of a cell, a recording or a simulated cut, in a browser.
#include <csignal>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "drivers/files/cell.hpp"
#include "drivers/lcm/telemetry_listener.hpp"
#include "tools/commands.hpp"
#include "tools/scope_feed.hpp"
#include "tools/scope_server.hpp"
#include "tools/scope_timeline.hpp"

namespace stillcut {
namespace {

struct ScopeCommand {
  std::string cell, scenario, lcm_url, token_file;
  PlaybackSource recording;
  ScopeOptions server;
  bool json = false;
};

// Beside the program, or where a package puts it.
std::filesystem::path page_folder() {
  const std::filesystem::path programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const std::filesystem::path built = programs / "page", installed = programs.parent_path() / "share/stillcut/page";
  return std::filesystem::exists(built / "index.html") ? built : installed;
}

std::string first_line(const std::string& file) {
  std::ifstream in{file};
  std::string line;
  std::getline(in, line);
  line.erase(line.find_last_not_of(" \t\r") + 1);
  if (line.empty()) throw InputError(file, 0, "no token in it; make one: openssl rand -hex 16 > " + file);
  return line;
}

void check_scope_options(const ScopeCommand& wanted) {
  if (!wanted.recording.can.empty() && !wanted.scenario.empty())
    throw CLI::ValidationError("--scenario", "--can shows a recording, --scenario a simulation; leave one out");
  if (!wanted.recording.lcm.empty() && wanted.recording.can.empty())
    throw CLI::ValidationError("--lcm", "belongs to a recording (--can); the daemon's network is --lcm-url");
  if (wanted.server.certificate.empty() != wanted.server.key.empty())
    throw CLI::ValidationError("--certificate", "--certificate and --key belong together");
  if (is_loopback(wanted.server.address)) return;
  if (wanted.token_file.empty() || wanted.server.certificate.empty())
    throw CLI::ValidationError(
        "--address", wanted.server.address +
                         " can be reached from other hosts, so --token-file, --certificate and --key are needed. Make "
                         "them: openssl rand -hex 16 > token; openssl req -x509 -newkey rsa:2048 -nodes -days 365 "
                         "-subj /CN=stillcut -keyout key.pem -out cert.pem");
}

FeedTitle title_of(const Cell& cell, std::string source, std::string where) {
  FeedTitle title{std::filesystem::absolute(cell.file).parent_path().filename().string(), std::move(source),
                  std::move(where), cell.tool ? cell.tool->teeth : 0};
  if (cell.spindle) {
    title.min_rpm = rad_s_to_rpm(cell.spindle->min_speed);
    title.max_rpm = rad_s_to_rpm(cell.spindle->max_speed);
  }
  return title;
}

void tell_url(const ScopeCommand& wanted, const ScopeServer& server) {
  if (wanted.json) {
    std::cout << nlohmann::ordered_json{{"url", server.url()}, {"port", server.port()}}.dump() << std::endl;
  } else {
    std::cout << server.url() << (wanted.token_file.empty() ? "" : "?token=TOKEN") << "   (^C ends it)" << std::endl;
  }
}

// Until a signal ends it; `tick` ten times a second.
void serve(const ScopeCommand& wanted, Feed& feed, const sigset_t& ends, const std::function<void()>& tick) {
  const ScopeServer server{feed, wanted.server};
  tell_url(wanted, server);
  const timespec tenth{0, 100'000'000};
  while (sigtimedwait(&ends, nullptr, &tenth) < 0) {
    if (!server.serves()) throw ComponentError("can no longer listen on " + server.url() + "; start it again");
    tick();
  }
}

void serve_live(const ScopeCommand& wanted, const Cell& cell, const sigset_t& ends) {
  const std::string url = wanted.lcm_url.empty() ? cell.lcm_url : wanted.lcm_url;
  LiveFeed feed{title_of(cell, "daemon", url)};
  const TelemetryListener listener{open_lcm(url),
                                   {.on_message = [&](const TelemetryMessage& m) { feed.take(m); }, .on_bad = {}}};
  serve(wanted, feed, ends, [&] { feed.tick(); });
}

void scope(ScopeCommand wanted) {
  check_scope_options(wanted);
  if (!wanted.token_file.empty()) wanted.server.token = first_line(wanted.token_file);
  wanted.server.page = page_folder();
  sigset_t ends;
  sigemptyset(&ends);
  sigaddset(&ends, SIGTERM);
  sigaddset(&ends, SIGINT);
  Cell cell = read_cell(wanted.cell, {.map = !wanted.recording.can.empty() || !wanted.scenario.empty(), .bus = false});
  std::unique_ptr<TimelineFeed> timeline;
  if (!wanted.recording.can.empty()) {
    std::vector<std::string> warnings;
    timeline =
        timeline_of_recording(cell, wanted.recording, title_of(cell, "recording", wanted.recording.can), warnings);
    for (const std::string& warning : warnings) std::cerr << "stillcut: " << warning << '\n';
  } else if (!wanted.scenario.empty()) {
    cell.measures = false;
    cell.mode = RuntimeMode::active;
    timeline = timeline_of_scenario(cell, wanted.scenario, title_of(cell, "simulation", wanted.scenario));
  }
  pthread_sigmask(SIG_BLOCK, &ends, nullptr);  // before the server's threads: only this one waits for them
  if (timeline) return serve(wanted, *timeline, ends, [] {});
  serve_live(wanted, cell, ends);
}

}  // namespace

void add_scope_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("scope", "Show a cell live in the browser, or a recording, or a simulated cut");
  auto options = std::make_shared<ScopeCommand>();
  command->add_option("CELL", options->cell, "cell file")->required();
  command->add_option("--can", options->recording.can,
                      "show a recording instead: a CAN log (.log, .log.zst) or a recording's folder");
  command->add_option("--lcm", options->recording.lcm, "LCM log beside the CAN log");
  command->add_option("--lcm-offset", options->recording.lcm_offset_s, "seconds to add to the LCM log's times");
  command->add_option("--scenario", options->scenario, "show a simulated cut instead (TOML, docs/scenarios.md)");
  command->add_option("--lcm-url", options->lcm_url, "LCM network of the daemon (default: the cell's)");
  command->add_option("--port", options->server.port, "port to listen on; 0: any free one")
      ->capture_default_str()
      ->check(CLI::Range(0, 65535));
  command
      ->add_option("--address", options->server.address,
                   "address to listen on; one that other hosts reach asks for token and TLS")
      ->capture_default_str();
  command->add_option("--token-file", options->token_file, "file with the token that viewers must show");
  command->add_option("--certificate", options->server.certificate, "TLS certificate, PEM");
  command->add_option("--key", options->server.key, "its private key, PEM");
  command->add_flag("--json", options->json, "print the page's address as one JSON object");
  command->footer(
      "The page only shows; Prometheus reads /metrics.\nExample:\n"
      "  stillcut scope /etc/stillcut/cell.toml\n"
      "  stillcut scope cell.toml --can /var/lib/stillcut/recording\n"
      "  stillcut scope examples/demo-cell/cell.toml --scenario examples/scenarios/depth-step.toml");
  command->callback([options] { scope(*options); });
}

}  // namespace stillcut
