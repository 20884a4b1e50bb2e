// What `stillcut fit` says and writes: the map, how sure each of its figures is, tables for people and JSON.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <ostream>

#include "tools/fit_study.hpp"

namespace stillcut {

// modes.csv, where `mode` is the track; postures.csv; uncertainty.csv: posture,mode,frequency_hz_se,damping_ratio_se,
// stiffness_n_per_m_se,direction_deg_se. All three or none. Throws InputError when one cannot be written.
void write_fitted_map(const FitStudy& study, const std::filesystem::path& folder);

// Every mode of every posture with one standard deviation, checks, doubts; leaving out and where to tap next.
void print_fit(const FitStudy& study, std::ostream& out);

nlohmann::ordered_json fit_to_json(const FitStudy& study);

// "at 120, 35, 0 mm" or "half way between 3 and 7: 10, -85, 88, 0, 85, 10 deg".
std::string place_text(const NextTap& next, bool has_joints);

}  // namespace stillcut
