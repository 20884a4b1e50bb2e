#include "tools/recording_folder.hpp"

#include <sys/statvfs.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <set>

namespace stillcut {
namespace {

namespace fs = std::filesystem;

constexpr double kMib = 1024.0 * 1024.0;
constexpr double kRoomForASegment = 16.0 * kMib;
constexpr const char *kCan = ".can.log", *kLcm = ".lcm.log", *kMark = ".mark", *kZst = ".zst";
constexpr std::size_t kDigits = 6;

struct SegmentName {
  std::string recording;
  int number = 0;
};

// "NAME-000012" of a file NAME-000012.can.log[.zst]; empty for other files.
std::string stem_of(const std::string& file) {
  const auto dot = file.find(kCan) != std::string::npos ? file.find(kCan) : file.find(kLcm);
  return dot == std::string::npos ? std::string{} : file.substr(0, dot);
}

std::optional<SegmentName> parse_stem(const std::string& stem) {
  if (stem.size() < kDigits + 2 || stem[stem.size() - kDigits - 1] != '-') return std::nullopt;
  const std::string digits = stem.substr(stem.size() - kDigits);
  if (!std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; })) return std::nullopt;
  return SegmentName{stem.substr(0, stem.size() - kDigits - 1), std::stoi(digits)};
}

std::set<std::string> stems_in(const fs::path& folder) {
  std::set<std::string> stems;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator{folder, error}) {
    const std::string stem = stem_of(entry.path().filename().string());
    if (parse_stem(stem)) stems.insert(stem);
  }
  return stems;
}

std::int64_t size_of(const fs::path& file) {
  std::error_code error;
  const auto size = fs::file_size(file, error);
  return error ? 0 : static_cast<std::int64_t>(size);
}

}  // namespace

std::string recording_name(std::int64_t realtime_ns) {
  const std::time_t seconds = realtime_ns / 1'000'000'000;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y%m%d-%H%M%S", &utc);
  return text.data();
}

RecordedSegments find_segments(const fs::path& place) {
  const bool is_folder = fs::is_directory(place);
  const fs::path folder = is_folder ? place : place.has_parent_path() ? place.parent_path() : fs::path{"."};
  std::map<std::string, std::vector<std::string>> stems;  // by recording
  for (const std::string& stem : stems_in(folder)) stems[parse_stem(stem)->recording].push_back(stem);
  const auto found = is_folder && !stems.empty() ? std::prev(stems.end()) : stems.find(place.filename().string());
  if (found == stems.end())
    throw InputError(place.string(), 0,
                     "no log and no recording is there; a recording's files are NAME-000001.can.log.zst and so on");
  RecordedSegments segments;
  segments.name = found->first;
  segments.others = static_cast<int>(stems.size()) - 1;
  segments.from_the_start = parse_stem(found->second.front())->number == 1;
  for (const std::string& stem : found->second) {
    for (const auto& [kind, list] : {std::pair{kCan, &segments.can}, std::pair{kLcm, &segments.lcm}}) {
      for (const char* ending : {kZst, ""}) {
        const fs::path file = folder / (stem + kind + ending);
        if (!fs::exists(file)) continue;
        list->push_back(file);
        break;
      }
    }
  }
  return segments;
}

RecordingFolder::RecordingFolder(RecordingSettings settings, std::string name)
    : settings_{std::move(settings)}, name_{std::move(name)} {
  std::error_code error;
  fs::create_directories(settings_.folder, error);
  if (!fs::is_directory(settings_.folder, error))
    throw InputError(settings_.folder.string(), 0,
                     "cannot be made a folder for recordings; check the path and its rights");
  list_earlier();
}

RecordingFolder::~RecordingFolder() = default;

fs::path RecordingFolder::file(const std::string& stem, const char* kind) const {
  return settings_.folder / (stem + kind);
}

