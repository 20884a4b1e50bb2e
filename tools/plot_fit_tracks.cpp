// Modes over the postures: how alike they are, and where they lie over the workspace.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "models/interpolation.hpp"
#include "models/machining.hpp"
#include "tools/plot_fit.hpp"

namespace stillcut {
namespace {

constexpr std::array kTrackColors{plot::kBlue,   plot::kVermilion, plot::kGreen, plot::kOrange,
                                  plot::kPurple, plot::kSkyBlue,   plot::kInk};

// The mode of a track at a posture.
const Mode* mode_on(const FitStudy& study, int track, std::size_t posture) {
  const auto& numbers = study.tracks.number[posture];
  const auto at = std::find(numbers.begin(), numbers.end(), track);
  return at == numbers.end() ? nullptr
                             : &study.map.postures[posture].modes[static_cast<std::size_t>(at - numbers.begin())];
}

double hz_on(const FitStudy& study, int track, std::size_t posture) {
  const Mode* mode = mode_on(study, track, posture);
  return mode == nullptr ? kNaN : mode->natural_frequency / kTwoPi;
}

// The two axes along which the places spread most, in their order; the same twice where they spread along one only.
std::array<std::size_t, 2> widest_plane(const DynamicsMap& map) {
  std::array<std::pair<double, std::size_t>, 3> spread;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [low, high] =
        std::minmax_element(map.postures.begin(), map.postures.end(),
                            [k](const Posture& a, const Posture& b) { return a.position[k] < b.position[k]; });
    spread[k] = {-(high->position[k] - low->position[k]), k};
  }
  std::stable_sort(spread.begin(), spread.end());
  if (spread[1].first >= 0.0) return {spread[0].second, spread[0].second};
  return {std::min(spread[0].second, spread[1].second), std::max(spread[0].second, spread[1].second)};
}

// A track alone in a map of places, for the interpolation.
DynamicsMap map_of_track(const FitStudy& study, int track) {
  DynamicsMap map;
  for (std::size_t p = 0; p < study.map.postures.size(); ++p) {
    const Mode* mode = mode_on(study, track, p);
    if (mode == nullptr) continue;
    Posture posture = study.map.postures[p];
    posture.modes = {*mode};
    map.postures.push_back(std::move(posture));
  }
  return map;
}

plot::Panel plane_panel(const FitStudy& study, int track, const std::array<std::size_t, 2>& axes) {
  constexpr int kCells = 48;
  constexpr double kFlat = 0.005;
  const DynamicsMap map = map_of_track(study, track);
  std::array<double, 2> low{kInfinity, kInfinity}, high{-kInfinity, -kInfinity};
  std::array<double, 3> middle{};
  for (const Posture& posture : study.map.postures) {
    for (std::size_t a = 0; a < 2; ++a) {
      low[a] = std::min(low[a], posture.position[axes[a]]);
      high[a] = std::max(high[a], posture.position[axes[a]]);
    }
    for (std::size_t k = 0; k < 3; ++k)
      middle[k] += posture.position[k] / static_cast<double>(study.map.postures.size());
  }
  for (std::size_t a = 0; a < 2; ++a) {
    const double rim = 0.04 * (high[a] - low[a]);  // so that the outermost postures are seen whole
    low[a] -= rim, high[a] += rim;
  }
  plot::Image image;
  image.x_begin = 1e3 * low[0], image.x_end = 1e3 * high[0];
  image.y_begin = 1e3 * low[1], image.y_end = 1e3 * high[1];
  image.columns = image.rows = kCells;
  image.low = kInfinity;
  image.high = -kInfinity;
  for (int row = 0; row < kCells; ++row)
    for (int column = 0; column < kCells; ++column) {
      Posture place;
      place.position = middle;
      place.position[axes[0]] = low[0] + (high[0] - low[0]) * (column + 0.5) / kCells;
      place.position[axes[1]] = low[1] + (high[1] - low[1]) * (row + 0.5) / kCells;
      const auto modes = predict_posture(map, place, {.kind = InterpolationKind::trend}).posture.modes;
      const double hz = modes.front().natural_frequency / kTwoPi;
      image.values.push_back(static_cast<float>(hz));
      image.low = std::min(image.low, hz);
      image.high = std::max(image.high, hz);
    }
  const double middle_hz = 0.5 * (image.low + image.high);
  if (image.high - image.low < kFlat * middle_hz)  // no colours for what is but noise
    image.low = (1.0 - kFlat) * middle_hz, image.high = (1.0 + kFlat) * middle_hz;
  image.scale_label = "Hz";
  plot::Panel panel;
  panel.title = "Mode " + std::to_string(track);
  plot::Scatter found{.x = {}, .y = {}, .color = plot::kInk, .size = 5.0, .label = "found"};
  plot::Scatter missing{.x = {}, .y = {}, .color = plot::kVermilion, .size = 7.0, .label = "missing"};
  missing.marker = plot::Marker::cross;
  for (std::size_t p = 0; p < study.map.postures.size(); ++p) {
    const Posture& posture = study.map.postures[p];
    plot::Scatter& points = mode_on(study, track, p) != nullptr ? found : missing;
    points.x.push_back(1e3 * posture.position[axes[0]]);
    points.y.push_back(1e3 * posture.position[axes[1]]);
  }
  panel.image = std::move(image);
  panel.points = {std::move(found)};
  if (!missing.x.empty()) panel.points.push_back(std::move(missing));
  panel.y.label = std::string(1, "xyz"[axes[1]]) + " [mm]";
  return panel;
}

plot::Panel posture_panel(const FitStudy& study) {
  plot::Panel panel;
  panel.title = "Natural frequency from posture to posture";
  panel.y = {.label = "Hz", .logarithmic = true};
  for (int track = 1; track <= study.tracks.count; ++track) {
    const plot::Color color = kTrackColors[static_cast<std::size_t>(track - 1) % kTrackColors.size()];
    plot::Line line;
    line.color = color;
    plot::Scatter points{.x = {}, .y = {}, .color = color, .size = 6.0, .label = "mode " + std::to_string(track)};
    for (std::size_t p = 0; p < study.map.postures.size(); ++p) {
      line.x.push_back(static_cast<double>(p + 1));
      line.y.push_back(hz_on(study, track, p));
    }
    points.x = line.x;
    points.y = line.y;
    panel.lines.push_back(std::move(line));
    panel.points.push_back(std::move(points));
  }
  return panel;
}

}  // namespace

