#include "tools/plot_surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "dsp/numbers.hpp"
#include "models/surface_form.hpp"
#include "models/surface_roughness.hpp"
#include "models/surface_texture.hpp"

namespace stillcut {
namespace {

constexpr std::size_t kMostPixels = 1000;  // of the picture in a direction; more would not be seen

std::string with_number(const char* format, double number) {
  char text[96];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

HeightMap level(HeightMap map) {
  remove_form(map, SurfaceForm::linear);
  return map;
}

std::size_t thinned(std::size_t points, std::size_t most) { return (points + most - 1) / most; }

plot::Image image_of(const HeightMap& map) {
  const std::size_t step_i = thinned(map.along, kMostPixels), step_j = thinned(map.across, kMostPixels);
  plot::Image image;
  for (std::size_t j = 0; j < map.across; j += step_j, ++image.rows)
    for (std::size_t i = 0; i < map.along; i += step_i) image.values.push_back(static_cast<float>(1e6 * map.at(i, j)));
  image.columns = static_cast<int>((map.along + step_i - 1) / step_i);
  // A point is the middle of its pixel.
  const double dx = 1e3 * map.spacing_along * static_cast<double>(step_i);
  const double dy = 1e3 * map.spacing_across * static_cast<double>(step_j);
  image.x_begin = -0.5 * dx, image.x_end = (image.columns - 0.5) * dx;
  image.y_begin = -0.5 * dy, image.y_end = (image.rows - 0.5) * dy;
  const HeightStatistics heights = height_statistics(map.heights);
  image.low = 1e6 * heights.lowest, image.high = 1e6 * heights.highest;
  if (!(image.high > image.low)) image.high = image.low + 1.0;  // a flat surface still has a scale
  image.scale_label = "height [µm]";
  return image;
}

// As large as a map of this shape needs, with what stands around it.
void fit_to_map(plot::Figure& figure, const HeightMap& map) {
  constexpr int kAround = 190, kLeastWidth = 620, kLeastHeight = 300;
  const double wide = static_cast<double>(map.along) * map.spacing_along;
  const double tall = static_cast<double>(map.across) * map.spacing_across;
  const double scale = std::min((figure.width - kAround) / wide, (figure.height - kAround) / tall);
  figure.width = std::max(kLeastWidth, kAround + static_cast<int>(scale * wide));
  figure.height = std::max(kLeastHeight, kAround + static_cast<int>(scale * tall));
}

plot::Panel profile_panel(const HeightMap& map, ProfileDirection direction) {
  const bool along = direction == ProfileDirection::along;
  const std::size_t middle = profile_count(map, direction) / 2;
  const std::vector<double> heights = surface_profile(map, direction, middle);
  plot::Panel panel;
  plot::Line line;
  for (std::size_t k = 0; k < heights.size(); ++k) {
    line.x.push_back(1e3 * static_cast<double>(k) * profile_spacing(map, direction));
    line.y.push_back(1e6 * heights[k]);
  }
  const double at = 1e3 * static_cast<double>(middle) * (along ? map.spacing_across : map.spacing_along);
  panel.title = along ? with_number("Along the feed, %.3g mm across it", at)
                      : with_number("Across the feed, %.3g mm along it", at);
  if (known_enough(known_points(heights), heights.size()) && known_points(heights) > 2) {
    const ProfileRoughness r = profile_roughness(heights, profile_spacing(map, direction));
    panel.title += with_number(":  R_a %.3g", 1e6 * r.ra) + with_number(", R_q %.3g", 1e6 * r.rq) +
                   with_number(", R_t %.3g µm", 1e6 * r.rt);
  }
  panel.x = plot::Axis{.label = along ? "along the feed [mm]" : "across the feed [mm]"};
  panel.y.label = "µm";
  line.color = along ? plot::kBlue : plot::kVermilion;
  panel.lines = {std::move(line)};
  return panel;
}

plot::Panel spectrum_panel(const HeightMap& map, ProfileDirection direction) {
  constexpr double kUm2 = 1e12, kShown = 1e-6;  // of the strongest
  constexpr double kHarmonics = 12.0;           // of the interval: beyond them there is only noise to see
  const bool along = direction == ProfileDirection::along;
  const TextureSpectrum spectrum = texture_spectrum(map, direction);
  const TextureInterval interval = texture_interval(spectrum);
  plot::Panel panel;
  plot::Line line;
  double strongest = 0.0;
  for (std::size_t k = 1; k < spectrum.frequencies.size(); ++k) {
    line.x.push_back(1e-3 * spectrum.frequencies[k]);
    line.y.push_back(kUm2 * 1e3 * spectrum.densities[k]);
    strongest = std::max(strongest, line.y.back());
  }
  panel.title =
      std::string(along ? "Along" : "Across") + " the feed, mean of " + std::to_string(spectrum.profiles) + " profiles";
  panel.x = plot::Axis{.label = "waves a mm", .min = 0.0, .max = kNaN};
  panel.y = {.label = "µm² mm", .min = strongest > 0.0 ? kShown * strongest : kNaN, .max = kNaN, .logarithmic = true};
  line.color = along ? plot::kBlue : plot::kVermilion;
  panel.lines = {std::move(line)};
  if (!std::isfinite(interval.interval)) return panel;
  panel.x->max = std::min(panel.lines[0].x.back(), kHarmonics * 1e-3 / interval.interval);
  panel.events.push_back({1e-3 / interval.interval, with_number("every %.4g mm", 1e3 * interval.interval) +
                                                        with_number(", %.0f %% of the power", 100 * interval.share)});
  return panel;
}

}  // namespace

plot::Figure height_map_figure(const HeightMap& map, const std::string& title) {
  const HeightMap levelled = level(map);
  plot::Panel panel;
  panel.image = image_of(levelled);
  panel.y.label = "across the feed [mm]";
  panel.same_scale = true;
  plot::Figure figure;
  figure.title = title;
  if (known_enough(known_points(map.heights), map.heights.size())) {
    const ArealRoughness area = areal_roughness(map);
    figure.subtitle = with_number("S_a %.3g", 1e6 * area.sa) + with_number(", S_q %.3g", 1e6 * area.sq) +
                      with_number(", S_z %.3g µm; least-squares plane removed", 1e6 * area.sz);
  }
  figure.x.label = "along the feed [mm]";
  fit_to_map(figure, map);
  figure.panels = {std::move(panel)};
  return figure;
}

plot::Figure surface_profiles_figure(const HeightMap& map, const std::string& title) {
  const HeightMap levelled = level(map);
  plot::Figure figure;
  figure.title = title;
  figure.subtitle = "Profiles through the middle, least-squares plane removed";
  figure.panels = {profile_panel(levelled, ProfileDirection::along), profile_panel(levelled, ProfileDirection::across)};
  figure.height = 700;
  return figure;
}

plot::Figure surface_spectrum_figure(const HeightMap& map, const std::string& title) {
  plot::Figure figure;
  figure.title = title;
  figure.subtitle = "Power of the surface over spatial frequency";
  figure.panels = {spectrum_panel(map, ProfileDirection::along), spectrum_panel(map, ProfileDirection::across)};
  figure.height = 760;
  return figure;
}

}  // namespace stillcut
