// The measured entries of a frequency response as tables of lines, for fitting.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "models/frequency_response.hpp"

namespace stillcut {

struct FrfEntry {
  int response = 0, force = 0;  // axes
  Eigen::VectorXcd values;      // m/N
};

struct FrfLines {
  Eigen::VectorXd omega;           // rad/s, rising, above 0
  std::vector<std::size_t> lines;  // of the response: where they come from
  std::vector<FrfEntry> entries;
};

// Those of a sound response between two frequencies, ends included; 0 Hz is left out.
[[nodiscard]] FrfLines lines_between(const FrequencyResponse& response, double lowest_hz, double highest_hz);

// Some of them: `count` lines from the first on.
[[nodiscard]] FrfLines some_lines(const FrfLines& all, Eigen::Index first, Eigen::Index count);

// One over the variance of the real part of each value, which is that of its imaginary part too, as FrfLines has them:
// a vector for each entry.
using FrfWeights = std::vector<Eigen::VectorXd>;

// The six places of a symmetric tensor: xx, yy, zz, xy, xz, yz.
[[nodiscard]] constexpr int symmetric_place(int i, int j) { return i == j ? i : i + j + 2; }

}  // namespace stillcut
