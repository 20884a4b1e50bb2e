#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "drivers/files/csv.hpp"
#include "drivers/files/height_map_file.hpp"
#include "drivers/files/input_error.hpp"
#include "dsp/numbers.hpp"
#include "models/surface_profiles.hpp"

namespace stillcut {
namespace {

constexpr double kOffGrid = 0.05;       // of a spacing: coordinates are often rounded
constexpr double kSamePlace = 1e-3;     // of the widest gap
constexpr std::size_t kMostSparse = 4;  // places of the grid for a row

// m as mm, and back, by moving the decimal exponent: a product with 1000 would lose the last bit.
constexpr int kDecadesToMm = 3;

std::string mm_text(double metres) {
  char buffer[32];
  const auto written = std::to_chars(buffer, buffer + sizeof buffer, metres, std::chars_format::scientific);
  const std::string_view text(buffer, static_cast<std::size_t>(written.ptr - buffer));
  const auto e = text.find('e');
  int exponent = 0;
  const std::size_t digits_of_exponent = e + (text[e + 1] == '+' ? 2 : 1);
  std::from_chars(text.data() + digits_of_exponent, text.data() + text.size(), exponent);
  exponent += kDecadesToMm;
  std::string digits;
  for (const char c : text.substr(0, e))
    if (c != '.' && c != '-') digits += c;
  std::string result(text.starts_with('-') ? 1 : 0, '-');
  if (digits == "0") return result.append("0");
  if (exponent < -7 || exponent > 15)
    return std::string(text.substr(0, e)).append("e").append(std::to_string(exponent));
  if (exponent < 0) return result.append("0.").append(static_cast<std::size_t>(-exponent - 1), '0').append(digits);
  const auto whole = static_cast<std::size_t>(exponent) + 1;
  if (digits.size() <= whole) return result.append(digits).append(whole - digits.size(), '0');
  return result.append(digits, 0, whole).append(".").append(digits, whole);
}

double metres(const CsvTable& table, const CsvRow& row, std::size_t column) {
  (void)table.number(row, column);  // refuses what is none
  std::string text = table.text(row, column);
  if (text.starts_with('+')) text.erase(0, 1);
  const auto e = text.find_first_of("eE");
  int exponent = 0;
  if (e != std::string::npos) {
    const std::size_t digits = e + (text[e + 1] == '+' ? 2 : 1);
    std::from_chars(text.data() + digits, text.data() + text.size(), exponent);
    text.erase(e);
  }
  text.append("e").append(std::to_string(static_cast<long>(exponent) - kDecadesToMm));
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size())
    table.fail(row, column, "\"" + table.text(row, column) + "\" is out of range");
  return value;
}

double height_of(const CsvTable& table, const CsvRow& row, std::size_t column) {
  const std::string text = table.text(row, column);
  const bool unknown = text.empty() || text == "nan" || text == "NaN" || text == "NAN";
  return unknown ? kNaN : metres(table, row, column);
}

// Equally spaced places in one direction.
struct PlaceAxis {
  double first = 0.0, spacing = 0.0;
  std::size_t count = 0;

