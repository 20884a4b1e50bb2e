#include "tools/cut_points.hpp"

#include <array>
#include <string>

#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

constexpr double kHighestSpeed_rpm = 1e6, kDeepest_mm = 1e4;
const std::array<std::string, 3> kColumns{"spindle_speed_rpm", "axial_depth_mm", "verdict"};

CutPoint read_point(const CsvTable& table, const CsvRow& row, std::size_t speed_column, std::size_t depth_column) {
  const double speed = table.number(row, speed_column), depth = table.number(row, depth_column);
  const auto out_of_range = [&](std::size_t column, double value, const std::string& wanted) {
    table.fail(row, column, csv_number(value) + " is out of range; give " + wanted);
  };
  if (!(speed > 0.0 && speed <= kHighestSpeed_rpm)) out_of_range(speed_column, speed, "rpm above 0, up to 1000000");
  if (!(depth >= 0.0 && depth <= kDeepest_mm)) out_of_range(depth_column, depth, "mm from 0 to 10000");
  return {row.line, speed, depth};
}

Verdict read_verdict(const CsvTable& table, const CsvRow& row, std::size_t column) {
  const std::string word = table.text(row, column);
  if (word == "stable") return Verdict::stable;
  if (word == "marginal") return Verdict::near_limit;
  if (word == "chatter") return Verdict::unstable;
  table.fail(row, column, "\"" + word + "\" is no verdict; write stable, marginal or chatter");
}

void require_rows(const CsvTable& table) {
  if (table.rows().empty()) {
    throw InputError(table.file(), table.header_line(), "no cut follows the header; add a row for each cut");
  }
}

}  // namespace

std::vector<CutPoint> read_cut_points(const std::filesystem::path& file) {
  const CsvTable table = read_csv(file);
  check_column_names(table, std::span(kColumns).first(2));
  const std::size_t speed = table.require_column(kColumns[0]), depth = table.require_column(kColumns[1]);
  require_rows(table);
  std::vector<CutPoint> points;
  for (const CsvRow& row : table.rows()) points.push_back(read_point(table, row, speed, depth));
  return points;
}

std::vector<MeasuredCut> read_measured_cuts(const std::filesystem::path& file) {
  const CsvTable table = read_csv(file);
  check_column_names(table, kColumns);
  const std::size_t speed = table.require_column(kColumns[0]), depth = table.require_column(kColumns[1]);
  const std::size_t verdict = table.require_column(kColumns[2]);
  require_rows(table);
  std::vector<MeasuredCut> cuts;
  for (const CsvRow& row : table.rows()) {
    cuts.push_back({read_point(table, row, speed, depth), read_verdict(table, row, verdict)});
  }
  return cuts;
}

}  // namespace stillcut
