#include "tools/plot_tap.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "models/machining.hpp"
#include "tools/tap_report.hpp"

namespace stillcut {
namespace {

constexpr std::array kHammerColors{plot::kBlue, plot::kVermilion, plot::kGreen};
// [response][force]: what is measured along the hammer in the hammer's colour.
constexpr std::array<std::array<plot::Color, 3>, 3> kTapEntryColors{{{plot::kBlue, plot::kOrange, plot::kPurple},
                                                                     {plot::kSkyBlue, plot::kVermilion, plot::kYellow},
                                                                     {plot::kGrey, plot::kInk, plot::kGreen}}};
constexpr double kPhaseShown = 0.8;                  // coherence from which a phase is more than chance
constexpr double kBefore_ms = 1.0, kAfter_ms = 6.0;  // of a pulse, shown

plot::Line pulse_line(const TapHit& hit, const TapRecording& recording) {
  plot::Line line{.x = {}, .y = {}, .width = 1.0, .label = ""};
  const double per_ms = 1e-3 * recording.sample_rate_hz, at = static_cast<double>(hit.at);
  const auto begin = static_cast<std::size_t>(std::max(0.0, at - kBefore_ms * per_ms));
  const auto end = std::min(recording.force.size(), static_cast<std::size_t>(at + kAfter_ms * per_ms));
  for (std::size_t i = begin; i < end; ++i) {
    line.x.push_back((static_cast<double>(i) - at) / per_ms);
    line.y.push_back(recording.force[i]);
  }
  return line;
}

plot::Panel pulse_panel(std::span<const TappedDirection> directions) {
  plot::Panel panel;
  panel.title = "Hammer";
  panel.y.label = "force [N]";
  panel.x = plot::Axis{.label = "time after the force rises [ms]", .min = -kBefore_ms, .max = kAfter_ms};
  for (const TappedDirection& tapped : directions) {
    bool first = true;
    for (const TapHit& hit : tapped.estimate.hits) {
      if (hit.fault != TapFault::none) continue;
      plot::Line line = pulse_line(hit, tapped.recordings[hit.recording]);
      line.color = kHammerColors.at(static_cast<std::size_t>(tapped.hammer.axis));
      if (first) line.label = "towards " + direction_name(tapped.hammer);
      first = false;
      panel.lines.push_back(std::move(line));
    }
  }
  return panel;
}

}  // namespace

plot::Figure tap_figure(const std::string& title, std::span<const TappedDirection> directions,
                        const FrequencyResponse& response) {
  plot::Figure figure;
  figure.title = title;
  figure.subtitle = "Response along the first letter to the hammer along the second";
  figure.x.label = "frequency [Hz]";
  figure.x.min = 0.0;
  figure.x.max = 0.0;
  for (const TappedDirection& tapped : directions)
    figure.x.max = std::max(figure.x.max, quality_of(tapped.estimate).excited_to_hz);
  figure.height = 1200;
  figure.panels.push_back(pulse_panel(directions));
  plot::Panel magnitude, phase, coherence;
  magnitude.title = "Receptance";
  magnitude.y = {.label = "magnitude [m/N]", .logarithmic = true};
  magnitude.height = 1.6;
  phase.title = "Phase, where coherence is above 0.8";
  phase.y = {.label = "phase [°]", .min = -180.0, .max = 180.0};
  coherence.y = {.label = "coherence", .min = 0.0, .max = 1.0};
  const std::vector<double>& hz = response.frequencies_hz;
  const auto shown = static_cast<std::size_t>(std::ranges::upper_bound(hz, figure.x.max) - hz.begin());
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t force = 0; force < 3; ++force) {
      const ComplexValues& values = response.receptance.at(axis).at(force);
      if (values.empty()) continue;
      plot::Line line{.x = {hz.begin(), hz.begin() + static_cast<std::ptrdiff_t>(shown)}, .y = {}, .label = ""};
      line.color = kTapEntryColors.at(axis).at(force);
      line.width = axis == force ? 1.6 : 0.9;
      plot::Line angle = line, agreement = line;
      const std::vector<double>& known = response.coherence.at(axis).at(force);
      for (std::size_t i = 0; i < shown; ++i) {
        line.y.push_back(std::abs(values[i]));
        const bool tells = known.empty() || known[i] >= kPhaseShown;
        const bool wraps = i > 0 && std::abs(std::arg(values[i]) - std::arg(values[i - 1])) > 0.5 * kTwoPi;
        angle.y.push_back(tells && !wraps ? rad_to_deg(std::arg(values[i])) : kNaN);
      }
      line.label = std::string(1, "xyz"[axis]) + "xyz"[force];
      magnitude.lines.push_back(std::move(line));
      phase.lines.push_back(std::move(angle));
      if (known.empty()) continue;
      agreement.y.assign(known.begin(), known.begin() + static_cast<std::ptrdiff_t>(shown));
      coherence.lines.push_back(std::move(agreement));
    }
  figure.panels.push_back(std::move(magnitude));
  figure.panels.push_back(std::move(phase));
  if (!coherence.lines.empty()) figure.panels.push_back(std::move(coherence));
  return figure;
}

}  // namespace stillcut
