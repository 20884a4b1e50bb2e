#include "tools/styled_text.hpp"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <utility>

namespace stillcut {
namespace {

struct Character {
  char32_t code = 0;     // 0: the bytes are no UTF-8
  std::size_t size = 1;  // bytes
};

// The first character of a text that is not empty.
Character first_character(std::string_view text) noexcept {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  const std::size_t size = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < size) return {};
  char32_t code = lead & (0x7FU >> size);
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) return {};
    code = code << 6 | (byte(i) & 0x3FU);
  }
  constexpr std::array<char32_t, 5> kLeast{0, 0, 0x80, 0x800, 0x10000};
  return code >= kLeast[size] ? Character{code, size} : Character{};
}

// Latin, Greek, punctuation, arrows and mathematical signs: one column each in every terminal.
bool takes_one_column(char32_t code) noexcept {
  constexpr std::array<std::pair<char32_t, char32_t>, 8> kRanges{{{0x20, 0x7E},
                                                                  {0xA0, 0xAC},
                                                                  {0xAE, 0x24F},
                                                                  {0x391, 0x3C9},
                                                                  {0x2010, 0x2027},
                                                                  {0x2190, 0x2193},
                                                                  {0x2200, 0x22FF},
                                                                  {0x2580, 0x2593}}};
  return std::any_of(kRanges.begin(), kRanges.end(),
                     [&](const auto& range) { return code >= range.first && code <= range.second; });
}

bool is_continuation(char byte) noexcept { return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U; }

// Bytes of the first `characters` characters.
std::size_t bytes_of(std::string_view text, int characters) noexcept {
  std::size_t at = 0;
  while (at < text.size() && (characters > 0 || is_continuation(text[at]))) {
    characters -= is_continuation(text[at]) ? 0 : 1;
    ++at;
  }
  while (at < text.size() && is_continuation(text[at])) ++at;
  return at;
}

}  // namespace

int width_of(std::string_view text) noexcept {
  return static_cast<int>(std::count_if(text.begin(), text.end(), [](char c) { return !is_continuation(c); }));
}

int width_of(const TextLine& line) noexcept {
  int width = 0;
  for (const TextPiece& piece : line) width += width_of(piece.text);
  return width;
}

std::string text_of(const TextLine& line) {
  std::string all;
  for (const TextPiece& piece : line) all += piece.text;
  return all;
}

std::string printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const Character character = first_character(text);
    if (takes_one_column(character.code))
      out += text.substr(0, character.size);
    else
      out += '?';
    text.remove_prefix(character.size);
  }
  return out;
}

std::string clipped(std::string_view text, int width) {
  if (width <= 0) return {};
  if (width_of(text) <= width) return std::string(text);
  return std::string(text.substr(0, bytes_of(text, width - 1))) + "…";
}

TextLine clipped(const TextLine& line, int width) {
  if (width_of(line) <= width) return line;
  TextLine out;
  int left = width;
  for (const TextPiece& piece : line) {
    if (left <= 0) break;
    const int wide = width_of(piece.text);
    // A full piece leaves no column for the "…" of those that follow.
    const bool last = wide >= left;
    out.push_back({piece.ink, last ? clipped(piece.text + " ", left) : piece.text});
    left -= wide;
  }
  return out;
}

std::string padded(std::string_view text, int width) {
  std::string out = clipped(text, width);
  out.append(static_cast<std::size_t>(std::max(0, width - width_of(out))), ' ');
  return out;
}

std::vector<std::string> wrapped(std::string_view text, int width, std::size_t most) {
  std::vector<std::string> lines;
  if (width <= 0 || most == 0) return lines;
  while (lines.size() + 1 < most && width_of(text) > width) {
    const std::size_t fits = bytes_of(text, width);
    std::size_t end = text.substr(0, fits + 1).rfind(' ');
    if (end == std::string_view::npos || end == 0) end = fits;
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(end);
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  }
  lines.push_back(clipped(text, width));
  return lines;
}

std::vector<TextLine> wrapped(const TextLine& line, int width, int indent) {
  std::vector<TextLine> lines(1);
  indent = std::clamp(width / 2, 0, indent);
  int used = 0;
  for (const TextPiece& piece : line) {
    std::string_view left = piece.text;
    while (!left.empty()) {
      const auto word = std::min(left.find(' '), left.size());
      const auto end = std::min(left.find_first_not_of(' ', word), left.size());
      const int wide = width_of(left.substr(0, word));
      if (used + wide > width && used > indent) {
        lines.push_back({{Ink::plain, std::string(static_cast<std::size_t>(indent), ' ')}});
        used = indent;
      }
      if (lines.back().empty() || lines.back().back().ink != piece.ink) lines.back().push_back({piece.ink, {}});
      lines.back().back().text += left.substr(0, end);
      used += width_of(left.substr(0, end));
      left.remove_prefix(end);
    }
  }
  for (TextLine& one : lines) {  // blanks at the end may stand out, and so may a long word
    while (!one.empty() && width_of(one) > width && one.back().text.ends_with(' ')) one.back().text.pop_back();
    one = clipped(one, width);
  }
  return lines;
}

std::string printf_text(const char* format, ...) {
  std::array<char, 512> text{};
  std::va_list values;
  va_start(values, format);
  std::vsnprintf(text.data(), text.size(), format, values);
  va_end(values);
  return text.data();
}

std::string ascii(std::string_view text) {
  constexpr std::u32string_view kFrom = U"▀▁▂▃▄▅▆▇█░▒▓…–—−·°±µ²³×→←↑↓ΩφζτπΔ≤≥⟨⟩‘’“”│─";
  constexpr std::string_view kTo = "^_..-=+*#:%&.---.o+u23x><^vOfztpD<>()''\"\"|-";
  static_assert(kFrom.size() == kTo.size());
  std::string out;
  while (!text.empty()) {
    const Character character = first_character(text);
    const auto at = kFrom.find(character.code);
    out += character.code < 0x80 && character.code > 0 ? static_cast<char>(character.code)
           : at != std::u32string_view::npos           ? kTo[at]
                                                       : '?';
    text.remove_prefix(character.size);
  }
  return out;
}

}  // namespace stillcut
