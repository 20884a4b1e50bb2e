#include "tools/plot_scale.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace stillcut::plot {
namespace {

double round_step(double span, int count) {
  const double raw = span / std::max(count, 1), power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (raw <= factor * power * (1.0 + 1e-9)) return factor * power;
  return 10.0 * power;
}

}  // namespace

std::vector<double> ticks(Range range, int count) {
  if (!(range.span() > 0.0) || !std::isfinite(range.span())) return {};
  const double step = round_step(range.span(), count), slack = 1e-9 * range.span();
  std::vector<double> values;
  for (double i = std::ceil((range.low - slack) / step); i * step <= range.high + slack; ++i)
    values.push_back(i == 0.0 ? 0.0 : i * step);
  return values;
}

std::vector<double> decade_ticks(Range range) {
  std::vector<double> decades;
  for (double i = std::ceil(range.low - 1e-9); i <= range.high + 1e-9; ++i) decades.push_back(i);
  return decades;
}

std::string tick_text(double value, double step) {
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  std::string result = text.data();
  if (result.front() == '-') result.replace(0, 1, "\u2212");  // a true minus sign
  return result;
}

std::string decade_text(double exponent) {
  constexpr double kMostZeros = 4.0;
  const double power = std::pow(10.0, exponent);
  if (std::abs(exponent) <= kMostZeros) return tick_text(power, std::min(power, 1.0));
  constexpr std::array kDigits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0.0 ? "10⁻" : "10";
  for (const char digit : std::to_string(std::lround(std::abs(exponent))))
    text += kDigits.at(static_cast<std::size_t>(digit - '0'));
  return text;
}

Range axis_range(const Axis& axis, std::span<const std::vector<double>* const> data, double margin) {
  Range range{INFINITY, -INFINITY};
  for (const std::vector<double>* values : data)
    for (const double value : *values) {
      const double at = axis.logarithmic ? std::log10(value) : value;
      if (std::isfinite(at)) range = {std::min(range.low, at), std::max(range.high, at)};
    }
  if (!(range.low <= range.high)) range = {0.0, 1.0};
  const double room = range.span() > 0.0 ? margin * range.span() : 0.5 * std::max(1.0, std::abs(range.low)) * margin;
  range = {range.low - room, range.high + room};
  if (std::isfinite(axis.min)) range.low = axis.logarithmic ? std::log10(axis.min) : axis.min;
  if (std::isfinite(axis.max)) range.high = axis.logarithmic ? std::log10(axis.max) : axis.max;
  if (!(range.low < range.high)) range.high = range.low + 1.0;
  return range;
}

Line decimated(const Line& line, Range x, int columns) {
  if (line.x.size() <= 4 * static_cast<std::size_t>(columns) || !std::is_sorted(line.x.begin(), line.x.end()))
    return line;
  Line result = line;
  result.x.clear();
  result.y.clear();
  const auto column_of = [&](std::size_t i) { return std::floor((line.x[i] - x.low) / x.span() * columns); };
  for (std::size_t begin = 0; begin < line.x.size();) {
    std::size_t end = begin, low = begin, high = begin;
    for (; end < line.x.size() && column_of(end) == column_of(begin); ++end) {
      if (!(line.y[end] >= line.y[low])) low = end;  // a NaN is kept: it breaks the line
      if (line.y[end] > line.y[high]) high = end;
    }
    std::array<std::size_t, 4> keep{begin, low, high, end - 1};
    std::sort(keep.begin(), keep.end());
    for (auto i = keep.begin(), stop = std::unique(keep.begin(), keep.end()); i != stop; ++i) {
      result.x.push_back(line.x[*i]);
      result.y.push_back(line.y[*i]);
    }
    begin = end;
  }
  return result;
}

Color scale_color(double share) {
  static constexpr std::array<Color, 9> kStops{{{0.267, 0.005, 0.329},
                                                {0.278, 0.176, 0.482},
                                                {0.231, 0.322, 0.545},
                                                {0.173, 0.447, 0.557},
                                                {0.129, 0.569, 0.549},
                                                {0.157, 0.682, 0.502},
                                                {0.369, 0.789, 0.384},
                                                {0.678, 0.863, 0.188},
                                                {0.993, 0.906, 0.144}}};
  const double position = std::isfinite(share) ? std::clamp(share, 0.0, 1.0) * (kStops.size() - 1) : 0.0;
  const auto low = std::min(static_cast<std::size_t>(position), kStops.size() - 2);
  const double part = position - static_cast<double>(low);
  const Color &a = kStops[low], &b = kStops[low + 1];
  return {std::lerp(a.red, b.red, part), std::lerp(a.green, b.green, part), std::lerp(a.blue, b.blue, part)};
}

}  // namespace stillcut::plot
