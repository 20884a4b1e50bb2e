#include "tools/tuning_labels.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string>

#include "drivers/files/csv.hpp"
#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

const std::array<std::string, 4> kLabelColumns{"log", "from_s", "to_s", "kind"};
constexpr double kEndTolerance_s = 0.01;  // labels are set with two decimals or three

struct Labels {
  std::map<std::string, LabelledLog> logs;   // by file name
  std::map<std::string, int> sound_on_line;  // logs listed as free of chatter
};

std::map<std::string, LabelledLog> logs_in(const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error))
    throw InputError(folder.string(), 0, "is no folder; name the one that holds labels.csv and the logs");
  std::map<std::string, LabelledLog> logs;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".log" || !entry.is_regular_file(error)) continue;
    logs[entry.path().filename().string()].file = entry.path();
  }
  if (logs.empty())
    throw InputError(folder.string(), 0, "holds no *.log; put CAN logs there, as `candump -L` writes them");
  return logs;
}

class LabelReader {
 public:
  explicit LabelReader(const CsvTable& table)
      : table_{table},
        log_{table.require_column(kLabelColumns[0])},
        from_{table.require_column(kLabelColumns[1])},
        to_{table.require_column(kLabelColumns[2])},
        kind_{table.find_column(kLabelColumns[3])} {}

  void read(const CsvRow& row, Labels& labels) const {
    const std::string name = table_.text(row, log_);
    const auto found = labels.logs.find(name);
    if (found == labels.logs.end())
      table_.fail(row, log_, "\"" + name + "\" is no log of this folder; correct the name or add the log");
    LabelledLog& log = found->second;
    const bool sound = is_sound(row);
    if (const auto before = labels.sound_on_line.find(name); before != labels.sound_on_line.end())
      table_.fail(row, log_, name + " is free of chatter by line " + std::to_string(before->second) + "; remove one");
    if (sound && !log.stretches.empty())
      table_.fail(row, from_,
                  "is empty, but line " + std::to_string(log.lines.front()) + " says where " + name + " chatters");
    if (sound) {
      labels.sound_on_line[name] = row.line;
      return;
    }
    const ChatterStretch stretch = read_stretch(row);
    for (std::size_t i = 0; i < log.stretches.size(); ++i) {
      const ChatterStretch& other = log.stretches[i];
      const bool overlap = stretch.time.from_s < other.time.to_s && other.time.from_s < stretch.time.to_s;
      if (overlap && stretch.kind == other.kind)
        table_.fail(row, from_, "overlaps the stretch of line " + std::to_string(log.lines[i]) + "; make one of them");
    }
    const auto at = std::upper_bound(
        log.stretches.begin(), log.stretches.end(), stretch,
        [](const ChatterStretch& a, const ChatterStretch& b) { return a.time.from_s < b.time.from_s; });
    log.lines.insert(log.lines.begin() + (at - log.stretches.begin()), row.line);
    log.stretches.insert(at, stretch);
  }

 private:
  [[nodiscard]] bool is_sound(const CsvRow& row) const {
    const bool no_from = table_.text(row, from_).empty(), no_to = table_.text(row, to_).empty();
    if (no_from != no_to)
      table_.fail(row, no_from ? from_ : to_, "is empty; give both times, or neither for a log without chatter");
    if (no_from && kind_ && !table_.text(row, *kind_).empty())
      table_.fail(row, *kind_, "a log without chatter has no kind; give from_s and to_s, or leave kind empty");
    return no_from;
  }

  [[nodiscard]] ChatterStretch read_stretch(const CsvRow& row) const {
    ChatterStretch stretch;
    stretch.time = {table_.number(row, from_), table_.number(row, to_)};
    if (stretch.time.from_s < 0.0) table_.fail(row, from_, "is before the log's first frame; give 0 or more");
    if (stretch.time.to_s <= stretch.time.from_s) table_.fail(row, to_, "is not after from_s; correct one of them");
    const std::string kind = kind_ ? table_.text(row, *kind_) : "";
    if (kind == "regenerative") stretch.kind = ChatterKind::regenerative;
    if (kind == "structural") stretch.kind = ChatterKind::structural;
    if (stretch.kind == ChatterKind::unknown && kind != "unknown" && !kind.empty())
      table_.fail(row, *kind_, "\"" + kind + "\" is no kind; write regenerative, structural, unknown or nothing");
    return stretch;
  }

  const CsvTable& table_;
  std::size_t log_, from_, to_;
  std::optional<std::size_t> kind_;
};

}  // namespace

std::vector<LabelledLog> read_labelled_logs(const std::filesystem::path& folder) {
  Labels labels{.logs = logs_in(folder), .sound_on_line = {}};
  const CsvTable table = read_csv(folder / kLabelsFile);
  check_column_names(table, kLabelColumns);
  const LabelReader reader{table};
  if (table.rows().empty())
    throw InputError(table.file(), table.header_line(), "no label follows the header; list every log of the folder");
  for (const CsvRow& row : table.rows()) reader.read(row, labels);

  std::vector<LabelledLog> logs;
  for (auto& [name, log] : labels.logs) {
    if (log.stretches.empty() && !labels.sound_on_line.contains(name))
      throw InputError(table.file(), table.header_line(),
                       "log: " + name + " is not listed; give its stretches, or a row \"" + csv_text(name) +
                           (table.find_column("kind") ? ",,," : ",,") + "\" if it has no chatter");
    logs.push_back(std::move(log));
  }
  return logs;
}

void check_labels_end(const std::filesystem::path& folder, const LabelledLog& log, double duration_s) {
  for (std::size_t i = 0; i < log.stretches.size(); ++i) {
    if (log.stretches[i].time.to_s <= duration_s + kEndTolerance_s) continue;
    throw InputError((folder / kLabelsFile).string(), log.lines[i],
                     "to_s: " + csv_number(log.stretches[i].time.to_s) + " is beyond the end of " +
                         log.file.filename().string() + ", which is " + csv_number(duration_s) + " s long; correct it");
  }
}

}  // namespace stillcut
