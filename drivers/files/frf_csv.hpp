// Frequency responses as CSV: frequency_hz and a pair of columns for each measured entry, h_xy_re and h_xy_im for the
// response along x to a force along y; receptance, m/N. Where they are known, coherence_xy of an entry, 0 to 1, and
// added_decay_per_s of an exponential window and force_error (FrequencyResponse), the same in every row.
#pragma once

#include <ostream>
#include <string>
#include <string_view>

#include "models/frequency_response.hpp"

namespace stillcut {

// Throws InputError with file and line for a column without its pair, no pair at all, a gap, frequencies that do not
// rise, coherence beyond 0 to 1, an added decay or force error that is below 0 or not the same in every row, and no
// row. Columns of the user's own are ignored. `file`: the name used in messages.
[[nodiscard]] FrequencyResponse parse_frf_csv(std::string_view content, const std::string& file);

// Reading gives the same numbers to the last bit. Throws std::invalid_argument for a response that is not sound.
void write_frf_csv(std::ostream& out, const FrequencyResponse& response);

}  // namespace stillcut
