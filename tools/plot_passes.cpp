#include "tools/plot_passes.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace stillcut {
namespace {

constexpr std::size_t kShownEvery = 4;  // points of a profile, 4 um: a picture's own

std::string wall_title(const PassRun& run) {
  const ProfileRoughness mean = over_slices(run.result.wall).mean;
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), "%s; mean of %zu slices: Ra %.2f, Rq %.2f, Rt %.2f µm",
                pass_name(run.pass).c_str(), run.result.wall.size(), mean.ra * 1e6, mean.rq * 1e6, mean.rt * 1e6);
  return text.data();
}

}  // namespace

plot::Figure pass_forces_figure(const std::vector<PassRun>& runs) {
  plot::Figure figure;
  figure.title = "Cutting forces on the tool over two turns";
  figure.x.label = "turns";
  figure.height = 300 + 220 * static_cast<int>(runs.size());
  for (const PassRun& run : runs) {
    plot::Panel& panel = figure.panels.emplace_back();
    panel.title = pass_name(run.pass);
    panel.y.label = "force [N]";
    panel.lines = {{.x = run.result.turns, .y = run.result.feed_force, .color = plot::kBlue, .label = "along the feed"},
                   {.x = run.result.turns, .y = run.result.cross_force, .color = plot::kVermilion, .label = "across"}};
  }
  return figure;
}

plot::Figure pass_spectrum_figure(const std::vector<PassRun>& runs) {
  plot::Figure figure;
  figure.title = "Spectrum of the cross-feed force";
  figure.x.label = "frequency [Hz]";
  figure.height = 300 + 200 * static_cast<int>(runs.size());
  for (const PassRun& run : runs) {
    plot::Panel& panel = figure.panels.emplace_back();
    panel.title = pass_name(run.pass);
    panel.y.label = "force [N]";
    const Spectrum& spectrum = run.result.cross_spectrum;
    plot::Line line{.x = {}, .y = {}, .color = plot::kBlue, .label = ""};
    for (std::size_t i = 1; i < spectrum.amplitude.size(); ++i) {
      line.x.push_back(static_cast<double>(i) * spectrum.resolution);
      line.y.push_back(spectrum.amplitude[i]);
    }
    panel.lines = {line};
    for (const auto& [frequency, text] : {std::pair{18700.0 / 60.0, "spindle"}, {18700.0 / 30.0, "tooth passing"}}) {
      const auto at = static_cast<std::size_t>(std::lround(frequency / spectrum.resolution));
      if (at < line.y.size()) panel.notes.push_back({frequency + 12.0, line.y[at - 1], text, plot::kVermilion});
    }
  }
  return figure;
}

plot::Figure pass_wall_figure(const std::vector<PassRun>& runs) {
  plot::Figure figure;
  figure.title = "The machined wall along the feed";
  figure.subtitle = "The middle slice; into the part is up, the nominal wall at 0";
  figure.x.label = "along the feed [mm]";
  figure.height = 300 + 220 * static_cast<int>(runs.size());
  for (const PassRun& run : runs) {
    plot::Panel& panel = figure.panels.emplace_back();
    panel.title = wall_title(run);
    panel.y.label = "height [µm]";
    plot::Line line{.x = {}, .y = {}, .color = plot::kInk, .width = 1.0, .label = ""};
    const double count = static_cast<double>(run.result.profile.size() - 1);
    for (std::size_t i = 0; i < run.result.profile.size(); i += kShownEvery) {
      line.x.push_back(static_cast<double>(i) / count * run.pass.wall_length * 1e3);
      line.y.push_back(run.result.profile[i] * 1e6);
    }
    panel.lines = {line};
  }
  return figure;
}

}  // namespace stillcut
