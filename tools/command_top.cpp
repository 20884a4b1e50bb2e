// `stillcut top`: what the daemon of a cell hears and does, in the terminal.
#include <csignal>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "drivers/lcm/telemetry_listener.hpp"
#include "rt/periodic.hpp"
#include "tools/cell_json.hpp"
#include "tools/commands.hpp"
#include "tools/lcm_address.hpp"
#include "tools/terminal.hpp"
#include "tools/top_screen.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kRedraw_ns = 100'000'000;
constexpr std::chrono::milliseconds kSnapshotPoll{20};
constexpr std::int64_t kSnapshotWaits_ns = 3'000'000'000;  // health and latency come once a second
constexpr int kSnapshotColumns = 100;

struct TopOptions {
  std::string cell, lcm;
  bool once = false, json = false, ascii = false;
};

// What was heard, for a thread that listens and one that draws.
class HeardCell {
 public:
  explicit HeardCell(const LcmConnection& lcm)
      : listener_{lcm, {.on_message = [this](const TelemetryMessage& message) { take(message); }, .on_bad = {}}} {}

  [[nodiscard]] CellView copy() const {
    const std::lock_guard lock(mutex_);
    return view_;
  }
  [[nodiscard]] std::int64_t unreadable() const { return listener_.bad(); }

 private:
  void take(const TelemetryMessage& message) {
    const std::lock_guard lock(mutex_);
    view_.take(message, monotonic_ns());
  }

  mutable std::mutex mutex_;
  CellView view_;
  TelemetryListener listener_;  // last: its thread starts when all else is there
};

TopScene top_scene(const Cell& cell, const std::string& url) {
  TopScene scene;
  scene.title = std::filesystem::absolute(cell.file).parent_path().filename().string();
  scene.where = url;
  if (!cell.spindle) return scene;
  scene.min_rpm = rad_s_to_rpm(cell.spindle->min_speed);
  scene.max_rpm = rad_s_to_rpm(cell.spindle->max_speed);
  return scene;
}

// Waits for one of everything, or as long as that may take. Without any word of a daemon: ComponentError.
CellView snapshot(const HeardCell& heard, const TopOptions& options, const std::string& url) {
  const std::int64_t until_ns = monotonic_ns() + kSnapshotWaits_ns;
  for (;;) {
    std::this_thread::sleep_for(kSnapshotPoll);
    CellView view = heard.copy();
    const bool all = view.monitor() && view.diagram() && view.health() && view.latency() && view.histogram() &&
                     !view.spectra().empty();
    if (!all && monotonic_ns() < until_ns) continue;
    if (!view.monitor())
      throw ComponentError("no daemon was heard at " + url + " for 3 s; start it: stillcutd " + options.cell +
                           "; is LCM's way open: stillcut doctor " + options.cell);
    return view;
  }
}

nlohmann::ordered_json top_json(const CellView& view, const TopScene& scene) {
  using Json = nlohmann::ordered_json;
  Json spectra = Json::array(), events = Json::array(), corrections = Json::array();
  for (const auto& [sensor, report] : view.spectra()) spectra.push_back(spectrum_json(report, 0));
  for (const Event& event : view.events()) events.push_back(event_json(event, 0));
  for (const Correction& correction : view.corrections()) corrections.push_back(correction_json(correction, 0));
  const HistogramReport* histogram = view.histogram() ? &*view.histogram() : nullptr;
  return {{"title", scene.title},
          {"where", scene.where},
          {"state", state_json(view, view.state(scene.now_ns), view.monitor()->stamp_ns, 0)},
          {"spectra", std::move(spectra)},
          {"lobes", view.diagram() ? lobes_json(*view.diagram(), 0) : Json(nullptr)},
          {"health", view.health() ? health_json(*view.health(), 0) : Json(nullptr)},
          {"latency", view.latency() ? latency_json(*view.latency(), histogram, 0) : Json(nullptr)},
          {"events", std::move(events)},
          {"corrections", std::move(corrections)}};
}

