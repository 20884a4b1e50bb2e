#include "drivers/can/signal_reference.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <numeric>

#include "drivers/files/input_error.hpp"
#include "rt/signals.hpp"

namespace stillcut {
namespace {

// Levenshtein's distance, letters compared without case.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  const auto same = [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
  };
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (same(a[i - 1], b[j - 1]) ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

// "there are: A, B, C": the three names nearest to `wanted`.
template <class Items>
std::string nearest(const std::string& wanted, const Items& items) {
  std::vector<std::string> names;
  names.reserve(items.size());
  for (const auto& item : items) names.push_back(item.name);
  if (names.empty()) return "it has none";
  std::stable_sort(names.begin(), names.end(), [&wanted](const std::string& a, const std::string& b) {
    return edit_distance(a, wanted) < edit_distance(b, wanted);
  });
  std::string text = names.size() > 3 ? "nearest are " : "there is ";
  for (std::size_t i = 0; i < std::min<std::size_t>(names.size(), 3); ++i) text += (i > 0 ? ", " : "") + names[i];
  return text;
}

bool parse_number(std::string_view text, int& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && value >= 0;
}

// "X{0..9}" to X0 ... X9; a name without braces to itself.
std::vector<std::string> expand(const std::string& pattern, const std::string& reference, const CellKey& where) {
  const std::size_t open = pattern.find('{');
  if (open == std::string::npos) return {pattern};
  const std::size_t dots = pattern.find("..", open), close = pattern.find('}', open);
  int first = 0, last = 0;
  if (dots == std::string::npos || close == std::string::npos || dots > close ||
      !parse_number(std::string_view(pattern).substr(open + 1, dots - open - 1), first) ||
      !parse_number(std::string_view(pattern).substr(dots + 2, close - dots - 2), last)) {
    throw InputError(where.file, where.line,
                     where.key + ": '" + reference + "' is not of the form Message.Signal{first..last}");
  }
  if (first > last) {
    throw InputError(
        where.file, where.line,
        where.key + ": '" + reference + "' counts down; write the oldest sample first, {a..b} with a <= b");
  }
  if (last - first >= kMaxSamplesPerBlock) {
    throw InputError(where.file, where.line,
                     where.key + ": '" + reference + "' names " + std::to_string(last - first + 1LL) +
                         " samples; a CAN FD frame holds at most " + std::to_string(kMaxSamplesPerBlock));
  }
  std::vector<std::string> names;
  for (int i = first; i <= last; ++i) {
    names.push_back(pattern.substr(0, open) + std::to_string(i) + pattern.substr(close + 1));
  }
  return names;
}

[[noreturn]] void fail_without_signal(const Dbc& dbc, const DbcMessage& message, const std::string& name,
                                      const CellKey& where) {
  throw InputError(where.file, where.line,
                   where.key + ": message '" + message.name + "' of " + dbc.file + " has no signal '" + name + "'; " +
                       nearest(name, message.signals));
}

}  // namespace

SignalReference find_signals(const Dbc& dbc, const std::string& reference, const CellKey& where) {
  const std::size_t dot = reference.find('.');
  if (dot == std::string::npos || dot == 0 || dot + 1 == reference.size()) {
    throw InputError(where.file, where.line, where.key + ": '" + reference + "' is not of the form Message.Signal");
  }
  const std::string message_name = reference.substr(0, dot);
  SignalReference found;
  found.message = dbc.find(message_name);
  if (found.message == nullptr) {
    throw InputError(
        where.file, where.line,
        where.key + ": " + dbc.file + " has no message '" + message_name + "'; " + nearest(message_name, dbc.messages));
  }
  for (const std::string& name : expand(reference.substr(dot + 1), reference, where)) {
    found.signals.push_back(found.message->find(name));
    if (found.signals.back() == nullptr) fail_without_signal(dbc, *found.message, name, where);
  }
  return found;
}

}  // namespace stillcut
