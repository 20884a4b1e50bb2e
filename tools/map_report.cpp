#include "tools/map_report.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "drivers/files/csv.hpp"
#include "models/machining.hpp"

namespace stillcut {
namespace {

using Json = nlohmann::ordered_json;

std::string with_decimals(double value, int decimals) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(decimals) << value;
  return text.str();
}
std::string percent(double share) { return with_decimals(100.0 * share, std::abs(share) < 0.0995 ? 2 : 1) + " %"; }

// Text of at least `width` characters, to the left or to the right of its column.
std::string left(const std::string& text, std::size_t width) {
  return text.size() < width ? text + std::string(width - text.size(), ' ') : text;
}
std::string right(const std::string& text, std::size_t width) {
  return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}

double worst_frequency(const LeftOutPrediction& prediction) {
  double worst = 0.0;
  for (const ModePrediction& mode : prediction.modes)
    if (mode.predicted) worst = std::max(worst, std::abs(mode.frequency_error));
  return worst;
}

bool lacks_a_mode(const LeftOutPrediction& prediction) {
  return std::any_of(prediction.modes.begin(), prediction.modes.end(),
                     [](const ModePrediction& mode) { return !mode.predicted; });
}

double per_measure(double distance, bool in_joints) { return in_joints ? rad_to_deg(distance) : distance * 1e3; }

// A distance under the name of its unit; JSON's null where it does not apply.
void put_distance(Json& object, const std::string& name, double distance, bool in_joints) {
  object[name + (in_joints ? "_deg" : "_mm")] = per_measure(distance, in_joints);
}

Json or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json to_json(const Mode& mode) {
  return {{"frequency_hz", mode.natural_frequency / kTwoPi},
          {"damping_ratio", mode.damping_ratio},
          {"stiffness_n_per_m", mode.stiffness},
          {"direction", mode.direction}};
}

Json to_json(const std::vector<Mode>& modes) {
  Json list = Json::array();
  for (const Mode& mode : modes) list.push_back(to_json(mode));
  return list;
}

Json to_json(const LeftOutPrediction& prediction) {
  Json modes = Json::array();
  for (const ModePrediction& mode : prediction.modes) {
    modes.push_back({{"measured", to_json(mode.measured)},
                     {"predicted", mode.predicted ? to_json(*mode.predicted) : Json(nullptr)},
                     {"frequency_error", or_null(mode.frequency_error)},
                     {"damping_error", or_null(mode.damping_error)},
                     {"mode_peak_error", or_null(mode.peak_error)}});
  }
  return {{"predicted_peak_m_per_n", prediction.predicted_peak},
          {"peak_error", prediction.peak_error},
          {"spurious_peaks", prediction.spurious_peaks},
          {"missing_peaks", prediction.missing_peaks},
          {"modes", modes}};
}

Json to_json(const WorstAndRms& error) { return {{"worst", error.worst}, {"rms", error.rms}}; }

Json to_json(const MethodErrors& errors) {
  return {{"first_mode_frequency_error", to_json(errors.first_frequency)},
          {"frequency_error", to_json(errors.frequency)},
          {"damping_error", to_json(errors.damping)},
          {"mode_peak_error", to_json(errors.mode_peak)},
          {"peak_error", to_json(errors.peak)},
          {"spurious_peaks", errors.spurious_peaks},
          {"missing_peaks", errors.missing_peaks},
          {"missing_modes", errors.missing_modes},
          {"score", errors.score}};
}

constexpr std::size_t kWidth = 23;  // of a way's columns in the table

std::string cells(double frequency, double peak, const std::string& count) {
  return "  |" + right(percent(frequency), 9) + right(percent(peak), 9) + right(count, 4);
}

}  // namespace

std::string advice(const LeaveOneOut& report) {
  const MethodErrors &best = report.of(report.best), &mean = report.of(MapMethod::mean);
  std::string text = std::string("Use interpolation = \"") + name_of(report.best) +
                     "\": by the errors above it is the best for this map (frequency " + percent(best.frequency.rms) +
                     " rms; the mean of the other postures: " + percent(mean.frequency.rms) + ").";
  if (!report.beats_mean) {
    text +=
        " It does not beat the mean of the other postures: between these postures the map predicts nothing; "
        "measure more of them, nearer to each other.";
  }
  const int spurious = report.of(MapMethod::frf).spurious_peaks;
  if (spurious > 0) {
    text += " Weighting the responses (frf) shows " + std::to_string(spurious) + (spurious == 1 ? " peak" : " peaks") +
            " that no posture has.";
  }
  return text;
}

