// One line of G-code (RS-274) cut into words: a letter and a number each. What the words mean is in gcode_file.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace stillcut {

struct GcodeWord {
  char letter = 'G';  // upper case
  double value = 0.0;
  std::string_view number;  // as written, within the line
};

// Fills `words`; comments in ( ) and after ; are dropped, and so is the / of block delete. Throws InputError: a comment
// left open, a number that is none or above 10^10, a character that begins no word, variables and expressions, O-words,
// more than a hundred words.
void read_gcode_words(std::string_view line, const std::string& file, int line_number, std::vector<GcodeWord>& words);

}  // namespace stillcut
