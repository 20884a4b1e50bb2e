#include <algorithm>
#include <cstring>
#include <utility>

#include "drivers/can/candump_log.hpp"
#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {
constexpr std::size_t kBufferBytes = std::size_t{1} << 20;
}

CandumpReader::CandumpReader(const std::filesystem::path& file, std::string interface, Load load)
    : file_(file.string()), only_interface_(std::move(interface)), buffer_(kBufferBytes) {
  if (!source_.open(file))
    throw InputError(file_, 0, std::string("cannot be opened: ") + std::strerror(source_.error()));
  if (load == Load::whole) load_whole();
  first_pending_ = next_frame(first_);
  if (first_pending_) return;
  if (read_error_ != 0) throw InputError(file_, 0, std::string("cannot be read: ") + std::strerror(read_error_));
  if (frames_ > 0) throw InputError(file_, 0, "no frame of interface '" + only_interface_ + "' in this log");
  throw InputError(file_, 0, "not one valid frame; a CAN log is what `candump -L` writes");
}

CandumpReader::~CandumpReader() = default;

void CandumpReader::load_whole() {
  while (!at_end_) {
    if (end_ == buffer_.size()) buffer_.resize(2 * buffer_.size());
    end_ += read_some(buffer_.data() + end_, buffer_.size() - end_);
  }
  source_.close();
}

std::size_t CandumpReader::read_some(char* to, std::size_t bytes) noexcept {
  const std::size_t got = source_.read(to, bytes);
  if (got == 0) {
    read_error_ = source_.error();
    at_end_ = true;
  }
  return got;
}

// A line that does not fit the buffer is no frame whatever it holds: it comes in pieces, all but the last not complete.
bool CandumpReader::next_line(std::string_view& line, bool& complete) noexcept {
  std::size_t searched = 0;
  for (;;) {
    const char* begin = buffer_.data() + begin_;
    const std::size_t waiting = end_ - begin_;
    if (const void* found = std::memchr(begin + searched, '\n', waiting - searched); found != nullptr) {
      line = {begin, static_cast<std::size_t>(static_cast<const char*>(found) - begin)};
      begin_ += line.size() + 1;
      complete = true;
      return true;
    }
    if (at_end_ || waiting == buffer_.size()) {
      line = {begin, waiting};
      begin_ = end_;
      complete = false;
      return waiting > 0;
    }
    searched = waiting;
    std::memmove(buffer_.data(), begin, waiting);
    begin_ = 0;
    end_ = waiting + read_some(buffer_.data() + waiting, buffer_.size() - waiting);
  }
}

bool CandumpReader::next_frame(CanFrame& frame) noexcept {
  std::string_view line;
  bool complete = true;
  while (next_line(line, complete)) {
    const bool rest_of_long_line = std::exchange(in_long_line_, !complete);
    if (rest_of_long_line) continue;
    ++line_number_;
    const CandumpLine kind = parse_candump_line(line, frame, &interface_);
    if (kind == CandumpLine::nothing) continue;
    if (kind == CandumpLine::bad || !complete) {
      count_bad(line, complete);
      continue;
    }
    ++frames_;
    if (only_interface_.empty() || interface_ == only_interface_) return true;
  }
  return false;
}

bool CandumpReader::next(CanFrame& frame) noexcept {
  if (!first_pending_) return next_frame(frame);
  first_pending_ = false;
  frame = first_;
  return true;
}

void CandumpReader::count_bad(std::string_view line, bool complete) noexcept {
  if (frames_bad_++ > 0) return;
  first_bad_line_ = line_number_;
  first_bad_complete_ = complete;
  const std::size_t length = std::min(line.size(), first_bad_text_.size() - 1);
  std::transform(line.begin(), line.begin() + length, first_bad_text_.begin(),
                 [](char c) { return c >= ' ' && c <= '~' ? c : '?'; });
}

std::string CandumpReader::warning() const {
  if (read_error_ != 0) return file_ + ": reading stopped: " + std::strerror(read_error_);
  if (frames_bad_ == 0) return {};
  const std::string lines = frames_bad_ == 1 ? "one line is" : std::to_string(frames_bad_) + " lines are";
  return file_ + ":" + std::to_string(first_bad_line_) + ": " + lines + " no CAN frame and passed over; the first " +
         (first_bad_complete_ ? "reads" : "was cut short") + ": " + first_bad_text_.data();
}

}  // namespace stillcut
