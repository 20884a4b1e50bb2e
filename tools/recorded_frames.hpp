// The frames of one candump log, or of all segments of a recording one after the other.
#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "drivers/can/candump_log.hpp"

namespace stillcut {

// What to play: logs in the order of their times.
struct PlaybackFiles {
  std::vector<std::filesystem::path> can, lcm;
  bool from_the_start = true;  // false: the beginning of the recording was deleted
  std::string note;            // one line for the user where there was a choice; empty: none
};

// `can`: a log, a recording's folder (its newest recording) or FOLDER/NAME; `lcm`: a log, or empty. Throws InputError.
PlaybackFiles playback_files(const std::string& can, const std::string& lcm);

// Throws InputError where one of the `outputs` (empty: none) is a file that is to be played: opening it would empty it.
void refuse_to_overwrite(const PlaybackFiles& files, std::initializer_list<std::string> outputs);

class RecordedFrames {
 public:
  // Throws InputError when a single log has no valid frame, or none of several.
  explicit RecordedFrames(const std::vector<std::filesystem::path>& logs);

  bool next(CanFrame& frame);

  [[nodiscard]] std::int64_t frames() const { return frames_ + (log_ ? log_->frames() : 0); }
  [[nodiscard]] std::int64_t frames_bad() const { return frames_bad_ + (log_ ? log_->frames_bad() : 0); }
  // One line for the user about what was passed over; empty when all is well.
  [[nodiscard]] std::string warning() const;
  // Compressed and not: about what there is to read, for a progress bar.
  [[nodiscard]] double bytes() const { return bytes_; }

 private:
  bool open_next();

  std::deque<std::filesystem::path> logs_;
  bool single_;
  std::unique_ptr<CandumpReader> log_;
  std::int64_t frames_ = 0, frames_bad_ = 0;
  std::string warning_;
  double bytes_ = 0.0;
};

}  // namespace stillcut
