// The folder that `stillcut tune` learns from: candump logs and labels.csv, which says where in them the tool
// chattered.
#pragma once

#include <filesystem>
#include <vector>

#include "tools/tuning_score.hpp"

namespace stillcut {

struct LabelledLog {
  std::filesystem::path file;
  std::vector<ChatterStretch> stretches;  // in the order of their beginnings; none: the log is free of chatter
  std::vector<int> lines;                 // of labels.csv, one a stretch
};

inline constexpr const char* kLabelsFile = "labels.csv";

// All *.log of the folder, by name. Columns of labels.csv: log,from_s,to_s,kind; one row a stretch, seconds after the
// log's first frame, kind regenerative, structural, unknown or empty; a log without chatter has one row with both times
// empty. Throws InputError with file and line, also for a log that is not listed: to forget one is not to call it
// sound.
std::vector<LabelledLog> read_labelled_logs(const std::filesystem::path& folder);

// Throws InputError where a stretch lies beyond its log's end: then the label belongs to another log or clock.
void check_labels_end(const std::filesystem::path& folder, const LabelledLog& log, double duration_s);

}  // namespace stillcut
