#include "tools/tap_files.hpp"

#include <fstream>
#include <functional>
#include <system_error>
#include <vector>

#include "drivers/files/csv.hpp"
#include "drivers/files/frf_csv.hpp"
#include "drivers/files/frf_file.hpp"
#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

constexpr const char* kPostureColumn = "posture";

void write_whole(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write) {
  std::filesystem::path part = file;
  part += ".part";
  std::error_code error;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), error);
  std::ofstream out(part, std::ios::binary);
  if (!out) throw InputError(file.string(), 0, "cannot be written; check the folder and its rights");
  write(out);
  out.close();
  if (!out) throw InputError(file.string(), 0, "cannot be written to the end; is the disk full?");
  std::filesystem::rename(part, file, error);
  if (error) throw InputError(file.string(), 0, "cannot be written: " + error.message());
}

}  // namespace

FrequencyResponse responses_of(std::span<const TappedDirection> directions, TapEstimator estimator) {
  std::vector<FrequencyResponse> parts;
  for (const TappedDirection& tapped : directions) {
    const TapEstimate& estimate = tapped.estimate;
    parts.push_back(estimator == TapEstimator::h1   ? estimate.h1
                    : estimator == TapEstimator::h2 ? estimate.h2
                                                    : estimate.hv);
  }
  return joined_responses(parts);
}

void check_frf_name(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  if (ending != ".uff" && ending != ".unv" && ending != ".csv")
    throw InputError(file.string(), 0, "a file of frequency responses must end in .uff, .unv or .csv");
}

void write_frf(const std::filesystem::path& file, const FrequencyResponse& response, UffForm form) {
  check_frf_name(file);
  write_whole(file, [&](std::ostream& out) {
    if (file.extension() == ".csv")
      write_frf_csv(out, response);
    else
      write_uff(out, uff_of(response), form);
  });
}

void write_taps(const std::filesystem::path& file, const TappedDirection& tapped) {
  write_whole(file,
              [&](std::ostream& out) { write_uff(out, uff_of(tapped.recordings, tapped.hammer), UffForm::binary); });
}

void write_measured_places(const std::filesystem::path& folder, const std::filesystem::path& places,
                           const std::string& ending) {
  const std::filesystem::path file = folder / "postures.csv";
  std::error_code error;
  if (std::filesystem::equivalent(file, places, error)) return;
  const CsvTable table = read_csv(places);
  const std::size_t id = table.require_column(kPostureColumn);
  const auto quoted = [](const std::vector<std::string>& fields) {
    std::vector<std::string> row;
    row.reserve(fields.size());
    for (const std::string& field : fields) row.push_back(csv_text(field));
    return row;
  };
  write_whole(file, [&](std::ostream& out) {
    write_csv_row(out, quoted(table.header()));
    for (const CsvRow& row : table.rows())
      if (std::filesystem::exists(folder / (table.text(row, id) + ending), error))
        write_csv_row(out, quoted(row.fields));
  });
}

}  // namespace stillcut
