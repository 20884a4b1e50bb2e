#include "models/milled_profile.hpp"

#include <algorithm>
#include <cmath>

namespace stillcut {
namespace {

constexpr std::size_t kLengthPoints = 160;  // a sampling length: 5 um apart

std::optional<ProfileRoughness> roughness_of_length(const MilledHeights& heights, double from) {
  constexpr double kSpacing = kSamplingLength / kLengthPoints;
  const std::vector<double> profile = heights(from, kSpacing, kLengthPoints);
  if (!std::all_of(profile.begin(), profile.end(), [](double height) { return std::isfinite(height); })) return {};
  return profile_roughness(profile, kSpacing);
}

}  // namespace

std::vector<MilledLength> milled_lengths(const MilledHeights& heights, double begin, double end, std::size_t most) {
  const double count = std::floor((end - begin) / kSamplingLength);
  const auto every = static_cast<std::size_t>(std::max(1.0, std::ceil(count / static_cast<double>(most))));
  std::vector<MilledLength> lengths;
  std::size_t i = 0;
  for (double from = begin; from + kSamplingLength <= end; from += kSamplingLength, ++i)
    if (i % every == 0) lengths.push_back({from, roughness_of_length(heights, from)});
  return lengths;
}

std::optional<ProfileRoughness> mean_of(std::span<const MilledLength> lengths) {
  std::vector<ProfileRoughness> known;
  for (const MilledLength& length : lengths)
    if (length.roughness) known.push_back(*length.roughness);
  if (known.empty()) return {};
  return mean_of(known);
}

}  // namespace stillcut
