// Random height maps, what is the same map, and files spoilt at random.
#pragma once

#include <cmath>
#include <random>
#include <string>

#include "dsp/numbers.hpp"
#include "models/height_map.hpp"

namespace stillcut {

// 2 to 14 points in a direction, spacings and heights of many decades with all their digits, a tenth not known.
inline HeightMap random_height_map(std::mt19937_64& random) {
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto points = [&] { return std::uniform_int_distribution<std::size_t>(2, 14)(random); };
  HeightMap map{points(), points(), std::pow(10.0, uniform(-9, 1)), std::pow(10.0, uniform(-9, 1)), {}};
  for (std::size_t k = 0; k < map.along * map.across; ++k) {
    const double height = uniform(-1, 1) * std::pow(10.0, uniform(-12, 3));
    map.heights.push_back(uniform(0, 1) < 0.1 ? kNaN : uniform(0, 1) < 0.05 ? 0.0 : height);
  }
  return map;
}

inline bool same_map(const HeightMap& a, const HeightMap& b) {
  if (a.along != b.along || a.across != b.across || a.heights.size() != b.heights.size()) return false;
  if (a.spacing_along != b.spacing_along || a.spacing_across != b.spacing_across) return false;
  for (std::size_t k = 0; k < a.heights.size(); ++k)
    if (a.heights[k] != b.heights[k] && !(std::isnan(a.heights[k]) && std::isnan(b.heights[k]))) return false;
  return true;
}

// Cut off, or some characters changed, left out, doubled.
inline std::string spoilt_text(std::string text, std::mt19937_64& random) {
  const auto below = [&](std::size_t end) { return std::uniform_int_distribution<std::size_t>(0, end - 1)(random); };
  static constexpr std::string_view kCharacters = "0123456789.,-+eE* =\r\n\"#;naNBADinfx\0\xFF\x80";
  if (below(3) == 0) text.resize(below(text.size()));
  for (std::size_t n = below(6); n > 0 && !text.empty(); --n) {
    const std::size_t at = below(text.size());
    if (below(3) == 0) text[at] = kCharacters[below(kCharacters.size())];
    if (below(3) == 0) text.erase(at, below(20) + 1);
    if (below(3) == 0) text.insert(std::min(at, text.size()), text.substr(std::min(at, text.size()), below(20)));
  }
  return text;
}

}  // namespace stillcut