void print_snapshot(const HeardCell& heard, const TopOptions& options, TopScene scene) {
  const CellView view = snapshot(heard, options, scene.where);
  scene.now_ns = monotonic_ns();
  scene.unreadable = heard.unreadable();
  if (options.json) {
    // A controller's words may be any bytes.
    std::cout << top_json(view, scene).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
    return;
  }
  for (const TextLine& line : draw_top(view, scene, kSnapshotColumns, 0).lines) {
    std::string text = text_of(line);
    text.erase(text.find_last_not_of(' ') + 1);
    std::cout << (options.ascii ? ascii(text) : text) << '\n';
  }
}

// False: quit.
bool obey(int key, TopScene& scene) {
  if (key == 'q' || key == 'Q') return false;
  if (key == '?' || key == 'h') scene.help = !scene.help;
  if (key == 'p' || key == ' ') scene.paused = !scene.paused;
  if (key == 's') ++scene.sensor;
  if (key == Terminal::kTabKey) ++scene.page;
  if (key >= '1' && key <= '9') scene.page = key - '1';
  return true;
}

void show(Terminal& terminal, const HeardCell& heard, TopScene scene) {
  CellView view = heard.copy();
  std::int64_t next_ns = monotonic_ns();
  while (terminal.ended_by() == 0) {
    if (!scene.paused) {
      view = heard.copy();
      scene.now_ns = monotonic_ns();
      scene.unreadable = heard.unreadable();
    }
    const Terminal::Size size = terminal.size();
    const TopScreen screen = draw_top(view, scene, size.columns, size.rows);
    scene.page %= screen.pages;
    terminal.draw(screen.lines);
    next_ns = std::max(next_ns + kRedraw_ns, monotonic_ns());
    const auto wait_ms = static_cast<int>(std::max<std::int64_t>(1, (next_ns - monotonic_ns()) / 1'000'000));
    if (!obey(terminal.key(wait_ms), scene)) return;
  }
}

void top(const TopOptions& options) {
  const Cell cell = read_cell(options.cell, {.map = false, .dbc = false, .bus = false});
  const std::string url = options.lcm.empty() ? cell.lcm_url : lcm_address(options.lcm);
  const TopScene scene = top_scene(cell, url);
  if (options.once || options.json || !Terminal::is_there()) {
    const HeardCell heard{open_lcm(url)};
    return print_snapshot(heard, options, scene);
  }
  int ended_by = 0;
  {
    Terminal terminal{options.ascii};  // before the listener's threads: it keeps the signals from them
    const HeardCell heard{open_lcm(url)};
    show(terminal, heard, scene);
    ended_by = terminal.ended_by();
  }
  // The terminal is as it was. Who asked to end sees that this is why; ^C is a way to quit.
  if (ended_by != 0 && ended_by != SIGINT) std::raise(ended_by);
}

}  // namespace

void add_top_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("top", "The daemon of a cell, live in the terminal: state, speeds, lobes, health");
  const auto options = std::make_shared<TopOptions>();
  command->add_option("CELL", options->cell, "Cell file: its LCM address and spindle limits are used")->required();
  command->add_option("--lcm", options->lcm,
                      "Another LCM address than the cell's, such as udpm://239.255.76.67:7667?ttl=1");
  command->add_flag("--once", options->once, "Print what is heard once, as text; so it is where there is no terminal");
  command->add_flag("--json", options->json, "The same as one JSON object on standard output");
  command->add_flag("--ascii", options->ascii, "Draw with ASCII characters only");
  command->footer(
      "Keys: q quit, ? help, p pause, tab the next panels, s the next accelerometer. It only listens.\n"
      "Exit status with --once or --json: 4 where no daemon was heard for 3 s.\n"
      "Example: on the machine that runs the daemon, or over ssh:\n"
      "  stillcut top /etc/stillcut/mill/cell.toml\n"
      "Example: the state alone, for a script:\n"
      "  stillcut top cell.toml --json | jq -r .state.state");
  command->callback([options] { top(*options); });
}

}  // namespace stillcut
