#include "models/mode_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace stillcut {

double direction_cosine(const Mode& a, const Mode& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) sum += a.direction[i] * b.direction[i];
  return sum;
}

double mode_difference(const Mode& a, const Mode& b) {
  return std::abs(std::log2(a.natural_frequency / b.natural_frequency)) + 1.0 -
         std::min(1.0, std::abs(direction_cosine(a, b)));
}

std::vector<std::optional<std::size_t>> pair_modes(std::span<const Mode> of, std::span<const Mode> in) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> candidates;  // difference, index in each set
  for (std::size_t i = 0; i < of.size(); ++i) {
    for (std::size_t j = 0; j < in.size(); ++j) candidates.emplace_back(mode_difference(of[i], in[j]), i, j);
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<std::optional<std::size_t>> pairs(of.size());
  std::vector<bool> placed(in.size(), false);
  for (const auto& [unused, i, j] : candidates) {
    if (pairs[i] || placed[j]) continue;
    pairs[i] = j;
    placed[j] = true;
  }
  return pairs;
}

}  // namespace stillcut
