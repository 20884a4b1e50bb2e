#include "models/surface_texture.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <unsupported/Eigen/FFT>

#include "dsp/numbers.hpp"
#include "models/surface_form.hpp"

namespace stillcut {
namespace {

constexpr std::size_t kLeastInProfile = 8, kPadding = 4;
constexpr double kMostUnknown = 0.1;     // gaps put power beside every line
constexpr double kLeastRepeats = 1.9;    // twice, but for what the form that was removed shifts a slow wave
constexpr double kDiscrimination = 0.1;  // of the total height, ISO 4287
constexpr double kHannReach = 2.0;       // a line's half width, in resolved frequencies

std::vector<double> hann(std::size_t count) {
  std::vector<double> window(count);
  for (std::size_t k = 0; k < count; ++k)
    window[k] =
        0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * (static_cast<double>(k) + 0.5) / static_cast<double>(count));
  return window;
}

// Where a parabola through the logarithms of three equally spaced powers is highest, from the middle one: -0.5..0.5.
double parabola_top(double before, double middle, double after) {
  if (!(before > 0.0 && after > 0.0)) return 0.0;
  const double a = std::log(before), b = std::log(middle), c = std::log(after);
  const double bend = a - 2.0 * b + c;
  return bend < 0.0 ? std::clamp(0.5 * (a - c) / bend, -0.5, 0.5) : 0.0;
}

}  // namespace

TextureSpectrum texture_spectrum(const HeightMap& map, ProfileDirection direction) {
  require_sound_map(map);
  const double spacing = profile_spacing(map, direction);
  const std::size_t points = direction == ProfileDirection::along ? map.along : map.across;
  if (points < kLeastInProfile)
    throw std::invalid_argument("a texture's spectrum needs profiles of eight points or more");
  const std::size_t length = kPadding * std::bit_ceil(points), bins = length / 2 + 1;
  const std::vector<double> window = hann(points);
  Eigen::FFT<double> transform;
  transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<double> padded(length), density(bins, 0.0);
  std::vector<std::complex<double>> lines;
  TextureSpectrum result;
  result.length = spacing * static_cast<double>(points);
  for (std::size_t p = 0; p < profile_count(map, direction); ++p) {
    std::vector<double> heights = surface_profile(map, direction, p);
    const auto unknown = static_cast<double>(points - known_points(heights));
    if (unknown > kMostUnknown * static_cast<double>(points)) {
      ++result.left_out;
      continue;
    }
    remove_form(heights, SurfaceForm::quadratic);  // a bow would look like a slow wave
    double weight = 0.0;
    for (std::size_t k = 0; k < points; ++k) {
      const bool known = !std::isnan(heights[k]);
      padded[k] = known ? window[k] * heights[k] : 0.0;
      weight += known ? window[k] * window[k] : 0.0;
    }
    transform.fwd(lines, padded);
    for (std::size_t k = 0; k < bins; ++k)  // one-sided: the other half of all but the first and the last line
      density[k] += (k == 0 || k + 1 == bins ? 1.0 : 2.0) * std::norm(lines[k]) * spacing / weight;
    ++result.profiles;
  }
  if (result.profiles == 0)
    throw std::invalid_argument("more than a tenth of every profile is not known; the texture is open");
  for (double& value : density) value /= static_cast<double>(result.profiles);
  result.densities = std::move(density);
  for (std::size_t k = 0; k < bins; ++k)
    result.frequencies.push_back(static_cast<double>(k) / (static_cast<double>(length) * spacing));
  return result;
}

TextureInterval texture_interval(const TextureSpectrum& spectrum) {
  const std::vector<double>& density = spectrum.densities;
  std::size_t strongest = 0;
  double total = 0.0;
  for (std::size_t k = 0; k < density.size(); ++k) {
    total += density[k];
    if (k == 0 || k + 1 == density.size() || spectrum.frequencies[k] * spectrum.length < kLeastRepeats) continue;
    const bool peak = density[k] >= density[k - 1] && density[k] > density[k + 1];
    if (peak && (strongest == 0 || density[k] > density[strongest])) strongest = k;
  }
  if (strongest == 0 || !(total > 0.0)) return {kNaN, 0.0};
  const double step = spectrum.frequencies[1];
  const double shift = parabola_top(density[strongest - 1], density[strongest], density[strongest + 1]);
  const auto reach = static_cast<std::size_t>(std::ceil(kHannReach / (spectrum.length * step)));
  double line = 0.0;
  for (std::size_t k = strongest - std::min(strongest, reach); k <= std::min(strongest + reach, density.size() - 1);
       ++k)
    line += density[k];
  return {1.0 / (spectrum.frequencies[strongest] + shift * step), line / total};
}

double mean_element_width(const HeightMap& map, ProfileDirection direction) {
  require_sound_map(map);
  double sum = 0.0, counted = 0.0;
  for (std::size_t p = 0; p < profile_count(map, direction); ++p) {
    std::vector<double> heights = surface_profile(map, direction, p);
    if (static_cast<double>(known_points(heights)) < (1.0 - kMostUnknown) * static_cast<double>(heights.size()))
      continue;
    remove_form(heights, SurfaceForm::linear);
    double low = kInfinity, high = -kInfinity;
    for (const double height : heights) {
      if (std::isnan(height)) continue;
      low = std::min(low, height), high = std::max(high, height);
    }
    const double discrimination = kDiscrimination * (high - low);
    // An element begins where the profile last rose through the line before it became a hill.
    double rising = kNaN, first = kNaN, last = kNaN, elements = -1.0;
    bool valley = false;
    for (std::size_t i = 1; i < heights.size(); ++i) {
      if (heights[i - 1] < 0.0 && heights[i] >= 0.0)
        rising = static_cast<double>(i) - heights[i] / (heights[i] - heights[i - 1]);
      if (heights[i] < -discrimination) valley = true;
      if (!valley || !(heights[i] > discrimination) || std::isnan(rising)) continue;
      valley = false;
      if (std::isnan(first)) first = rising;
      last = rising;
      elements += 1.0;
    }
    if (!(elements >= 1.0)) continue;
    sum += (last - first) / elements * profile_spacing(map, direction);
    counted += 1.0;
  }
  return counted > 0.0 ? sum / counted : kNaN;
}

}  // namespace stillcut
