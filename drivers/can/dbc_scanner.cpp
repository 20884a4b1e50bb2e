#include "drivers/can/dbc_scanner.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

bool is_word_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

}  // namespace

void DbcScanner::skip_spaces() {
  const std::size_t n = rest_.find_first_not_of(" \t\r\n");
  rest_.remove_prefix(n == std::string_view::npos ? rest_.size() : n);
}

void DbcScanner::fail(const std::string& message) const { throw InputError(file_, line_, message); }

bool DbcScanner::at_end() {
  skip_spaces();
  return rest_.empty();
}

bool DbcScanner::next_is(char c) {
  skip_spaces();
  return !rest_.empty() && rest_.front() == c;
}

bool DbcScanner::next_is_digit() {
  skip_spaces();
  return !rest_.empty() && rest_.front() >= '0' && rest_.front() <= '9';
}

bool DbcScanner::accept(char c) {
  if (!next_is(c)) return false;
  rest_.remove_prefix(1);
  return true;
}

void DbcScanner::expect(char c) {
  if (accept(c)) return;
  std::string message{'\'', c, '\''};
  message.append(" expected before ");
  if (rest_.empty()) fail(message.append("the end of the line"));
  fail(message.append("'").append(rest_.substr(0, std::min<std::size_t>(20, rest_.find_first_of("\r\n")))).append("'"));
}

std::string_view DbcScanner::word(const char* what) {
  skip_spaces();
  std::size_t n = 0;
  while (n < rest_.size() && is_word_character(rest_[n])) ++n;
  if (n == 0) fail(std::string(what) + " expected");
  const std::string_view result = rest_.substr(0, n);
  rest_.remove_prefix(n);
  return result;
}

std::int64_t DbcScanner::integer(const char* what) {
  skip_spaces();
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
  if (error != std::errc()) fail(std::string("whole number expected: ") + what);
  rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
  return value;
}

double DbcScanner::number(const char* what) {
  accept('+');  // from_chars knows no plus sign
  double value = 0.0;
  const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
  if (error != std::errc() || !std::isfinite(value)) fail(std::string("number expected: ") + what);
  rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
  return value;
}

std::string DbcScanner::quoted(const char* what) {
  if (!accept('"')) fail(std::string(what) + " expected, in double quotes");
  std::string text;
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    if (rest_[i] == '"') {
      rest_.remove_prefix(i + 1);
      return text;
    }
    if (rest_[i] == '\\' && i + 1 < rest_.size() && rest_[i + 1] == '"') ++i;
    text.push_back(rest_[i]);
  }
  fail(std::string(what) + ": the closing quote is missing");
}

}  // namespace stillcut
