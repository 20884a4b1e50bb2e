// `stillcut hil`: the daemon and a simulated machine in closed loop, in one command, scored against what the simulation
// knows of itself.
#include <iostream>
#include <nlohmann/json.hpp>

#include "drivers/files/cell.hpp"
#include "drivers/files/scenario.hpp"
#include "tools/closed_loop.hpp"
#include "tools/commands.hpp"
#include "tools/hil_score.hpp"
#include "tools/plot_hil.hpp"
#include "tools/progress.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kHilOrigin = 1'700'000'000'000'000'000;  // ns: data time carries a date, always the same

struct HilOptions {
  std::string cell, scenario, plot;
  bool shadow = false, json = false, data_time = false;
};

template <class T>
nlohmann::ordered_json or_null(const std::optional<T>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json score_json(const HilScore& score, const VirtualMachine& machine) {
  const bool chatter = !score.spells.empty();
  using Json = nlohmann::ordered_json;
  return {{"detected", or_null(score.detected)},
          {"detection_ms", or_null(score.detection_ms)},
          {"suppressed", or_null(score.suppressed)},
          {"suppression_ms", or_null(score.suppression_ms)},
          {"false_alarms", score.false_alarms},
          {"corrections", score.corrections},
          {"peak_displacement_um", score.peak_displacement_um},
          {"ra_um", or_null(score.ra_um)},
          {"tick_p50_us", nullptr},
          {"tick_p9999_us", nullptr},
          {"tick_max_us", nullptr},
          {"chatter_spells", score.spells.size()},
          {"chatter_start_s", chatter ? Json(score.spells.front().start) : Json(nullptr)},
          {"chatter_frequency_hz", chatter ? Json(score.spells.front().frequency_hz) : Json(nullptr)},
          {"corrections_refused", machine.controller().refused()},
          {"frames_sent", machine.frames_sent()},
          {"frames_lost", machine.frames_lost()}};
}

void print_verdict(const Scenario& scenario, const HilScore& score, bool shadow) {
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
  if (score.ra_um) std::printf(", wall Ra %.2f µm", *score.ra_um);
  std::printf("\n");
}

void hil(const HilOptions& options) {
  if (!options.plot.empty()) plot::check_picture_name(options.plot);
  Cell cell = read_cell(options.cell, {.bus = false});
  cell.mode = options.shadow ? RuntimeMode::shadow : RuntimeMode::active;
  const Scenario scenario = read_scenario(options.scenario, cell);
  VirtualMachine machine{cell, scenario, kHilOrigin};
  Progress progress{"running"};
  const Heard heard = run_in_data_time(cell, machine, [&](double share) { progress.update(share); });
  progress.finish();
  const HilScore score = score_run(machine, heard.events);
  if (!options.plot.empty()) plot::write_figure(hil_figure(scenario.title, cell, machine, heard, score), options.plot);
  if (options.json)
    std::cout << score_json(score, machine).dump() << '\n';
  else
    print_verdict(scenario, score, options.shadow);
}

}  // namespace

void add_hil_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("hil", "Run the daemon and a simulated machine in closed loop and score the run");
  auto options = std::make_shared<HilOptions>();
  command->add_option("CELL", options->cell, "cell file")->required();
  command->add_option("--scenario", options->scenario, "what is cut and what goes wrong (TOML)")->required();
  command->add_flag("--shadow", options->shadow, "corrections are shown and not followed");
  command->add_flag("--data-time", options->data_time, "as fast as it goes, without clock and threads: repeatable");
  command->add_option("--plot", options->plot, "draw the run to a .svg or .png file");
  command->add_flag("--json", options->json, "print one JSON object");
  command->footer(
      "Example:\n  stillcut hil examples/robot-cell/cell.toml --scenario examples/scenarios/depth-step.toml");
  command->callback([options] { hil(*options); });
}

}  // namespace stillcut
