// The arithmetic behind a picture: round ticks, ranges, few points instead of many, colours of a scale. Nothing here
// draws.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/plot.hpp"

namespace stillcut::plot {

struct Range {
  double low = 0.0, high = 1.0;
  [[nodiscard]] double span() const { return high - low; }
};

// Round values (1, 2 or 5 times a power of ten apart) inside the range, about `count` of them.
std::vector<double> ticks(Range range, int count);

// Powers of ten inside the range of a logarithmic axis; `range` holds the values' decimal logarithms, as do the ticks.
std::vector<double> decade_ticks(Range range);

// A tick's value with just the decimals its neighbours need.
std::string tick_text(double value, double step);

// A power of ten by its logarithm: 0.01, 1, 1000, and 10⁻⁶ where the zeros would have to be counted.
std::string decade_text(double exponent);

// The range of finite values, widened by `margin` of itself on both sides; never empty. An end the axis fixes stays. Of
// a logarithmic axis the range of the decimal logarithms.
Range axis_range(const Axis& axis, std::span<const std::vector<double>* const> data, double margin);

// A long line as the eye sees it: at most four points (first, lowest, highest, last) for each of `columns` stretches of
// rising x. A line of few points, or one whose x goes back, is returned as it is.
Line decimated(const Line& line, Range x, int columns);

// Perceptually even from dark blue to yellow, close to matplotlib's viridis; `share` 0..1.
Color scale_color(double share);

}  // namespace stillcut::plot