plot::Figure assurance_figure(const FitStudy& study) {
  std::vector<const Mode*> modes;
  plot::Panel panel;
  for (int track = 1; track <= study.tracks.count; ++track) {
    const auto first = static_cast<double>(modes.size());
    for (std::size_t p = 0; p < study.map.postures.size(); ++p)
      if (const Mode* mode = mode_on(study, track, p)) modes.push_back(mode);
    const double middle = 0.5 * (first + static_cast<double>(modes.size()));
    panel.notes.push_back({middle, middle, std::to_string(track), plot::kVermilion});
  }
  const auto count = static_cast<int>(modes.size());
  plot::Image image;
  image.x_end = image.y_end = 1.0 * count;
  const int fine = std::max(1, 400 / std::max(1, count));  // cells of a pair, so that its edges are sharp
  image.columns = image.rows = fine * count;
  image.scale_label = "MAC";
  for (int row = 0; row < image.rows; ++row)
    for (int column = 0; column < image.columns; ++column)
      image.values.push_back(static_cast<float>(modal_assurance(*modes[static_cast<std::size_t>(row / fine)],
                                                                *modes[static_cast<std::size_t>(column / fine)])));
  panel.image = std::move(image);
  panel.y.label = "modes, by their number";
  panel.same_scale = true;
  plot::Figure figure;
  figure.title = "Modal assurance criterion between all modes of all postures";
  figure.subtitle =
      "Numbers: the mode over the postures; where its direction stays, its square on the diagonal is "
      "bright";
  figure.x = {.label = "modes, by their number", .min = 0.0, .max = 1.0 * count};
  panel.y.min = 0.0;
  panel.y.max = 1.0 * count;
  figure.panels = {std::move(panel)};
  figure.width = 900;
  figure.height = 900;
  return figure;
}

plot::Figure track_figure(const FitStudy& study) {
  plot::Figure figure;
  figure.title = "Natural frequencies over the workspace";
  const auto axes = widest_plane(study.map);
  if (study.places_known && study.map.postures.size() >= 3 && axes[0] != axes[1]) {
    figure.subtitle = "Points: where the tool stood; between them as the interpolation \"trend\" has it over the place";
    figure.x.label = std::string(1, "xyz"[axes[0]]) + " [mm]";
    for (int track = 1; track <= study.tracks.count; ++track) figure.panels.push_back(plane_panel(study, track, axes));
    figure.height = 120 + 260 * static_cast<int>(figure.panels.size());
    return figure;
  }
  figure.subtitle = "Lines join what was found to be the same mode";
  figure.x = {.label = "posture", .min = 0.5, .max = static_cast<double>(study.map.postures.size()) + 0.5};
  for (const Posture& posture : study.map.postures) figure.x.names.push_back(posture.id);
  figure.panels = {posture_panel(study)};
  figure.height = 620;
  return figure;
}

}  // namespace stillcut
