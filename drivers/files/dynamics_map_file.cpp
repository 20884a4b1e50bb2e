#include "drivers/files/dynamics_map_file.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "drivers/files/csv.hpp"
#include "drivers/files/input_error.hpp"
#include "drivers/files/text_file.hpp"
#include "models/machining.hpp"

namespace stillcut {
namespace {

constexpr double kLengthTolerance = 0.05;  // of a unit direction
constexpr double kLengthIsExact = 1e-12;   // nearer to 1 than this it is kept bit for bit
constexpr double kMm = 1e-3;               // m

const std::vector<std::string> kJointColumns{"j1_deg", "j2_deg", "j3_deg", "j4_deg", "j5_deg", "j6_deg"};
const std::vector<std::string> kPositionColumns{"x_mm", "y_mm", "z_mm"};
const std::vector<std::string> kModeColumns{"frequency_hz", "damping_ratio", "stiffness_n_per_m", "ux", "uy", "uz"};

std::vector<std::string> joined(std::vector<std::string> first, const std::vector<std::string>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

template <std::size_t N>
std::array<double, N> read_numbers(const CsvTable& table, const CsvRow& row, const std::array<std::size_t, N>& columns,
                                   double limit, double (*to_si)(double)) {
  std::array<double, N> values{};
  for (std::size_t i = 0; i < N; ++i) {
    const double value = table.number(row, columns[i]);
    if (std::abs(value) > limit) {
      table.fail(row, columns[i], csv_number(value) + " is out of range; give a number up to " + csv_number(limit));
    }
    values[i] = to_si(value);
  }
  return values;
}

template <std::size_t N>
std::array<std::size_t, N> find_columns(const CsvTable& table, const std::vector<std::string>& names) {
  std::array<std::size_t, N> columns{};
  for (std::size_t i = 0; i < N; ++i) columns[i] = table.require_column(names[i]);
  return columns;
}

bool same_place(const DynamicsMap& map, const Posture& a, const Posture& b) {
  return map.has_joints ? a.joints == b.joints : a.position == b.position;
}

DynamicsMap posture_rows(const CsvTable& table, std::vector<const CsvRow*>& rows) {
  check_column_names(table, joined(joined({"posture"}, kJointColumns), kPositionColumns));
  DynamicsMap map;
  map.has_joints = std::any_of(kJointColumns.begin(), kJointColumns.end(),
                               [&](const std::string& name) { return table.find_column(name).has_value(); });
  const std::size_t id_column = table.require_column("posture");
  const auto joint_columns = map.has_joints ? find_columns<6>(table, kJointColumns) : std::array<std::size_t, 6>{};
  const auto position_columns = find_columns<3>(table, kPositionColumns);
  for (const CsvRow& row : table.rows()) {
    Posture posture;
    posture.id = table.text(row, id_column);
    if (posture.id.empty()) table.fail(row, id_column, "is empty; give the posture an id");
    if (map.has_joints) {
      posture.joints = read_numbers(table, row, joint_columns, 3600, [](double deg) { return deg_to_rad(deg); });
    }
    posture.position = read_numbers(table, row, position_columns, 1e6, [](double mm) { return mm * kMm; });
    for (const Posture& other : map.postures) {
      if (other.id == posture.id) table.fail(row, id_column, posture.id + " stands twice; give each its own id");
      if (same_place(map, other, posture)) {
        table.fail(row, id_column, posture.id + " is at the same place as " + other.id + "; remove one of them");
      }
    }
    map.postures.push_back(std::move(posture));
    rows.push_back(&row);
  }
  if (map.postures.empty()) throw InputError(table.file(), 0, "holds no posture; add a row for each");
  return map;
}

Mode read_mode(const CsvTable& table, const CsvRow& row, const std::array<std::size_t, 6>& columns) {
  std::array<double, 6> value{};
  for (std::size_t i = 0; i < value.size(); ++i) value[i] = table.number(row, columns[i]);
  const auto out_of_range = [&](std::size_t i, const char* wanted) {
    table.fail(row, columns[i], csv_number(value[i]) + " is out of range; give a number " + wanted);
  };
  if (!(value[0] > 0.0 && value[0] <= 1e5)) out_of_range(0, "above 0 and up to 100000");
  if (!(value[1] > 0.0 && value[1] < 1.0)) out_of_range(1, "between 0 and 1");
  if (!(value[2] > 0.0 && value[2] <= 1e15)) out_of_range(2, "above 0 and up to 1e15");

  Mode mode;
  mode.natural_frequency = kTwoPi * value[0];
  mode.damping_ratio = value[1];
  mode.stiffness = value[2];
  const double length = std::hypot(value[3], value[4], value[5]);
  if (!(std::abs(length - 1.0) <= kLengthTolerance)) {
    table.fail(row, columns[3], "the direction's length is " + csv_number(length) + "; ux, uy, uz is a unit vector");
  }
  const double scale = std::abs(length - 1.0) <= kLengthIsExact ? 1.0 : length;
  mode.direction = {value[3] / scale, value[4] / scale, value[5] / scale};
  return mode;
}

void read_modes(const CsvTable& table, DynamicsMap& map) {
  check_column_names(table, joined({"posture", "mode"}, kModeColumns));
  const std::size_t id_column = table.require_column("posture");
  const std::size_t number_column = table.require_column("mode");
  const auto columns = find_columns<6>(table, kModeColumns);
  std::vector<std::pair<std::string, double>> seen;
  for (const CsvRow& row : table.rows()) {
    const std::string id = table.text(row, id_column);
    const auto posture = std::find_if(map.postures.begin(), map.postures.end(),
                                      [&](const Posture& candidate) { return candidate.id == id; });
    if (posture == map.postures.end()) {
      table.fail(row, id_column, "\"" + id + "\" is not in postures.csv; add it there or correct it");
    }
    std::pair<std::string, double> mode_key{id, table.number(row, number_column)};
    if (std::find(seen.begin(), seen.end(), mode_key) != seen.end()) {
      table.fail(
          row, number_column,
          "mode " + csv_number(mode_key.second) + " of posture " + id + " stands twice; number the modes of a posture");
    }
    seen.push_back(std::move(mode_key));
    posture->modes.push_back(read_mode(table, row, columns));
  }
}

}  // namespace

DynamicsMap read_dynamics_map(const std::filesystem::path& folder) {
  const std::string postures = read_text_file(folder / "postures.csv");  // the first that is missed
  return parse_dynamics_map(postures, read_text_file(folder / "modes.csv"), folder);
}

DynamicsMap parse_dynamics_map(std::string_view postures_text, std::string_view modes_text,
                               const std::filesystem::path& folder) {
  const CsvTable postures = parse_csv(postures_text, (folder / "postures.csv").string());
  std::vector<const CsvRow*> rows;
  DynamicsMap map = posture_rows(postures, rows);
  read_modes(parse_csv(modes_text, (folder / "modes.csv").string()), map);
  for (std::size_t i = 0; i < map.postures.size(); ++i) {
    Posture& posture = map.postures[i];
    if (posture.modes.empty()) {
      postures.fail(*rows[i], postures.require_column("posture"),
                    posture.id + " has no modes; add them to modes.csv or remove the posture");
    }
    sort_modes(posture.modes);
  }
  return map;
}

DynamicsMap read_postures(const std::filesystem::path& file) {
  std::vector<const CsvRow*> rows;
  return posture_rows(read_csv(file), rows);
}

std::array<std::string, 2> dynamics_map_text(const DynamicsMap& map, const MapNames& names) {
  std::ostringstream postures, modes;
  write_csv_row(postures, joined(joined({"posture"}, map.has_joints ? kJointColumns : std::vector<std::string>{}),
                                 kPositionColumns));
  write_csv_row(modes, joined({"posture", "mode"}, kModeColumns));
  for (std::size_t p = 0; p < map.postures.size(); ++p) {
    const Posture& posture = map.postures[p];
    const auto place = [&](double value) { return names.places_known ? csv_number(value) : std::string{}; };
    std::vector<std::string> row{csv_text(posture.id)};
    if (map.has_joints) {
      for (const double joint : posture.joints) row.push_back(place(rad_to_deg(joint)));
    }
    for (const double coordinate : posture.position) row.push_back(place(coordinate / kMm));
    write_csv_row(postures, row);
    for (std::size_t i = 0; i < posture.modes.size(); ++i) {
      const Mode& mode = posture.modes[i];
      const int number = names.mode_numbers.empty() ? static_cast<int>(i + 1) : names.mode_numbers[p][i];
      write_csv_row(
          modes, std::vector<std::string>{csv_text(posture.id), std::to_string(number),
                                          csv_number(mode.natural_frequency / kTwoPi), csv_number(mode.damping_ratio),
                                          csv_number(mode.stiffness), csv_number(mode.direction[0]),
                                          csv_number(mode.direction[1]), csv_number(mode.direction[2])});
    }
  }
  return {postures.str(), modes.str()};
}

void write_dynamics_map(const std::filesystem::path& folder, const DynamicsMap& map) {
  auto [postures, modes] = dynamics_map_text(map);
  write_text_files(folder, {{"postures.csv", std::move(postures)}, {"modes.csv", std::move(modes)}});
}

}  // namespace stillcut
