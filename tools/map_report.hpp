// What `stillcut map` says: the leave-one-out report and a prediction at one posture, for people, as CSV and as JSON,
// and the picture of each.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>
#include <string>

#include "models/leave_one_out.hpp"
#include "models/modal_refit.hpp"
#include "tools/plot.hpp"

namespace stillcut {

// The table: a line for each posture, worst and rms below, then what to use.
void print_report(const LeaveOneOut& report, std::ostream& out);

// Which interpolation to use for the map and why, in a sentence or two. `report` must hold two postures at least.
std::string advice(const LeaveOneOut& report);

// One row for each posture, way and measured mode:
// posture,method,mode,measured_frequency_hz,predicted_frequency_hz,frequency_error,measured_damping_ratio,
// predicted_damping_ratio,damping_error,mode_peak_error,measured_peak_m_per_n,predicted_peak_m_per_n,peak_error,
// spurious_peaks,missing_peaks,nearest_posture,nearest_distance_deg,nearest_distance_mm,outside_map
// Errors are relative; peak_* belong to the posture's whole response.
void write_report_csv(const LeaveOneOut& report, std::ostream& out);
nlohmann::ordered_json report_to_json(const LeaveOneOut& report);

// Measured beside predicted by posture: the first mode's frequency above, the peak receptance below.
plot::Figure report_figure(const LeaveOneOut& report);

// A prediction: its modes, how far the nearest measured posture is, inside or outside. More modes than the stability
// solution is to be used with are shown by their `refit`.
void print_prediction(const PredictedPosture& predicted, const ModalRefit& refit, std::ostream& out);
// mode,frequency_hz,damping_ratio,stiffness_n_per_m,ux,uy,uz: as modes.csv, all predicted modes.
void write_prediction_csv(const PredictedPosture& predicted, std::ostream& out);
nlohmann::ordered_json prediction_to_json(const PredictedPosture& predicted, const ModalRefit& refit);

// Largest receptance over frequency: predicted, and as measured at the nearest posture.
plot::Figure prediction_figure(const PredictedPosture& predicted, const Posture& nearest);

}  // namespace stillcut
