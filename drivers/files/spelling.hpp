// "Did you mean ...": the known name nearest to a misspelt one.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace stillcut {

// Number of single-letter changes (insert, delete, replace, swap neighbours) from one word to the other; letter case is
// one change at most for the whole word.
int spelling_distance(std::string_view a, std::string_view b);

// The known name that `word` was probably meant to be, or an empty view when none is near (more than a third of its
// letters would have to change).
std::string_view nearest_name(std::string_view word, std::span<const std::string> known);

}  // namespace stillcut
