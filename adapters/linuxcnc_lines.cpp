#include "adapters/linuxcnc_lines.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace stillcut {
namespace {

constexpr std::size_t kMostValues = 64;
constexpr std::string_view kBlanks = " \t\r\n";

std::string_view next_word(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
  text.remove_prefix(word.size());
  return word;
}

}  // namespace

CncReply reply_to(std::string_view command, std::string_view line) {
  const std::string_view verb = next_word(command), what = next_word(command);
  const std::string_view first = next_word(line), second = next_word(line), third = next_word(line);
  const auto verdict = [](std::string_view word) {
    return word == "ACK" ? CncReply::done : word == "NAK" ? CncReply::refused : CncReply::none;
  };
  if (first == "error:") return CncReply::refused;
  if (verb == "HELLO") return first == "HELLO" ? verdict(second) : CncReply::none;
  if (first == verb && second == what) return verdict(third);
  if (first == verb && second == "NAK") return CncReply::refused;
  return verb == "GET" && first == what && !second.empty() ? CncReply::done : CncReply::none;
}

std::vector<std::string_view> values_of(std::string_view line) {
  std::vector<std::string_view> values;
  next_word(line);
  for (std::string_view word = next_word(line); !word.empty() && values.size() < kMostValues; word = next_word(line))
    values.push_back(word);
  return values;
}

std::optional<double> cnc_number(std::string_view text) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(number)) return std::nullopt;
  return number;
}

std::optional<std::array<double, 6>> cnc_places(std::string_view line) {
  std::array<double, 6> places{};
  const auto values = values_of(line);
  if (values.empty()) return std::nullopt;
  for (std::size_t i = 0; i < std::min(values.size(), places.size()); ++i) {
    const auto number = cnc_number(values[i]);
    if (!number) return std::nullopt;
    places[i] = *number;
  }
  return places;
}

std::optional<double> programmed_speed_rpm(std::string_view line) {
  for (const std::string_view code : values_of(line)) {
    if (code.size() < 2 || code.front() != 'S') continue;
    const auto speed = cnc_number(code.substr(1));
    if (speed && *speed >= 0.0) return speed;
  }
  return std::nullopt;
}

}  // namespace stillcut
