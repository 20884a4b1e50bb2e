// A recording on the disk: a folder with segments NAME-000001.can.log.zst and NAME-000001.lcm.log.zst, one after the
// other, NAME the time at which the run began. Segments are of one length; the oldest are deleted when the folder is
// full, except those about a mark (a file NAME-000001.mark beside them says why), which have a bound of their own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/files/cell.hpp"
#include "drivers/files/compressed_file.hpp"

namespace stillcut {

// "20261126-104500", in UTC.
std::string recording_name(std::int64_t realtime_ns);

// The segments of one recording, in order, as playback takes them.
struct RecordedSegments {
  std::string name;
  std::vector<std::filesystem::path> can, lcm;
  bool from_the_start = false;  // the first segment is still there
  int others = 0;               // recordings in the same folder
};

// `place`: the recording's folder (the newest recording in it), or FOLDER/NAME. Throws InputError when there is none.
RecordedSegments find_segments(const std::filesystem::path& place);

// Times are seconds on any clock that only rises.
class RecordingFolder {
 public:
  // Makes the folder if need be; no segment yet. Throws InputError.
  RecordingFolder(RecordingSettings settings, std::string name);
  ~RecordingFolder();

  // Begins the next segment. False when that failed: see error().
  bool begin(double now_s);
  bool is_open() const { return can_ != nullptr; }
  bool write_can(std::string_view lines) { return can_->write(lines); }
  bool write_lcm(std::string_view events) { return lcm_->write(events); }
  // All that was written is on the disk, and what is too much is deleted.
  bool flush(double now_s);
  void close(double now_s);

  [[nodiscard]] bool is_due(double now_s) const { return now_s - segments_.back().start_s >= settings_.segment_s; }
  void mark(std::string_view why, double now_s);

  [[nodiscard]] int number() const { return number_; }  // of the newest segment
  [[nodiscard]] int error() const { return error_; }    // errno of what failed last; 0: nothing
  [[nodiscard]] std::int64_t bytes_written() const;     // compressed, of this run
  [[nodiscard]] bool has_room() const;                  // for a new segment
  [[nodiscard]] const std::filesystem::path& folder() const { return settings_.folder; }

 private:
  struct Segment {
    std::string stem;  // NAME-000001
    double start_s = 0.0, end_s = 0.0;
    std::int64_t bytes = 0;
    bool marked = false;
  };

  void list_earlier();
  void write_mark(Segment& segment, std::string_view why);
  void delete_what_is_too_much(double now_s);
  void remove(const Segment& segment) const;
  [[nodiscard]] std::filesystem::path file(const std::string& stem, const char* kind) const;

  RecordingSettings settings_;
  std::string name_;
  int number_ = 0;
  int error_ = 0;
  std::unique_ptr<CompressedFile> can_, lcm_;
  std::vector<Segment> segments_;  // oldest first; the last is being written while is_open()
  double marked_until_s_ = -1.0;
  std::string why_marked_;
  std::int64_t closed_bytes_ = 0;
};

}  // namespace stillcut
