// HTML text as the report writes it: escaped text, pictures as data, tables, the style sheet.
#pragma once

#include <initializer_list>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "tools/plot.hpp"

namespace stillcut::html {

[[nodiscard]] std::string escaped(std::string_view text);

// <img> with the figure inside; `alt` is for who cannot see it.
[[nodiscard]] std::string picture(const plot::Figure& figure, plot::Format format, const std::string& alt);

struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  // plain text
  std::vector<std::string> row_class;          // of each row, or none
};
// Columns of numbers stand to the right.
[[nodiscard]] std::string table(const Table& table);

// Pairs of a name and what it is.
[[nodiscard]] std::string facts(std::initializer_list<std::pair<const char*, std::string>> pairs);

[[nodiscard]] const char* style_sheet();

}  // namespace stillcut::html
