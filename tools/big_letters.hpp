// A word in letters three rows high, to be read from a few metres.
#pragma once

#include <array>
#include <string>
#include <string_view>

namespace stillcut {

inline constexpr int kBigRows = 3;

int big_width(std::string_view word) noexcept;  // columns

// The three rows, as wide as big_width. Letters, small or capital, and blanks; others are blank.
std::array<std::string, kBigRows> big_letters(std::string_view word);

}  // namespace stillcut
