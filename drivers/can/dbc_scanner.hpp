// Reads the pieces of one DBC statement (words, numbers, quoted text, punctuation) from left to right; what does not
// fit is an InputError that names file and line.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace stillcut {

class DbcScanner {
 public:
  // `statement` outlives the scanner. `line` is the line the statement begins in.
  DbcScanner(std::string_view statement, const std::string& file, int line)
      : rest_(statement), file_(file), line_(line) {}

  [[nodiscard]] bool at_end();
  [[nodiscard]] bool next_is(char c);
  [[nodiscard]] bool next_is_digit();
  bool accept(char c);  // takes the character if it comes next
  void expect(char c);
  std::string_view word(const char* what);  // letters, digits and '_'
  std::int64_t integer(const char* what);
  double number(const char* what);
  std::string quoted(const char* what);  // without the quotes; \" stands for a quote

  [[noreturn]] void fail(const std::string& message) const;

 private:
  void skip_spaces();
  std::string_view rest_;
  const std::string& file_;
  int line_;
};

}  // namespace stillcut
