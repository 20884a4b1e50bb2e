#include "drivers/files/tap_recording_file.hpp"

#include <cmath>

#include "drivers/files/csv.hpp"
#include "drivers/files/input_error.hpp"
#include "drivers/files/tap_rate.hpp"
#include "drivers/files/text_file.hpp"

namespace stillcut {
namespace {

constexpr const char* kTimeColumn = "time_s";
constexpr const char* kForceColumn = "force_n";
constexpr std::array<const char*, 3> kAccelerationColumns{"ax_m_per_s2", "ay_m_per_s2", "az_m_per_s2"};

std::vector<double> column_values(const CsvTable& table, std::size_t column) {
  std::vector<double> values;
  values.reserve(table.rows().size());
  for (const CsvRow& row : table.rows()) values.push_back(table.number(row, column));
  return values;
}

}  // namespace

double even_rate_hz(std::span<const double> times_s, std::size_t& uneven) {
  constexpr double kWholeRate = 1e-5;  // relative: what the digits of a file leave open
  uneven = times_s.size();
  if (times_s.size() < 2) return 0.0;
  const double step = (times_s.back() - times_s.front()) / static_cast<double>(times_s.size() - 1);
  for (std::size_t i = 1; i < times_s.size(); ++i)
    if (!(std::abs(times_s[i] - times_s[i - 1] - step) < 0.5 * std::abs(step)) || !(step > 0.0)) {
      uneven = i;
      return 0.0;
    }
  const double rate = 1.0 / step, whole = std::round(rate);
  return std::abs(rate - whole) < kWholeRate * rate ? whole : rate;
}

TapFile read_tap_file(const std::filesystem::path& file, std::span<const WavChannel> channels) {
  const std::string ending = file.extension().string();
  if (ending == ".csv") return {{{parse_tap_csv(read_text_file(file), file.string()), {}}}, {}};
  if (ending == ".uff" || ending == ".unv")
    return tap_file_of(parse_uff(read_text_file(file), file.string()), file.string());
  if (ending == ".wav" || ending == ".WAV") return {{{read_tap_wav(file, channels), {}}}, {}};
  throw InputError(file.string(), 0, "a recording of taps must end in .uff, .unv, .csv or .wav");
}

TapRecording parse_tap_csv(std::string_view content, const std::string& file) {
  const CsvTable table = parse_csv(content, file);
  std::vector<std::string> known{kTimeColumn, kForceColumn};
  known.insert(known.end(), kAccelerationColumns.begin(), kAccelerationColumns.end());
  check_column_names(table, known);
  const std::size_t time = table.require_column(kTimeColumn);
  TapRecording recording;
  recording.force = column_values(table, table.require_column(kForceColumn));
  bool any = false;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (const auto column = table.find_column(kAccelerationColumns[axis])) {
      recording.acceleration[axis] = column_values(table, *column);
      any = true;
    }
  if (!any)
    throw InputError(file, table.header_line(), "has no acceleration; add ax_m_per_s2, ay_m_per_s2 or az_m_per_s2");
  if (table.rows().size() < 2)
    throw InputError(file, table.header_line(), "holds no two samples; add the recorded rows");
  std::size_t uneven = 0;
  recording.sample_rate_hz = even_rate_hz(column_values(table, time), uneven);
  if (recording.sample_rate_hz <= 0.0) {
    const CsvRow& row = table.rows()[uneven];
    const std::string text = table.text(row, time);
    table.fail(row, time,
               "\"" + text + "\" does not follow the row before by the step of the others; record without gaps");
  }
  return recording;
}

}  // namespace stillcut