  [[nodiscard]] std::size_t nearest(double place) const {
    const double last = static_cast<double>(count - 1), steps = std::round((place - first) / spacing);
    return static_cast<std::size_t>(std::max(0.0, std::min(last, steps)));
  }
  [[nodiscard]] bool holds(double place) const {
    return std::abs(first + static_cast<double>(nearest(place)) * spacing - place) <= kOffGrid * spacing;
  }
};

// Each place of a column once, rising, those that differ by rounding as one.
std::vector<double> distinct_places(std::vector<double> places) {
  std::sort(places.begin(), places.end());
  double widest = 0.0;
  for (std::size_t k = 1; k < places.size(); ++k) widest = std::max(widest, places[k] - places[k - 1]);
  const auto same = [&](double a, double b) { return b - a <= kSamePlace * widest; };
  places.erase(std::unique(places.begin(), places.end(), same), places.end());
  return places;
}

// Of `count` places from the first to the last; exactly what was written where it was written from a grid.
PlaceAxis axis_of(const std::vector<double>& places, std::size_t count) {
  PlaceAxis axis{places.front(), (places.back() - places.front()) / static_cast<double>(count - 1), count};
  const double written = places[1] - places[0];
  for (std::size_t k = 0; k < places.size(); ++k)
    if (places[k] != axis.first + static_cast<double>(k) * written) return axis;
  if (places.size() == count) axis.spacing = written;
  return axis;
}

PlaceAxis recovered_axis(const CsvTable& table, std::size_t column, const std::vector<double>& of_rows) {
  const std::vector<double> places = distinct_places(of_rows);
  const std::string& name = table.header()[column];
  if (places.size() < 2)
    throw InputError(table.file(), 0, name + ": has fewer than two places; give the points of a grid");
  const auto all_on = [&](const PlaceAxis& axis) {
    return std::all_of(places.begin(), places.end(), [&](double place) { return axis.holds(place); });
  };
  PlaceAxis axis = axis_of(places, places.size());
  if (all_on(axis)) return axis;
  double narrowest = kInfinity;  // some places may have no row at all
  for (std::size_t k = 1; k < places.size(); ++k) narrowest = std::min(narrowest, places[k] - places[k - 1]);
  const double steps = std::round((places.back() - places.front()) / narrowest);
  if (steps < static_cast<double>(kMostSparse * of_rows.size())) {
    axis = axis_of(places, static_cast<std::size_t>(steps) + 1);
    if (all_on(axis)) return axis;
  }
  for (std::size_t r = 0; r < of_rows.size(); ++r)
    if (!axis.holds(of_rows[r]))
      table.fail(table.rows()[r], column, "lies off the grid of the others; give equally spaced points");
  throw InputError(table.file(), 0, name + ": is not equally spaced; give the points of a grid");
}

}  // namespace

HeightMap parse_height_map_csv(std::string_view text, const std::string& file) {
  const CsvTable table = parse_csv(text, file);
  check_column_names(table, std::vector<std::string>{"x_mm", "y_mm", "z_mm"});
  const std::size_t x = table.require_column("x_mm"), y = table.require_column("y_mm");
  const std::size_t z = table.require_column("z_mm");
  std::vector<double> xs, ys;
  for (const CsvRow& row : table.rows()) {
    xs.push_back(metres(table, row, x));
    ys.push_back(metres(table, row, y));
  }
  if (xs.empty()) throw InputError(file, 0, "has no row; give the points of a grid");
  const PlaceAxis along = recovered_axis(table, x, xs), across = recovered_axis(table, y, ys);
  if (across.count > kMostSparse * xs.size() / along.count)
    throw InputError(file, 0, "has a row for less than a quarter of its grid; give every point a row");
  HeightMap map{along.count, across.count, along.spacing, across.spacing,
                std::vector<double>(along.count * across.count, kNaN)};
  std::vector<char> taken(map.heights.size(), 0);
  for (std::size_t r = 0; r < xs.size(); ++r) {
    const std::size_t i = along.nearest(xs[r]), j = across.nearest(ys[r]);
    if (taken[j * map.along + i] != 0) table.fail(table.rows()[r], x, "this place stands twice; leave one out");
    taken[j * map.along + i] = 1;
    map.at(i, j) = height_of(table, table.rows()[r], z);
  }
  return map;
}

void write_height_map_csv(std::ostream& out, const HeightMap& map) {
  require_sound_map(map);
  if (map.along < 2 || map.across < 2) throw std::invalid_argument("a surface needs two points in each direction");
  out << "x_mm,y_mm,z_mm\n";
  std::vector<std::string> xs(map.along);
  for (std::size_t i = 0; i < map.along; ++i) xs[i] = mm_text(static_cast<double>(i) * map.spacing_along);
  for (std::size_t j = 0; j < map.across; ++j) {
    const std::string y = mm_text(static_cast<double>(j) * map.spacing_across);
    for (std::size_t i = 0; i < map.along; ++i) {
      const double height = map.at(i, j);
      out << xs[i] << ',' << y << ',' << (std::isnan(height) ? "" : mm_text(height)) << '\n';
    }
  }
}

}  // namespace stillcut
