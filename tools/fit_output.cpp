#include "tools/fit_output.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "drivers/files/csv.hpp"
#include "drivers/files/dynamics_map_file.hpp"
#include "drivers/files/text_file.hpp"
#include "models/machining.hpp"
#include "tools/map_report.hpp"

namespace stillcut {
namespace {

using Json = nlohmann::ordered_json;

std::string text_of_format(const char* format, auto... values) {
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

Json known_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

std::string uncertainty_csv(const FitStudy& study) {
  std::ostringstream out;
  out << "posture,mode,frequency_hz_se,damping_ratio_se,stiffness_n_per_m_se,direction_deg_se\n";
  for (std::size_t p = 0; p < study.postures.size(); ++p) {
    const auto& modes = study.postures[p].fit.modes;
    for (std::size_t m = 0; m < modes.size(); ++m) {
      const ModeDeviation& deviation = modes[m].deviation;
      write_csv_row(out, std::vector<std::string>{
                             csv_text(study.map.postures[p].id), std::to_string(study.tracks.number[p][m]),
                             csv_number_or_empty(deviation.natural_frequency / kTwoPi),
                             csv_number_or_empty(deviation.damping_ratio), csv_number_or_empty(deviation.stiffness),
                             csv_number_or_empty(rad_to_deg(deviation.direction))});
    }
  }
  return out.str();
}

void print_posture(const FitStudy& study, std::size_t p, std::ostream& out) {
  const FittedPosture& posture = study.postures[p];
  const ResponseChecks& checks = posture.fit.checks;
  out << "posture " << study.map.postures[p].id << " (" << posture.file << "): fit off by "
      << text_of_format("%.2g %%", 100.0 * posture.fit.misfit);
  if (std::isfinite(checks.reciprocity_error))
    out << text_of_format(", reciprocity by %.2g %%", 100.0 * checks.reciprocity_error);
  if (std::isfinite(checks.passivity_excess))
    out << text_of_format(", %.2g %% of the power given, not taken", 100.0 * checks.passivity_excess);
  out << "\n  mode         frequency               damping                stiffness            direction\n";
  for (std::size_t m = 0; m < posture.fit.modes.size(); ++m) {
    const auto& [mode, deviation] = posture.fit.modes[m];
    const auto& [x, y, z] = mode.direction;
    out << text_of_format(
        "  %4d %9.3f +- %-8.2g Hz %7.3f +- %-8.2g %% %9.4g +- %-8.2g N/um  % .3f % .3f % .3f +- %.2g deg\n",
        study.tracks.number[p][m], mode.natural_frequency / kTwoPi, deviation.natural_frequency / kTwoPi,
        100.0 * mode.damping_ratio, 100.0 * deviation.damping_ratio, 1e-6 * mode.stiffness, 1e-6 * deviation.stiffness,
        x, y, z, rad_to_deg(deviation.direction));
  }
  for (const std::string& note : posture.notes) out << "  note: " << note << '\n';
  for (const std::string& doubt : posture.fit.doubts) out << "  doubt: " << doubt << '\n';
}

struct TrackRange {
  double lowest_hz = kInfinity, highest_hz = 0.0;
  int found = 0;
};

TrackRange range_of(const FitStudy& study, int track) {
  TrackRange range;
  for (std::size_t p = 0; p < study.postures.size(); ++p)
    for (std::size_t m = 0; m < study.tracks.number[p].size(); ++m) {
      if (study.tracks.number[p][m] != track) continue;
      const double hz = study.map.postures[p].modes[m].natural_frequency / kTwoPi;
      range.lowest_hz = std::min(range.lowest_hz, hz);
      range.highest_hz = std::max(range.highest_hz, hz);
      ++range.found;
    }
  return range;
}

void print_tracks(const FitStudy& study, std::ostream& out) {
  const std::size_t count = study.postures.size();
  if (count < 2) return;
  out << "\nmodes over the postures:\n";
  for (int track = 1; track <= study.tracks.count; ++track) {
    const TrackRange range = range_of(study, track);
    out << text_of_format("  %4d %9.3f to %.3f Hz, at %d of %zu postures", track, range.lowest_hz, range.highest_hz,
                          range.found, count);
    if (range.found < static_cast<int>(count)) {
      const char* before = "; missing at ";
      for (std::size_t p = 0; p < count; ++p) {
        const auto& numbers = study.tracks.number[p];
        if (std::find(numbers.begin(), numbers.end(), track) != numbers.end()) continue;
        out << before << study.map.postures[p].id;
        before = ", ";
      }
    }
    out << '\n';
  }
}

Json posture_to_json(const FitStudy& study, std::size_t p) {
  const FittedPosture& posture = study.postures[p];
  Json modes = Json::array();
  for (std::size_t m = 0; m < posture.fit.modes.size(); ++m) {
    const auto& [mode, deviation] = posture.fit.modes[m];
    modes.push_back({{"mode", study.tracks.number[p][m]},
                     {"frequency_hz", mode.natural_frequency / kTwoPi},
                     {"frequency_hz_se", known_or_null(deviation.natural_frequency / kTwoPi)},
                     {"damping_ratio", mode.damping_ratio},
                     {"damping_ratio_se", known_or_null(deviation.damping_ratio)},
                     {"stiffness_n_per_m", mode.stiffness},
                     {"stiffness_n_per_m_se", known_or_null(deviation.stiffness)},
                     {"ux", mode.direction[0]},
                     {"uy", mode.direction[1]},
                     {"uz", mode.direction[2]},
                     {"direction_deg_se", known_or_null(rad_to_deg(deviation.direction))}});
  }
  return {{"posture", study.map.postures[p].id},
          {"file", posture.file},
          {"modes", modes},
          {"misfit", known_or_null(posture.fit.misfit)},
          {"reciprocity_error", known_or_null(posture.fit.checks.reciprocity_error)},
          {"passivity_excess", known_or_null(posture.fit.checks.passivity_excess)},
          {"notes", posture.notes},
          {"doubts", posture.fit.doubts}};
}

Json next_to_json(const NextTap& next, bool has_joints) {
  Json json;
  if (has_joints) {
    json["between"] = next.between;
    for (const double joint : next.place.joints) json["joints_deg"].push_back(rad_to_deg(joint));
  } else {
    for (const double x : next.place.position) json["position_mm"].push_back(1e3 * x);
  }
  json["nearest_posture"] = next.nearest;
  json[has_joints ? "nearest_distance_deg" : "nearest_distance_mm"] =
      has_joints ? rad_to_deg(next.nearest_distance) : 1e3 * next.nearest_distance;
  json["expected_error_half_widths"] = next.half_widths;
  return json;
}

}  // namespace

std::string place_text(const NextTap& next, bool has_joints) {
  std::ostringstream text;
  if (has_joints) text << "half way between " << next.between[0] << " and " << next.between[1] << ", joints ";
  text << std::fixed << std::setprecision(1);
  if (has_joints)
    for (std::size_t i = 0; i < next.place.joints.size(); ++i)
      text << (i == 0 ? "" : ", ") << rad_to_deg(next.place.joints[i]);
  else
    for (std::size_t i = 0; i < next.place.position.size(); ++i)
      text << (i == 0 ? "" : ", ") << 1e3 * next.place.position[i];
  text << (has_joints ? " deg" : " mm");
  return text.str();
}

void write_fitted_map(const FitStudy& study, const std::filesystem::path& folder) {
  auto [postures, modes] =
      dynamics_map_text(study.map, {.mode_numbers = study.tracks.number, .places_known = study.places_known});
  write_text_files(folder, {{"postures.csv", std::move(postures)},
                            {"modes.csv", std::move(modes)},
                            {"uncertainty.csv", uncertainty_csv(study)}});
}

void print_fit(const FitStudy& study, std::ostream& out) {
  for (std::size_t p = 0; p < study.postures.size(); ++p) print_posture(study, p, out);
  print_tracks(study, out);
  if (study.left_out) {
    out << '\n';
    print_report(*study.left_out, out);
  }
  if (!study.doubts.empty()) out << '\n';
  for (const std::string& doubt : study.doubts) out << "doubt: " << doubt << '\n';
  if (!study.next_tap) return;
  const NextTap& next = *study.next_tap;
  out << "\nA next tap test would help most at " << place_text(next, study.map.has_joints) << ": "
      << posture_distance_text(next.nearest_distance, study.map.has_joints) << " from the nearest, " << next.nearest
      << text_of_format("; the map is expected to be off there by %.2g half-widths of a resonance.\n",
                        next.half_widths);
}

Json fit_to_json(const FitStudy& study) {
  Json postures = Json::array(), tracks = Json::array();
  for (std::size_t p = 0; p < study.postures.size(); ++p) postures.push_back(posture_to_json(study, p));
  for (int track = 1; track <= study.tracks.count; ++track) {
    const TrackRange range = range_of(study, track);
    tracks.push_back({{"mode", track},
                      {"found", range.found},
                      {"lowest_frequency_hz", range.lowest_hz},
                      {"highest_frequency_hz", range.highest_hz}});
  }
  return {{"postures", postures},
          {"tracks", tracks},
          {"leave_one_out", study.left_out ? report_to_json(*study.left_out) : Json(nullptr)},
          {"next_tap", study.next_tap ? next_to_json(*study.next_tap, study.map.has_joints) : Json(nullptr)},
          {"doubts", study.doubts}};
}

}  // namespace stillcut
