// Slot tests as a user brings them: a table of mean forces, or recordings of the forces over time with a list that says
// what each test was.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/slot_coefficients.hpp"
#include "tools/force_recording.hpp"

namespace stillcut {

// Columns feed_per_tooth_mm (above 0, up to 10), axial_depth_mm (above 0, up to 1000), fx_mean_n, fy_mean_n, fz_mean_n;
// forces on the tool in the feed frame. Others are ignored unless they look like one of these misspelt. Throws
// InputError with file, line and column.
std::vector<SlotTest> read_slot_tests(const std::filesystem::path& file);

// A list of recordings: columns file (relative to the list's folder), feed_per_tooth_mm, axial_depth_mm,
// spindle_speed_rpm, and feed_direction_deg where the tests differ in it.
struct RecordedTests {
  std::vector<SlotTest> tests;        // in the feed frame
  std::vector<std::string> names;     // of the recordings, as the list has them
  std::vector<SteadyForce> forces;    // what was found in each, workpiece axes
  std::vector<std::string> warnings;  // with file names
};

// `path`: a list, or a folder with a list tests.csv in it. `feed_direction` (rad, workpiece +X toward +Y) counts where
// the list has none. Throws InputError.
RecordedTests read_recorded_tests(const std::filesystem::path& path, const Tool& tool,
                                  std::optional<double> feed_direction, const ForceWindows& windows);

// The table that read_slot_tests reads.
void write_slot_tests(std::ostream& out, const std::vector<SlotTest>& tests);

}  // namespace stillcut
