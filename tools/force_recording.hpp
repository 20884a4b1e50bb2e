// A recording of cutting forces over time, and the mean force of the steady cut in it: over whole turns of the spindle
// only, so that neither the tooth's passing nor runout leaves a remainder.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "drivers/files/csv.hpp"

namespace stillcut {

struct ForceRecording {
  std::string file;                    // for messages
  std::vector<double> time;            // s, rising
  std::vector<Eigen::Vector3d> force;  // N on the tool, workpiece axes
};

// A force of a row, N. Throws InputError with line and column for what no cut exerts.
double force_in(const CsvTable& table, const CsvRow& row, std::size_t column);

// Columns time_s, fx_n, fy_n, fz_n, as `stillcut simulate --csv` writes them; others are ignored. Throws InputError
// with file, line and column.
ForceRecording read_force_recording(const std::filesystem::path& file);

struct RecordedSpan {
  double from = 0.0, to = 0.0;  // s
};

struct ForceWindows {
  std::vector<RecordedSpan> zero;   // air: its mean is taken off; of two, the line through both
  std::optional<RecordedSpan> cut;  // where to take the mean; nothing: where the tool is seen to cut steadily
};

struct SteadyForce {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();  // N
  RecordedSpan span;                               // what it was taken over
  int turns = 0;
  double drift = 0.0;  // N, between the means of the cut's first half and second half
};

// `turns_to_axis`: how many turns the feed takes from the tool's first touch until its axis stands over the part's
// edge; an entry or exit within the recording costs as many, so that only the full slot is looked at. Throws InputError
// with what to change: no cut found, too short, samples missing, air that overlaps the cut.
SteadyForce steady_force(const ForceRecording& recording, double turn_s, double turns_to_axis,
                         const ForceWindows& windows);

}  // namespace stillcut
