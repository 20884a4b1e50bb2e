// How lobes are written: CSV and JSON for programs, lines for people. Declared in lobe_study.hpp.
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <ostream>
#include <sstream>
#include <tuple>

#include "drivers/files/csv.hpp"
#include "tools/as_given.hpp"
#include "tools/lobe_study.hpp"

namespace stillcut {
namespace {

// The depth as JSON can hold it: a number, or "inf" and "nan" as in the CSV.
nlohmann::ordered_json json_depth(double depth) {
  if (std::isfinite(depth)) return depth * 1e3;
  return csv_number(depth);
}

nlohmann::ordered_json json_or_null(double value) { return std::isfinite(value) ? nlohmann::json(value) : nullptr; }

nlohmann::ordered_json coupling_json(const ModeCouplingLimit& limit) {
  return {{"depth_mm", json_depth(limit.depth)}, {"frequency_hz", json_or_null(limit.frequency / kTwoPi)}};
}

nlohmann::ordered_json curve_json(const LobeStudy& study, const LobeCurve& curve) {
  const auto& [settings, confidence] = std::tie(study.question.settings, study.question.confidence);
  const PredictedPosture& predicted = curve.predicted;
  nlohmann::ordered_json modes = nlohmann::json::array(), points = nlohmann::json::array();
  for (const Mode& mode : predicted.posture.modes) {
    modes.push_back({{"frequency_hz", mode.natural_frequency / kTwoPi},
                     {"damping_ratio", mode.damping_ratio},
                     {"stiffness_n_per_m", mode.stiffness},
                     {"direction", mode.direction}});
  }
  double error = 0.0;
  for (std::size_t i = 0; i < curve.limits.size(); ++i) {
    const DepthLimit& limit = curve.limits[i];
    constexpr const char* kKinds[] = {"hopf", "flip", "fold"};
    const char* kind = kKinds[static_cast<int>(limit.instability)];
    points.push_back({{"spindle_speed_rpm", as_given_rpm(study.question.speeds[i])},
                      {"a_lim_mm", json_depth(limit.depth)},
                      {"chatter_frequency_hz", json_or_null(limit.chatter_frequency / kTwoPi)},
                      {"instability", std::isfinite(limit.depth) ? nlohmann::json(kind) : nullptr}});
    if (confidence) {
      points.back()["a_low_mm"] = json_depth(curve.bands[i].low);
      points.back()["a_high_mm"] = json_depth(curve.bands[i].high);
    }
    error = std::max(error, limit.error_estimate);
  }
  const nlohmann::json fitted = predicted.fitted_from > 0 ? nlohmann::json(predicted.fitted_from) : nullptr;
  const bool floquet = settings.method == LobeMethod::floquet;
  nlohmann::ordered_json coupling = coupling_json(curve.coupling);
  coupling["below_hz"] = as_given(study.coupling_below / kTwoPi);
  coupling["undamped"] = curve.undamped_coupling ? coupling_json(*curve.undamped_coupling) : nullptr;
  nlohmann::ordered_json object{{"posture", predicted.posture.id},
                                {"nearest_posture", predicted.nearest},
                                {"outside_map", predicted.outside},
                                {"modes_fitted_from", fitted},
                                {"method", floquet ? "sdm" : "zoa"},
                                {"feed_direction_deg", as_given_deg(curve.cut.feed_direction)},
                                {"max_depth_mm", as_given(settings.max_depth * 1e3)},
                                {"relative_error_estimate", floquet ? nlohmann::json(error) : nullptr},
                                {"mode_coupling", coupling},
                                {"modes", modes},
                                {"points", points}};
  if (confidence) {
    const Tolerance& tolerance = study.tolerance;
    object["confidence"] = confidence->probability;
    object["tolerance"] = {{"frequency", tolerance.modes.frequency},
                           {"damping", tolerance.modes.damping},
                           {"stiffness", tolerance.modes.stiffness},
                           {"ktc", tolerance.ktc},
                           {"from_map", study.map_scatter}};
  }
  return object;
}

std::string mm(double depth) {
  std::ostringstream text;
  text << std::setprecision(3) << depth * 1e3 << " mm";
  return text.str();
}

// Where the shallowest and the deepest limits lie, in words where they are no numbers.
std::string extremes_text(const LobeStudy& study, const LobeCurve& curve) {
  const auto depth = [&](const DepthLimit& limit) { return std::isnan(limit.depth) ? 0.0 : limit.depth; };
  const auto [lowest, highest] =
      std::minmax_element(curve.limits.begin(), curve.limits.end(),
                          [&](const DepthLimit& a, const DepthLimit& b) { return depth(a) < depth(b); });
  const auto place = [&](auto limit) {
    std::ostringstream text;
    text << " at " << std::fixed << std::setprecision(0)
         << rad_s_to_rpm(study.question.speeds[static_cast<std::size_t>(limit - curve.limits.begin())]) << " rpm";
    return text.str();
  };
  const auto named = [&](const char* which, auto limit) {
    if (depth(*limit) == 0.0) return "unstable at every depth" + place(limit);
    if (std::isinf(depth(*limit))) return "none up to " + mm(study.question.settings.max_depth) + place(limit);
    return which + mm(depth(*limit)) + place(limit);
  };
  if (depth(*highest) == 0.0) return "unstable at every depth and speed";
  if (std::isinf(depth(*lowest))) return "none up to " + mm(study.question.settings.max_depth) + " at any speed";
  return named("lowest ", lowest) + ", " + named("highest ", highest);
}

}  // namespace

std::string coupling_text(const ModeCouplingLimit& limit, double max_depth) {
  if (std::isnan(limit.depth)) return "at every depth";
  if (std::isinf(limit.depth)) return "none up to " + mm(max_depth);
  if (limit.frequency == 0.0) return "from " + mm(limit.depth) + " on, drawn in without vibration";
  std::ostringstream text;
  text << "from " << mm(limit.depth) << " on, at " << std::setprecision(3) << limit.frequency / kTwoPi << " Hz";
  return text.str();
}

std::string curve_name(const LobeCurve& curve) {
  return curve.predicted.posture.id + ", " +
         csv_number(std::round(rad_to_deg(curve.cut.feed_direction) * 100.0) / 100.0) + "°";
}

void write_lobes_csv(const LobeStudy& study, std::ostream& out) {
  const bool several = study.curves.size() > 1, band = study.question.confidence.has_value();
  out << (several ? "posture,feed_direction_deg," : "") << "spindle_speed_rpm,a_lim_mm,chatter_frequency_hz"
      << (band ? ",a_low_mm,a_high_mm" : "") << '\n';
  for (const LobeCurve& curve : study.curves) {
    for (std::size_t i = 0; i < curve.limits.size(); ++i) {
      std::vector<std::string> fields;
      if (several) {
        fields = {csv_text(curve.predicted.posture.id), csv_number(as_given_deg(curve.cut.feed_direction))};
      }
      const DepthLimit& limit = curve.limits[i];
      fields.push_back(csv_number(as_given_rpm(study.question.speeds[i])));
      fields.push_back(csv_number(limit.depth * 1e3));
      fields.push_back(csv_number_or_empty(limit.chatter_frequency / kTwoPi));
      if (band) {
        fields.push_back(csv_number(curve.bands[i].low * 1e3));
        fields.push_back(csv_number(curve.bands[i].high * 1e3));
      }
      write_csv_row(out, fields);
    }
  }
}

nlohmann::ordered_json lobes_json(const LobeStudy& study) {
  if (study.curves.size() == 1) return curve_json(study, study.curves.front());
  nlohmann::ordered_json diagrams = nlohmann::json::array();
  for (const LobeCurve& curve : study.curves) diagrams.push_back(curve_json(study, curve));
  return {{"diagrams", diagrams}};
}

void print_lobes_summary(const LobeStudy& study, std::ostream& out) {
  const double max_depth = study.question.settings.max_depth;
  for (const LobeCurve& curve : study.curves) {
    out << "posture " << curve_name(curve) << ": limit depth: " << extremes_text(study, curve) << '\n'
        << "  mode coupling up to " << std::round(study.coupling_below / kTwoPi)
        << " Hz: " << coupling_text(curve.coupling, max_depth);
    if (curve.undamped_coupling)
      out << " (without damping: " << coupling_text(*curve.undamped_coupling, max_depth) << ")";
    out << '\n';
  }
}

}  // namespace stillcut
