// Numbers as Fortran writes them into the columns of a universal file.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stillcut {

[[nodiscard]] std::string_view uff_bare(std::string_view text);  // without blanks around

// E or D before the exponent, or nothing where it has three digits; empty for no number and for one that is not finite.
[[nodiscard]] std::optional<double> fortran_number(std::string_view text);

// Appends the numbers of a line: those between blanks, or else those in columns of these widths, again and again, where
// they may touch. Returns what is no number, and then appends nothing of it and what follows; empty: all are.
[[nodiscard]] std::string add_uff_numbers(std::string_view line, std::span<const std::size_t> widths,
                                          std::vector<double>& numbers);

}  // namespace stillcut