void print_report(const LeaveOneOut& report, std::ostream& out) {
  out << "Each posture predicted from all the others. Of every way: largest error of a mode's frequency, error of the\n"
         "peak receptance, peaks beyond the measured ones. mean: the mean of the other postures, what to beat.\n\n";
  std::size_t id_width = 8;
  for (const LeftOutPosture& posture : report.postures)
    id_width = std::max({id_width, posture.id.size() + 1, posture.nearest.size() + 1});
  out << left("posture", id_width) << left("nearest", id_width) << right("away", 9) << right("mode 1", 11)
      << right("peak", 12);
  for (const MapMethod method : report.methods) out << "  | " << left(name_of(method), kWidth - 2);
  out << '\n';
  for (const LeftOutPosture& posture : report.postures) {
    const LeftOutPrediction& any = posture.by(MapMethod::mean);
    out << left(posture.id, id_width) << left(posture.nearest, id_width)
        << right(posture_distance_text(posture.nearest_distance, report.in_joints), 9) << (posture.outside ? "*" : " ")
        << right(with_decimals(any.modes.front().measured.natural_frequency / kTwoPi, 2) + " Hz", 10)
        << right(with_decimals(any.measured_peak * 1e6, 3) + " um/N", 12);
    for (const MapMethod method : report.methods) {
      const LeftOutPrediction& by = posture.by(method);
      const std::string count = std::to_string(by.spurious_peaks) + (lacks_a_mode(by) ? "-" : " ");
      out << cells(worst_frequency(by), by.peak_error, count);
    }
    out << '\n';
  }
  const auto line = [&](const char* name, double WorstAndRms::*part, bool sums) {
    out << left(name, 2 * id_width + 32);
    for (const MapMethod method : report.methods) {
      const MethodErrors& total = report.of(method);
      out << cells(total.frequency.*part, total.peak.*part, sums ? std::to_string(total.spurious_peaks) + " " : "");
    }
    out << '\n';
  };
  line("worst", &WorstAndRms::worst, false);
  line("rms; peaks: sum", &WorstAndRms::rms, true);
  const auto any = [&](auto&& holds) { return std::any_of(report.postures.begin(), report.postures.end(), holds); };
  if (any([](const LeftOutPosture& posture) { return posture.outside; }))
    out << "* outside of the map that the other postures make: an extrapolation\n";
  if (any([](const LeftOutPosture& posture) {
        return std::any_of(posture.by_method.begin(), posture.by_method.end(), lacks_a_mode);
      }))
    out << "- a measured mode was not predicted\n";
  out << '\n' << advice(report) << '\n';
}

void write_report_csv(const LeaveOneOut& report, std::ostream& out) {
  out << "posture,method,mode,measured_frequency_hz,predicted_frequency_hz,frequency_error,measured_damping_ratio,"
         "predicted_damping_ratio,damping_error,mode_peak_error,measured_peak_m_per_n,predicted_peak_m_per_n,"
         "peak_error,spurious_peaks,missing_peaks,nearest_posture,nearest_distance_deg,nearest_distance_mm,"
         "outside_map\n";
  for (const LeftOutPosture& posture : report.postures) {
    const std::string distance = csv_number(per_measure(posture.nearest_distance, report.in_joints));
    for (const MapMethod method : report.methods) {
      const LeftOutPrediction& by = posture.by(method);
      for (std::size_t i = 0; i < by.modes.size(); ++i) {
        const ModePrediction& mode = by.modes[i];
        const auto of_predicted = [&](double Mode::*parameter, double unit) {
          return mode.predicted ? csv_number((*mode.predicted).*parameter / unit) : std::string{};
        };
        const std::string fields[] = {csv_text(posture.id),
                                      name_of(method),
                                      std::to_string(i + 1),
                                      csv_number(mode.measured.natural_frequency / kTwoPi),
                                      of_predicted(&Mode::natural_frequency, kTwoPi),
                                      csv_number_or_empty(mode.frequency_error),
                                      csv_number(mode.measured.damping_ratio),
                                      of_predicted(&Mode::damping_ratio, 1.0),
                                      csv_number_or_empty(mode.damping_error),
                                      csv_number_or_empty(mode.peak_error),
                                      csv_number(by.measured_peak),
                                      csv_number(by.predicted_peak),
                                      csv_number(by.peak_error),
                                      std::to_string(by.spurious_peaks),
                                      std::to_string(by.missing_peaks),
                                      csv_text(posture.nearest),
                                      report.in_joints ? distance : std::string{},
                                      report.in_joints ? std::string{} : distance,
                                      posture.outside ? "1" : "0"};
        write_csv_row(out, fields);
      }
    }
  }
}

