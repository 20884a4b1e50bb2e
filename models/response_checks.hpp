// Whether measured responses can be those of a passive structure at all, before anything is fitted to them.
#pragma once

#include <string>
#include <vector>

#include "dsp/numbers.hpp"
#include "models/frf_lines.hpp"

namespace stillcut {

// Of responses measured both ways, e.g. xy and yx, and of direct ones; NaN where none was.
struct ResponseChecks {
  double reciprocity_error = kNaN;  // root mean square of the difference over that of the mean
  double passivity_excess = kNaN;   // share of the power of direct responses, above noise, that is given, not taken
};

[[nodiscard]] ResponseChecks check_responses(const FrfLines& lines, const FrfWeights& weights);

// Throws std::invalid_argument, in words for the operator, for entries that leave a direction's length open (xy alone),
// and for direct responses that give power: of another kind or sign, or swapped.
void require_receptance(const FrfLines& lines, const FrfWeights& weights);

// Of responses measured both ways that differ by more than the noise in `weights` and sound sensors explain. Whole
// sentences.
[[nodiscard]] std::vector<std::string> reciprocity_doubts(const FrfLines& lines, const FrfWeights& weights);

// What the entries leave open but can be carried: axes that were not measured, signs that only a cross response tells,
// gaps between the lines, frequencies that seem not to be in Hz. Whole sentences.
[[nodiscard]] std::vector<std::string> response_doubts(const FrfLines& lines);

}  // namespace stillcut
