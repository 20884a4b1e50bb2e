#include "tools/slot_tests.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "drivers/files/csv.hpp"
#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

constexpr double kLeast = 1e-6;  // mm, rpm
constexpr double kLargestFeed_mm = 10.0, kDeepestSlot_mm = 1000.0, kFastest_rpm = 1e6;
constexpr double kLargestDrift = 0.05;  // of the mean force, from the first half of a cut to the second
constexpr const char* kListName = "tests.csv";
const std::array<std::string, 5> kMeanColumns{"feed_per_tooth_mm", "axial_depth_mm", "fx_mean_n", "fy_mean_n",
                                              "fz_mean_n"};
const std::array<std::string, 5> kListColumns{"file", "feed_per_tooth_mm", "axial_depth_mm", "spindle_speed_rpm",
                                              "feed_direction_deg"};

double positive(const CsvTable& table, const CsvRow& row, const std::string& name, double most, const char* unit) {
  const std::size_t column = table.require_column(name);
  const double value = table.number(row, column);
  if (!(value >= kLeast && value <= most))
    table.fail(row, column,
               csv_number(value) + " is out of range; give " + unit + " above 0, up to " + csv_number(most));
  return value;
}

SlotTest described_test(const CsvTable& table, const CsvRow& row) {
  SlotTest test;
  test.feed_per_tooth = 1e-3 * positive(table, row, "feed_per_tooth_mm", kLargestFeed_mm, "mm");
  test.axial_depth = 1e-3 * positive(table, row, "axial_depth_mm", kDeepestSlot_mm, "mm");
  return test;
}

CsvTable read_rows(const std::filesystem::path& file, std::span<const std::string> columns, std::size_t required) {
  CsvTable table = read_csv(file);
  check_column_names(table, columns);
  for (const std::string& name : columns.first(required)) (void)table.require_column(name);
  if (table.rows().empty())
    throw InputError(table.file(), table.header_line(), "no slot test follows the header; add a row for each");
  return table;
}

// Of the circle that the tool cuts at its depth, m.
double cutting_radius(const Tool& tool, double depth) {
  const double radius = 0.5 * tool.diameter;
  return tool.shape == ToolShape::ball && depth < radius ? std::sqrt(depth * (2.0 * radius - depth)) : radius;
}

double direction_in(const CsvTable& table, const CsvRow& row, std::optional<double> otherwise) {
  if (const auto column = table.find_column(kListColumns[4])) return deg_to_rad(table.number(row, *column));
  if (otherwise) return *otherwise;
  throw InputError(table.file(), table.header_line(),
                   "the feed direction is not known: add a column feed_direction_deg, give --feed-direction, or add "
                   "[cut] to the cell file");
}

}  // namespace

std::vector<SlotTest> read_slot_tests(const std::filesystem::path& file) {
  const CsvTable table = read_rows(file, kMeanColumns, kMeanColumns.size());
  std::vector<SlotTest> tests;
  for (const CsvRow& row : table.rows()) {
    SlotTest& test = tests.emplace_back(described_test(table, row));
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      test.mean_force[axis] =
          force_in(table, row, table.require_column(kMeanColumns.at(static_cast<std::size_t>(axis) + 2)));
  }
  return tests;
}

RecordedTests read_recorded_tests(const std::filesystem::path& path, const Tool& tool,
                                  std::optional<double> feed_direction, const ForceWindows& windows) {
  std::error_code ignored;  // what is no folder is read as a list, which says what is wrong
  const std::filesystem::path list = std::filesystem::is_directory(path, ignored) ? path / kListName : path;
  const CsvTable table = read_rows(list, kListColumns, 4);
  RecordedTests read;
  for (const CsvRow& row : table.rows()) {
    SlotTest test = described_test(table, row);
    const double turn_s = 60.0 / positive(table, row, "spindle_speed_rpm", kFastest_rpm, "rpm");
    const double direction = direction_in(table, row, feed_direction);
    const std::string name = table.text(row, table.require_column("file"));
    if (name.empty()) table.fail(row, table.require_column("file"), "is empty; name the recording of this test");
    const ForceRecording recording = read_force_recording(list.parent_path() / name);
    // A slot is whole once the tool's axis is in the part.
    const double turns_to_axis = cutting_radius(tool, test.axial_depth) / (test.feed_per_tooth * tool.teeth);
    const SteadyForce steady = steady_force(recording, turn_s, turns_to_axis, windows);
    if (steady.drift > kLargestDrift * steady.mean.norm())
      read.warnings.push_back(recording.file + ": the force drifts within the cut by " +
                              csv_number(std::round(100.0 * steady.drift / steady.mean.norm())) +
                              " %: wear, or a charge amplifier; give --zero before and after the cut");
    test.mean_force = Eigen::AngleAxisd(-direction, Eigen::Vector3d::UnitZ()) * steady.mean;
    read.tests.push_back(test);
    read.names.push_back(name);
    read.forces.push_back(steady);
  }
  return read;
}

namespace {

// Without what the way from mm to m and back leaves behind.
std::string length_in_mm(double length) { return csv_number(std::round(length * 1e12) / 1e9); }

}  // namespace

void write_slot_tests(std::ostream& out, const std::vector<SlotTest>& tests) {
  write_csv_row(out, kMeanColumns);
  for (const SlotTest& test : tests) {
    const std::array<std::string, 5> fields{length_in_mm(test.feed_per_tooth), length_in_mm(test.axial_depth),
                                            csv_number(test.mean_force.x()), csv_number(test.mean_force.y()),
                                            csv_number(test.mean_force.z())};
    write_csv_row(out, fields);
  }
}

}  // namespace stillcut
