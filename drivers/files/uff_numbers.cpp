#include "drivers/files/uff_numbers.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace stillcut {
namespace {

constexpr std::string_view kUffBlanks = " \t\r";

bool add_between_blanks(std::string_view line, std::vector<double>& numbers) {
  const std::size_t before = numbers.size();
  for (std::string_view rest = uff_bare(line); !rest.empty();) {
    const auto end = std::min(rest.find_first_of(kUffBlanks), rest.size());
    const std::optional<double> value = fortran_number(rest.substr(0, end));
    if (!value) {
      numbers.resize(before);
      return false;
    }
    numbers.push_back(*value);
    rest = uff_bare(rest.substr(end));
  }
  return true;
}

}  // namespace

std::string_view uff_bare(std::string_view text) {
  const auto first = text.find_first_not_of(kUffBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kUffBlanks) + 1 - first);
}

std::optional<double> fortran_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  std::string digits;
  for (const char c : text) {
    const bool exponent = c == 'E' || c == 'e' || c == 'D' || c == 'd', sign = c == '+' || c == '-';
    if (exponent || (sign && !digits.empty() && digits.back() != 'e')) digits += 'e';
    if (!exponent) digits += c;
  }
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value)) return {};
  return value;
}

std::string add_uff_numbers(std::string_view line, std::span<const std::size_t> widths, std::vector<double>& numbers) {
  if (add_between_blanks(line, numbers)) return {};
  for (std::size_t k = 0; !uff_bare(line).empty(); ++k) {
    const std::size_t width = std::min(widths[k % widths.size()], line.size());
    const std::string_view text = uff_bare(line.substr(0, width));
    const std::optional<double> value = fortran_number(text);
    if (!value) return std::string(text.empty() ? "blanks" : text);
    numbers.push_back(*value);
    line.remove_prefix(width);
  }
  return {};
}

}  // namespace stillcut
