// Lines of text for a terminal, each a row of pieces that say what they mean; what colour that is, and whether there
// are colours, is the terminal's. Every character takes one column: foreign text goes through printable() first.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace stillcut {

enum class Ink : std::uint8_t { plain, strong, faint, good, caution, alarm, doubt, advice };

struct TextPiece {
  Ink ink = Ink::plain;
  std::string text;  // UTF-8
};
using TextLine = std::vector<TextPiece>;

int width_of(std::string_view text) noexcept;  // columns
int width_of(const TextLine& line) noexcept;
std::string text_of(const TextLine& line);

// Control characters, broken UTF-8 and characters that may not take one column become '?'.
std::string printable(std::string_view text);

// At most so wide; "…" stands where something was cut off. width 0: nothing.
std::string clipped(std::string_view text, int width);
TextLine clipped(const TextLine& line, int width);
std::string padded(std::string_view text, int width);  // clipped, or filled with blanks

// Whole words as far as they go; at most `most` lines, the last with "…" where there is more.
std::vector<std::string> wrapped(std::string_view text, int width, std::size_t most);
// As many lines as it takes, those after the first `indent` columns in; only a word longer than a line is cut.
std::vector<TextLine> wrapped(const TextLine& line, int width, int indent);

// As printf writes it.
std::string printf_text(const char* format, ...) __attribute__((format(printf, 1, 2)));

// Every character that is not ASCII by one that looks like it.
std::string ascii(std::string_view text);

}  // namespace stillcut