// Segments of earlier runs count in the bounds, and are the oldest. A run of this very second takes another name.
void RecordingFolder::list_earlier() {
  for (const std::string& stem : stems_in(settings_.folder)) {
    Segment segment{.stem = stem, .start_s = -std::numeric_limits<double>::infinity()};
    segment.end_s = segment.start_s;
    for (const char* kind : {kCan, kLcm})
      segment.bytes += size_of(file(stem, kind)) + size_of(file(stem, (std::string(kind) + kZst).c_str()));
    segment.marked = fs::exists(file(stem, kMark));
    if (parse_stem(stem)->recording == name_) name_ += "b";
    segments_.push_back(segment);
  }
}

bool RecordingFolder::begin(double now_s) {
  close(now_s);
  std::array<char, 16> number{};
  std::snprintf(number.data(), number.size(), "-%06d", ++number_);
  Segment segment{.stem = name_ + number.data(), .start_s = now_s, .end_s = now_s};
  can_ = std::make_unique<CompressedFile>(file(segment.stem, ".can.log.zst"));
  lcm_ = std::make_unique<CompressedFile>(file(segment.stem, ".lcm.log.zst"));
  error_ = can_->error() != 0 ? can_->error() : lcm_->error();
  segments_.push_back(segment);
  if (now_s <= marked_until_s_) write_mark(segments_.back(), why_marked_);
  if (error_ != 0) close(now_s);
  return error_ == 0;
}

void RecordingFolder::close(double now_s) {
  if (!is_open()) return;
  can_->close();
  lcm_->close();
  if (error_ == 0) error_ = can_->error() != 0 ? can_->error() : lcm_->error();
  Segment& segment = segments_.back();
  segment.end_s = now_s;
  segment.bytes = can_->bytes_on_disk() + lcm_->bytes_on_disk();
  closed_bytes_ += segment.bytes;
  can_.reset();
  lcm_.reset();
}

bool RecordingFolder::flush(double now_s) {
  can_->flush();
  lcm_->flush();
  error_ = can_->error() != 0 ? can_->error() : lcm_->error();
  segments_.back().bytes = can_->bytes_on_disk() + lcm_->bytes_on_disk();
  delete_what_is_too_much(now_s);
  return error_ == 0;
}

void RecordingFolder::mark(std::string_view why, double now_s) {
  for (Segment& segment : segments_) {
    const bool is_current = is_open() && &segment == &segments_.back();
    if (is_current || segment.end_s >= now_s - settings_.mark_before_s) write_mark(segment, why);
  }
  marked_until_s_ = now_s + settings_.mark_after_s;
  why_marked_ = why;
}

// A mark that cannot be written is none that outlives the run; this run keeps it.
void RecordingFolder::write_mark(Segment& segment, std::string_view why) {
  if (!segment.marked) std::ofstream{file(segment.stem, kMark)} << why << '\n';
  segment.marked = true;
}

void RecordingFolder::delete_what_is_too_much(double now_s) {
  double marked = 0.0, unmarked = 0.0;  // bytes
  for (const Segment& segment : segments_) (segment.marked ? marked : unmarked) += static_cast<double>(segment.bytes);
  for (std::size_t i = 0; i + 1 < segments_.size();) {  // never the one being written
    const Segment& segment = segments_[i];
    double& total = segment.marked ? marked : unmarked;
    const double bound = kMib * (segment.marked ? settings_.keep_marked_mib : settings_.keep_mib);
    const bool no_mark_can_come =
        settings_.only_marks && !segment.marked && segment.end_s < now_s - settings_.mark_before_s;
    if (total <= bound && !no_mark_can_come) {
      ++i;
      continue;
    }
    remove(segment);
    total -= static_cast<double>(segment.bytes);
    segments_.erase(segments_.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

void RecordingFolder::remove(const Segment& segment) const {
  std::error_code error;
  for (const char* kind : {".can.log", ".can.log.zst", ".lcm.log", ".lcm.log.zst", kMark})
    fs::remove(file(segment.stem, kind), error);
}

std::int64_t RecordingFolder::bytes_written() const {
  return closed_bytes_ + (is_open() ? can_->bytes_on_disk() + lcm_->bytes_on_disk() : 0);
}

bool RecordingFolder::has_room() const {
  struct statvfs disk {};
  if (statvfs(settings_.folder.c_str(), &disk) != 0) return false;
  return static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize) > kRoomForASegment;
}

}  // namespace stillcut
