#include "tools/recorded_frames.hpp"

#include <algorithm>

#include "drivers/files/input_error.hpp"
#include "tools/recording_folder.hpp"

namespace stillcut {
namespace {

constexpr double kCompression = 6.0;  // of candump logs, about

}  // namespace

PlaybackFiles playback_files(const std::string& can, const std::string& lcm) {
  PlaybackFiles files;
  std::error_code error;
  const bool is_file = std::filesystem::exists(can, error) && !std::filesystem::is_directory(can, error);
  if (is_file || !(std::filesystem::is_directory(can, error) || can.find('/') != std::string::npos)) {
    files.can = {can};
  } else {
    const bool name_of_none = !std::filesystem::is_directory(can, error) &&
                              !std::filesystem::is_directory(std::filesystem::path{can}.parent_path(), error);
    if (name_of_none) return {.can = {can}, .lcm = {}, .note = {}};
    RecordedSegments found = find_segments(can);
    files = {std::move(found.can), std::move(found.lcm), found.from_the_start, {}};
    if (found.others > 0 && std::filesystem::is_directory(can, error))
      files.note = can + ": the newest of " + std::to_string(found.others + 1) + " recordings, " + found.name +
                   "; name another as FOLDER/NAME";
  }
  if (!lcm.empty()) files.lcm = {lcm};
  return files;
}

void refuse_to_overwrite(const PlaybackFiles& files, std::initializer_list<std::string> outputs) {
  std::error_code not_there;
  for (const std::string& output : outputs)
    for (const auto* logs : {&files.can, &files.lcm})
      for (const std::filesystem::path& log : *logs)
        if (!output.empty() && std::filesystem::equivalent(output, log, not_there))
          throw InputError(output, 0, "is of the recording that is to be played; name another file to write");
}

RecordedFrames::RecordedFrames(const std::vector<std::filesystem::path>& logs)
    : logs_(logs.begin(), logs.end()), single_{logs.size() == 1} {
  std::error_code no_size;  // a pipe has none
  for (const auto& log : logs) {
    const auto size = std::filesystem::file_size(log, no_size);
    if (!no_size) bytes_ += static_cast<double>(size) * (is_compressed(log) ? kCompression : 1.0);
  }
  bytes_ = std::max(bytes_, 1.0);
  const std::string first = logs.empty() ? std::string{} : logs.front().string();
  if (!open_next()) throw InputError(first, 0, "not one valid frame in this recording");
}

// A segment without a frame is one of silence, or the last one after a crash.
bool RecordedFrames::open_next() {
  while (!logs_.empty()) {
    const std::filesystem::path log = logs_.front();
    logs_.pop_front();
    try {
      log_ = std::make_unique<CandumpReader>(log);
      return true;
    } catch (const InputError&) {
      if (single_) throw;
    }
  }
  return false;
}

bool RecordedFrames::next(CanFrame& frame) {
  while (log_) {
    if (log_->next(frame)) return true;
    frames_ += log_->frames();
    frames_bad_ += log_->frames_bad();
    if (warning_.empty()) warning_ = log_->warning();
    log_.reset();
    open_next();
  }
  return false;
}

std::string RecordedFrames::warning() const { return warning_.empty() && log_ ? log_->warning() : warning_; }

}  // namespace stillcut