Json report_to_json(const LeaveOneOut& report) {
  Json postures = Json::array(), summary;
  for (const LeftOutPosture& posture : report.postures) {
    Json one{{"posture", posture.id}, {"nearest_posture", posture.nearest}};
    put_distance(one, "nearest_distance", posture.nearest_distance, report.in_joints);
    one["outside_map"] = posture.outside;
    one["measured_peak_m_per_n"] = posture.by(MapMethod::mean).measured_peak;
    for (const MapMethod method : report.methods) one[name_of(method)] = to_json(posture.by(method));
    postures.push_back(std::move(one));
  }
  for (const MapMethod method : report.methods) summary[name_of(method)] = to_json(report.of(method));
  return {{"recommended", name_of(report.best)},
          {"beats_mean", report.beats_mean},
          {"advice", advice(report)},
          {"summary", summary},
          {"postures", postures}};
}

void print_prediction(const PredictedPosture& predicted, const ModalRefit& refit, std::ostream& out) {
  out << "posture " << predicted.posture.id << ": nearest measured posture " << predicted.nearest << ", "
      << posture_distance_text(predicted.nearest_distance, predicted.in_joints) << " away; ";
  if (predicted.nearest_distance == 0.0) {
    out << "measured\n";
  } else if (predicted.map_spacing == 0.0) {
    out << "a map of one posture cannot tell whether that is inside it\n";
  } else {
    out << (predicted.outside ? "OUTSIDE the map (" : "inside the map (") << (predicted.outside ? "beyond" : "within")
        << " its spacing of " << posture_distance_text(predicted.map_spacing, predicted.in_joints) << ")\n";
  }
  const std::size_t all = predicted.posture.modes.size();
  if (all > kMostRefitModes) {
    out << all << " superposed modes; fitted by " << refit.modes.size() << ", error of the receptance "
        << percent(refit.error.at_peak) << " at its peak, " << percent(refit.error.rms) << " rms:\n";
  }
  out << "  frequency   damping    stiffness   direction\n";
  for (const Mode& mode : all > kMostRefitModes ? refit.modes : predicted.posture.modes) {
    out << right(with_decimals(mode.natural_frequency / kTwoPi, 2) + " Hz", 11)
        << right(percent(mode.damping_ratio), 10) << right(with_decimals(mode.stiffness * 1e-6, 3) + " N/um", 13)
        << "  ";
    for (const double component : mode.direction) out << right(with_decimals(component, 3), 7);
    out << '\n';
  }
}

void write_prediction_csv(const PredictedPosture& predicted, std::ostream& out) {
  out << "mode,frequency_hz,damping_ratio,stiffness_n_per_m,ux,uy,uz\n";
  for (std::size_t i = 0; i < predicted.posture.modes.size(); ++i) {
    const Mode& mode = predicted.posture.modes[i];
    const auto& [x, y, z] = mode.direction;
    const std::string fields[] = {std::to_string(i + 1),
                                  csv_number(mode.natural_frequency / kTwoPi),
                                  csv_number(mode.damping_ratio),
                                  csv_number(mode.stiffness),
                                  csv_number(x),
                                  csv_number(y),
                                  csv_number(z)};
    write_csv_row(out, fields);
  }
}

Json prediction_to_json(const PredictedPosture& predicted, const ModalRefit& refit) {
  Json json{{"posture", predicted.posture.id}, {"nearest_posture", predicted.nearest}};
  put_distance(json, "nearest_distance", predicted.nearest_distance, predicted.in_joints);
  put_distance(json, "map_spacing", predicted.map_spacing, predicted.in_joints);
  json["outside_map"] = predicted.outside;
  json["modes"] = to_json(predicted.posture.modes);
  json["refit"] = {{"modes", to_json(refit.modes)},
                   {"error_at_peak", refit.error.at_peak},
                   {"error_rms", refit.error.rms},
                   {"error_worst", refit.error.worst}};
  return json;
}

}  // namespace stillcut
