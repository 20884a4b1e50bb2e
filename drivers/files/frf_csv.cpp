#include "drivers/files/frf_csv.hpp"

#include "drivers/files/csv.hpp"
#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

constexpr std::string_view kEntryAxes = "xyz";
constexpr const char* kFrequencyColumn = "frequency_hz";
constexpr const char* kDecayColumn = "added_decay_per_s";
constexpr const char* kForceErrorColumn = "force_error";

std::string entry_column(std::size_t response, std::size_t force, const char* part) {
  std::string name{'h', '_', kEntryAxes[response], kEntryAxes[force]};
  return name.append(part);
}

std::string coherence_column(std::size_t response, std::size_t force) {
  return {std::string("coherence_") + kEntryAxes[response] + kEntryAxes[force]};
}

std::vector<std::string> all_columns() {
  std::vector<std::string> names{kFrequencyColumn, kDecayColumn, kForceErrorColumn};
  for (std::size_t response = 0; response < 3; ++response)
    for (std::size_t force = 0; force < 3; ++force)
      for (const char* part : {"_re", "_im"}) names.push_back(entry_column(response, force, part));
  for (std::size_t response = 0; response < 3; ++response)
    for (std::size_t force = 0; force < 3; ++force) names.push_back(coherence_column(response, force));
  return names;
}

// The entry's values; empty where the table has neither of its columns.
ComplexValues read_entry(const CsvTable& table, std::size_t response, std::size_t force) {
  const std::string real_name = entry_column(response, force, "_re"), other_name = entry_column(response, force, "_im");
  const auto real = table.find_column(real_name), imaginary = table.find_column(other_name);
  if (!real && !imaginary) return {};
  if (!real || !imaginary)
    throw InputError(table.file(), table.header_line(),
                     (real ? other_name : real_name) + ": the header lacks this column, the other of its pair; add it");
  ComplexValues values;
  for (const CsvRow& row : table.rows()) values.emplace_back(table.number(row, *real), table.number(row, *imaginary));
  return values;
}

[[noreturn]] void fail_value(const CsvTable& table, const CsvRow& row, std::size_t column, const char* message) {
  const std::string text = table.text(row, column);
  table.fail(row, column, "\"" + text + "\" " + message);
}

std::vector<double> read_coherence(const CsvTable& table, std::size_t response, std::size_t force) {
  const auto column = table.find_column(coherence_column(response, force));
  if (!column) return {};
  std::vector<double> values;
  for (const CsvRow& row : table.rows()) {
    values.push_back(table.number(row, *column));
    if (values.back() < 0.0 || values.back() > 1.0)
      fail_value(table, row, *column, "is no coherence; must be from 0 to 1");
  }
  return values;
}

// Of the whole measurement: the same in every row; 0 without the column.
double read_constant(const CsvTable& table, const char* name) {
  const auto column = table.find_column(name);
  if (!column) return 0.0;
  const double told = table.number(table.rows().front(), *column);
  for (const CsvRow& row : table.rows())
    if (const double value = table.number(row, *column); value != told || value < 0.0)
      fail_value(table, row, *column, "must be from 0 up and the same in every row; correct it");
  return told;
}

}  // namespace

FrequencyResponse parse_frf_csv(std::string_view content, const std::string& file) {
  const CsvTable table = parse_csv(content, file);
  check_column_names(table, all_columns());
  const std::size_t frequency = table.require_column(kFrequencyColumn);
  FrequencyResponse response;
  for (const CsvRow& row : table.rows()) {
    const double hz = table.number(row, frequency);
    const std::string text = table.text(row, frequency);
    if (hz < 0.0) table.fail(row, frequency, "\"" + text + "\" is below 0");
    if (!response.frequencies_hz.empty() && hz <= response.frequencies_hz.back())
      table.fail(row, frequency, "\"" + text + "\" is not above the row before; sort the rows");
    response.frequencies_hz.push_back(hz);
  }
  if (table.rows().empty()) throw InputError(file, table.header_line(), "has no row below its header");
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t force = 0; force < 3; ++force) {
      response.receptance[axis][force] = read_entry(table, axis, force);
      if (!response.receptance[axis][force].empty())
        response.coherence[axis][force] = read_coherence(table, axis, force);
    }
  response.added_decay_per_s = read_constant(table, kDecayColumn);
  response.force_error = read_constant(table, kForceErrorColumn);
  if (measured_entries(response) == 0)
    throw InputError(file, table.header_line(),
                     "has no pair such as h_xx_re,h_xx_im: response and force axis, real and imaginary part in m/N");
  return response;
}

void write_frf_csv(std::ostream& out, const FrequencyResponse& response) {
  require_sound_response(response);
  std::vector<std::string> header{kFrequencyColumn};
  std::vector<const ComplexValues*> entries;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t force = 0; force < 3; ++force) {
      if (response.receptance[axis][force].empty()) continue;
      header.push_back(entry_column(axis, force, "_re"));
      header.push_back(entry_column(axis, force, "_im"));
      entries.push_back(&response.receptance[axis][force]);
    }
  std::vector<const std::vector<double>*> coherences;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t force = 0; force < 3; ++force) {
      if (response.coherence[axis][force].empty()) continue;
      header.push_back(coherence_column(axis, force));
      coherences.push_back(&response.coherence[axis][force]);
    }
  if (response.added_decay_per_s > 0.0) header.emplace_back(kDecayColumn);
  if (response.force_error > 0.0) header.emplace_back(kForceErrorColumn);
  write_csv_row(out, header);
  for (std::size_t i = 0; i < response.frequencies_hz.size(); ++i) {
    std::vector<std::string> row{csv_number(response.frequencies_hz[i])};
    for (const ComplexValues* entry : entries) {
      row.push_back(csv_number((*entry)[i].real()));
      row.push_back(csv_number((*entry)[i].imag()));
    }
    for (const std::vector<double>* values : coherences) row.push_back(csv_number((*values)[i]));
    if (response.added_decay_per_s > 0.0) row.push_back(csv_number(response.added_decay_per_s));
    if (response.force_error > 0.0) row.push_back(csv_number(response.force_error));
    write_csv_row(out, row);
  }
}

}  // namespace stillcut
