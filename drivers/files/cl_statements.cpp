#include "drivers/files/cl_statements.hpp"

#include <algorithm>
#include <array>

#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

constexpr std::array<std::string_view, 5> kTextWords{"PARTNO", "PPRINT", "REMARK", "TPRINT", "INSERT"};
constexpr int kMostContinuations = 100;
constexpr std::size_t kMostItems = 1000;  // files that are no paths have more than memory

std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const auto first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) + 1 - first);
}

std::string upper_case(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  return result;
}

std::string_view cut_line(std::string_view& text, int& line) {
  ++line;
  const auto end = std::min(text.find('\n'), text.size());
  const std::string_view cut = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return cut;
}

std::string_view text_word(std::string_view line) {
  const std::string head = upper_case(line.substr(0, 6));
  const auto* const found = std::find(kTextWords.begin(), kTextWords.end(), head);
  return found == kTextWords.end() ? std::string_view{} : *found;
}

// The line without its comment; true when it goes on in the next line.
bool take_part(std::string_view line, std::string& whole) {
  const auto dollar = line.find('$');
  whole += line.substr(0, dollar);
  return dollar != std::string_view::npos && !line.substr(dollar).starts_with("$$");
}

}  // namespace

bool next_cl_statement(std::string_view& text, const std::string& file, int& line, ClStatement& statement) {
  while (!text.empty()) {
    const std::string_view first = without_blanks(cut_line(text, line));
    statement.line = line;
    statement.items.clear();
    if (const std::string_view word = text_word(first); !word.empty()) {
      statement.word = word;
      statement.items.emplace_back(without_blanks(first.substr(word.size())));
      return true;
    }
    std::string whole;
    for (bool goes_on = take_part(first, whole); goes_on; goes_on = take_part(cut_line(text, line), whole)) {
      if (text.empty()) throw InputError(file, line, "the file ends where $ announces a further line; is it complete?");
      if (line - statement.line >= kMostContinuations)
        throw InputError(file, statement.line, "more than 100 lines in one statement; is it a cutter location file?");
    }
    const auto slash = std::min(whole.find('/'), whole.size());
    statement.word = upper_case(without_blanks(std::string_view(whole).substr(0, slash)));
    if (slash == whole.size()) {
      if (statement.word.empty()) continue;
      return true;
    }
    for (std::string_view rest = std::string_view(whole).substr(slash + 1);;) {
      const auto comma = std::min(rest.find(','), rest.size());
      if (statement.items.size() == kMostItems)
        throw InputError(file, statement.line, "more than 1000 items in one statement; is it a cutter location file?");
      statement.items.push_back(upper_case(without_blanks(rest.substr(0, comma))));
      if (comma == rest.size()) return true;
      rest.remove_prefix(comma + 1);
    }
  }
  return false;
}

}  // namespace stillcut
