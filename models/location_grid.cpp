#include "models/location_grid.hpp"

#include <algorithm>

namespace stillcut {
namespace {

struct Gathered {
  double low = 0.0, high = 0.0;  // m
};

std::vector<Gathered> gather(std::vector<double> values, int most) {
  constexpr double kSame = 1e-6;  // m
  std::sort(values.begin(), values.end());
  std::vector<Gathered> lines;
  for (const double value : values) {
    if (!lines.empty() && value - lines.back().high < kSame) {
      lines.back().high = value;
    } else {
      lines.push_back({value, value});
    }
  }
  while (static_cast<int>(lines.size()) > most) {
    std::size_t closest = 1;
    const auto width = [&](std::size_t i) { return lines[i].high - lines[i - 1].low; };  // of the two in one
    for (std::size_t i = 2; i < lines.size(); ++i)
      if (width(i) < width(closest)) closest = i;
    lines[closest - 1].high = lines[closest].high;
    lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(closest));
  }
  return lines;
}

std::vector<double> lines_between(const std::vector<Gathered>& lines) {
  std::vector<double> between;
  for (std::size_t i = 1; i < lines.size(); ++i) between.push_back(0.5 * (lines[i - 1].high + lines[i].low));
  return between;
}

int line_of(double value, const std::vector<double>& between) {
  return static_cast<int>(std::upper_bound(between.begin(), between.end(), value) - between.begin());
}

}  // namespace

LocationGrid location_grid(std::span<const Eigen::Vector2d> places, int most_lines) {
  std::vector<double> x, y;
  for (const Eigen::Vector2d& place : places) x.push_back(place.x()), y.push_back(place.y());
  LocationGrid grid;
  grid.x_lines = lines_between(gather(x, most_lines));
  grid.y_lines = lines_between(gather(y, most_lines));
  for (const Eigen::Vector2d& place : places) {
    grid.column.push_back(line_of(place.x(), grid.x_lines));
    grid.row.push_back(line_of(place.y(), grid.y_lines));
  }
  return grid;
}

}  // namespace stillcut
