// Which words of G-code leave the tool's way as written, and why the others are refused.
#pragma once

#include <string>
#include <string_view>

namespace stillcut {

// G and M codes in tenths, as some have a decimal: G61.1 is 611.
bool gcode_changes_nothing(int tenths);
bool mcode_changes_nothing(int code);

// What to tell of a word that is refused, after "G28: ".
std::string_view why_gcode_is_refused(int tenths);
std::string_view why_mcode_is_refused(int code);
std::string_view why_letter_is_refused(char letter);

// Codes of one group exclude each other within a line; 0: of no group.
int gcode_group(int tenths);

}  // namespace stillcut
