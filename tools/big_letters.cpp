#include "tools/big_letters.hpp"

#include <cstdint>

namespace stillcut {
namespace {

constexpr int kLetterColumns = 3, kLetterDots = 5;  // a dot is half a row high

// A to Z, five octal digits from top to bottom, a bit a dot: 4 is the left one.
constexpr std::array<std::uint16_t, 26> kLetters{025755, 065656, 034443, 065556, 074647, 074644, 034553, 055755, 072227,
                                                 011152, 055655, 044447, 057755, 065555, 025552, 065644, 025573, 065655,
                                                 034216, 072222, 055557, 055552, 055775, 055255, 055222, 071247};

std::uint16_t letter_dots(char letter) noexcept {
  if (letter >= 'a' && letter <= 'z') return kLetters[static_cast<std::size_t>(letter - 'a')];
  if (letter >= 'A' && letter <= 'Z') return kLetters[static_cast<std::size_t>(letter - 'A')];
  return 0;
}

bool has_dot(std::uint16_t dots, int down, int across) noexcept {
  if (down >= kLetterDots) return false;
  return (dots >> (3 * (kLetterDots - 1 - down) + kLetterColumns - 1 - across) & 1) != 0;
}

}  // namespace

int big_width(std::string_view word) noexcept { return static_cast<int>(word.size()) * (kLetterColumns + 1); }

std::array<std::string, kBigRows> big_letters(std::string_view word) {
  std::array<std::string, kBigRows> rows;
  for (int row = 0; row < kBigRows; ++row) {
    std::string& line = rows[static_cast<std::size_t>(row)];
    for (const char letter : word) {
      const std::uint16_t dots = letter_dots(letter);
      for (int across = 0; across < kLetterColumns; ++across) {
        const bool upper = has_dot(dots, 2 * row, across), lower = has_dot(dots, 2 * row + 1, across);
        line += upper && lower ? "█" : upper ? "▀" : lower ? "▄" : " ";
      }
      line += ' ';
    }
  }
  return rows;
}

}  // namespace stillcut
