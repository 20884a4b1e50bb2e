// Files of cuts, one a row: cuts to be judged (--points) and cuts that were made and judged by ear or sensor (--cuts).
#pragma once

#include <filesystem>
#include <vector>

#include "drivers/files/csv.hpp"
#include "models/cut_stability.hpp"

namespace stillcut {

// A cut as the file has it, in the file's units, so that it is written back as it was read.
struct CutPoint {
  int line = 0;  // of the file, for messages
  double spindle_speed_rpm = 0.0;
  double axial_depth_mm = 0.0;
};

struct MeasuredCut {
  CutPoint at;
  Verdict verdict = Verdict::stable;  // "stable", "marginal" (near the limit) or "chatter" (unstable)
};

// Columns spindle_speed_rpm (above 0, up to 10^6) and axial_depth_mm (0 to 10^4); others are ignored unless they look
// like one of these misspelt. Throws InputError with file, line and column.
std::vector<CutPoint> read_cut_points(const std::filesystem::path& file);

// The same and a column `verdict`. Throws InputError.
std::vector<MeasuredCut> read_measured_cuts(const std::filesystem::path& file);

}  // namespace stillcut
