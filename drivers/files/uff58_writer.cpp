// write_uff of uff58_file.hpp.
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "drivers/files/uff58_file.hpp"

namespace stillcut {
namespace {

constexpr std::size_t kIdLength = 80;

// printf into a line of text; what does not fit its columns is refused, so that no reader meets shifted ones.
template <class... Values>
std::string columns(std::size_t width, const char* format, Values... values) {
  std::array<char, 128> text{};
  const int length = std::snprintf(text.data(), text.size(), format, values...);
  if (length != static_cast<int>(width))
    throw std::invalid_argument("a number or a name is too long for a universal file");
  return text.data();
}

std::string short_number(double value) { return columns(13, "%13.5E", value); }
std::string long_number(double value) { return columns(20, "%20.12E", value); }

double as_short(double value) { return std::strtod(short_number(value).c_str(), nullptr); }

void check_text(const std::string& text, std::size_t longest) {
  if (text.size() > longest || text.find_first_of("\r\n") != std::string::npos)
    throw std::invalid_argument("a text is too long for a universal file, or has a line break");
}

void check_function(const UffFunction& function) {
  if (function.values.empty() || function.abscissa.size() != function.values.size())
    throw std::invalid_argument("a function needs values, and an abscissa for each");
  for (std::size_t i = 0; i < function.values.size(); ++i) {
    if (!std::isfinite(function.abscissa[i]) || !std::isfinite(function.values[i].real()) ||
        !std::isfinite(function.values[i].imag()))
      throw std::invalid_argument("a universal file holds finite numbers only");
    if (!function.complex && function.values[i].imag() != 0.0)
      throw std::invalid_argument("a real function has a value with an imaginary part");
  }
  for (const std::string& text : function.id) check_text(text, kIdLength);
}

// Step that gives the whole abscissa from its begin, in the digits that the header has; 0: there is none.
double even_step(const std::vector<double>& abscissa) {
  if (abscissa.size() < 2 || as_short(abscissa[0]) != abscissa[0]) return 0.0;
  const double step = as_short(abscissa[1] - abscissa[0]);
  for (std::size_t i = 0; i < abscissa.size(); ++i)
    if (abscissa[0] + static_cast<double>(i) * step != abscissa[i]) return 0.0;
  return step;
}

std::string axis_line(const UffAxis& axis) {
  check_text(axis.label, 20);
  check_text(axis.units, 20);
  return columns(67, "%10d%5d%5d%5d %-20s %-20s", axis.data_type, 0, 0, 0,
                 axis.label.empty() ? "NONE" : axis.label.c_str(), axis.units.empty() ? "NONE" : axis.units.c_str()) +
         "\n";
}

void put_bits(std::string& bytes, std::uint64_t bits, int size) {
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(bits >> (8 * i) & 0xFF);  // the lowest byte first
}

void put_number(std::string& bytes, double value, bool double_precision) {
  if (double_precision)
    put_bits(bytes, std::bit_cast<std::uint64_t>(value), 8);
  else
    put_bits(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4);
}

std::string binary_data(const UffFunction& function, bool even) {
  std::string bytes;
  for (std::size_t i = 0; i < function.values.size(); ++i) {
    if (!even) put_number(bytes, function.abscissa[i], function.double_precision);
    put_number(bytes, function.values[i].real(), function.double_precision);
    if (function.complex) put_number(bytes, function.values[i].imag(), function.double_precision);
  }
  return bytes;
}

std::string text_data(const UffFunction& function, bool even) {
  // As many numbers in a line as the format of each kind has.
  const int in_line = function.double_precision ? (!even && function.complex ? 3 : 4) : 6;
  std::string text;
  int in_this = 0;
  const auto add = [&](const std::string& number) {
    text += number;
    if (++in_this == in_line) text += "\n", in_this = 0;
  };
  const auto value_text = function.double_precision ? long_number : short_number;
  for (std::size_t i = 0; i < function.values.size(); ++i) {
    if (!even) add(short_number(function.abscissa[i]));
    add(value_text(function.values[i].real()));
    if (function.complex) add(value_text(function.values[i].imag()));
  }
  return in_this > 0 ? text + "\n" : text;
}

std::string function_text(const UffFunction& function, UffForm form) {
  check_function(function);
  const double step = even_step(function.abscissa);
  const bool even = step > 0.0;
  const std::string data = form == UffForm::binary ? binary_data(function, even) : text_data(function, even);
  std::string text = "    -1\n    58";
  if (form == UffForm::binary) text += columns(73, "b%6d%6d%12d%12zu%6d%6d%12d%12d", 1, 2, 11, data.size(), 0, 0, 0, 0);
  text += "\n";
  for (const std::string& id : function.id) text += (id.empty() ? "NONE" : id) + "\n";
  text +=
      columns(80, "%5d%10d%5d%10d %-10s%10d%4d %-10s%10d%4d", function.type, 0, 0, 0, "NONE", function.response_node,
              function.response_direction, "NONE", function.reference_node, function.reference_direction) +
      "\n";
  const int data_type = (function.complex ? 5 : 2) + (function.double_precision ? (function.complex ? 1 : 2) : 0);
  text += columns(30, "%10d%10zu%10d", data_type, function.values.size(), even ? 1 : 0) +
          short_number(even ? function.abscissa[0] : 0.0) + short_number(step) + short_number(0.0) + "\n";
  for (const UffAxis& axis : {function.abscissa_axis, function.ordinate, function.denominator, UffAxis{}})
    text += axis_line(axis);
  return text + data + "    -1\n";
}

}  // namespace

void write_uff(std::ostream& out, const UffFile& content, UffForm form) {
  if (content.units) {
    const UffUnits& units = *content.units;
    check_text(units.description, 20);
    out << "    -1\n   164\n"
        << columns(40, "%10d%-20s%10d", units.code, units.description.c_str(), 2) << "\n"
        << columns(75, "%25.17E%25.17E%25.17E", units.length, units.force, 1.0) << "\n"
        << columns(25, "%25.17E", 0.0) << "\n    -1\n";
  }
  for (const UffFunction& function : content.functions) out << function_text(function, form);
}

}  // namespace stillcut
