#include "drivers/files/gcode_words.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>

#include "drivers/files/input_error.hpp"
#include "drivers/files/path_builder.hpp"

namespace stillcut {
namespace {

constexpr double kLargestNumber = 1e10;  // beyond it an arc's points lose the micrometre to rounding
constexpr std::size_t kMostWords = 100;  // of one line; files that are no programs have more than memory
constexpr std::string_view kDigits = "0123456789";
constexpr std::string_view kGcodeBlanks = " \t\r";
constexpr std::string_view kNumberParts = "0123456789.+-";

class WordCutter {
 public:
  WordCutter(std::string_view rest, const std::string& file, int line) : rest_(rest), file_(file), line_(line) {}

  void cut(std::vector<GcodeWord>& words) {
    words.clear();
    skip_blanks_and_comments();
    skip_block_delete();
    for (skip_blanks_and_comments(); !rest_.empty(); skip_blanks_and_comments()) {
      if (words.size() == kMostWords) fail("more than 100 words in one line; is it G-code?");
      words.push_back(word());
    }
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InputError(file_, line_, message); }

  void skip(std::string_view characters) {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(characters), rest_.size()));
  }

  void skip_blanks_and_comments() {
    for (skip(kGcodeBlanks); !rest_.empty(); skip(kGcodeBlanks)) {
      if (rest_.front() == ';') rest_ = {};
      if (!rest_.starts_with('(')) return;
      const auto end = rest_.find(')');
      if (end == std::string_view::npos) fail("a comment is not closed; add ')'");
      rest_.remove_prefix(end + 1);
    }
  }

  // Fanuc numbers the switches of block delete: /2 N10 G1.
  void skip_block_delete() {
    if (!rest_.starts_with('/')) return;
    rest_.remove_prefix(1);
    if (!rest_.empty() && rest_.front() >= '1' && rest_.front() <= '9') rest_.remove_prefix(1);
  }

  void refuse_expression() const {
    if (!rest_.empty() && std::string_view("#[<").find(rest_.front()) != std::string_view::npos)
      fail("variables and expressions (#, [ ], < >) are not evaluated; post the program with plain numbers");
  }

  GcodeWord word() {
    refuse_expression();
    char letter = rest_.front();
    if (letter >= 'a' && letter <= 'z') letter = static_cast<char>(letter - 'a' + 'A');
    if (kNumberParts.find(letter) != std::string_view::npos)
      fail("the number " + quoted_word(rest_.substr(0, rest_.find_first_not_of(kNumberParts))) +
           " has no letter; write it right behind its letter");
    if (letter < 'A' || letter > 'Z')
      fail(std::string("'") + letter + "' begins no word of G-code; remove it or put it in a comment ( )");
    rest_.remove_prefix(1);
    skip(kGcodeBlanks);
    if (letter == 'O') refuse_flow_control();
    refuse_expression();
    return number(letter);
  }

  // "O1001" alone is a program's number; "o100 sub", "o<name> call" are LinuxCNC's subprograms and loops.
  void refuse_flow_control() const {
    std::string_view after = rest_;
    after.remove_prefix(std::min(after.find_first_not_of(kDigits), after.size()));
    after.remove_prefix(std::min(after.find_first_not_of(kGcodeBlanks), after.size()));
    if (after.size() == rest_.size() || (!after.empty() && after.front() != '(' && after.front() != ';'))
      fail("O: subprograms and loops are not followed; post the program without them");
  }

  GcodeWord number(char letter) {
    const std::string_view text = rest_.substr(0, rest_.find_first_not_of(kNumberParts));
    if (text.empty())
      fail(std::string(1, letter) + " is followed by no number; write one, or put the text in a comment ( )");
    const bool plus = text.size() > 1 && text[0] == '+' && text[1] != '-';
    const char* const last = text.data() + text.size();
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data() + (plus ? 1 : 0), last, value, std::chars_format::fixed);
    if (end != last || (error != std::errc{} && error != std::errc::result_out_of_range))
      fail(letter + quoted_word(text) + ": is no number; write digits with one point, such as 12.5");
    if (error != std::errc{} || value > kLargestNumber || value < -kLargestNumber)
      fail(letter + quoted_word(text) + ": is too large or too small; check the number");
    rest_.remove_prefix(text.size());
    return {letter, value, text};
  }

  std::string_view rest_;
  const std::string& file_;
  int line_;
};

}  // namespace

void read_gcode_words(std::string_view line, const std::string& file, int line_number, std::vector<GcodeWord>& words) {
  WordCutter(line, file, line_number).cut(words);
}

}  // namespace stillcut
