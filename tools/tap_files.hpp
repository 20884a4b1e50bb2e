// What a tap test leaves on disk: the frequency responses of a posture, and the hits that they were estimated from.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "drivers/files/uff58_file.hpp"
#include "models/tap_estimate.hpp"
#include "tools/tap_dialog.hpp"

namespace stillcut {

enum class TapEstimator { h1, h2, hv };

// All directions' columns, by that estimator. Throws std::invalid_argument where they do not go together.
[[nodiscard]] FrequencyResponse responses_of(std::span<const TappedDirection> directions, TapEstimator estimator);

// By the name's ending: .uff or .unv in that form, .csv. The file is whole or not there: it is written beside itself
// first. Throws InputError.
void check_frf_name(const std::filesystem::path& file);
void write_frf(const std::filesystem::path& file, const FrequencyResponse& response, UffForm form);

// The hits of one direction as time records, binary. Throws InputError.
void write_taps(const std::filesystem::path& file, const TappedDirection& tapped);

// `folder`/postures.csv: the rows of `places` whose posture has its responses in `folder`, by the ending `ending`.
// Throws InputError.
void write_measured_places(const std::filesystem::path& folder, const std::filesystem::path& places,
                           const std::string& ending);

}  // namespace stillcut
