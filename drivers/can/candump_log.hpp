// CAN logs as `candump -L` (can-utils) writes them: one text line a frame, "(seconds.microseconds) interface id#data".
// Here one line becomes a CanFrame and back, and a reader walks through a whole file.
//
//   (1500000000.003000) can0 123#1122            classic frame, 3 hexadecimal digits: 11-bit identifier
//   (1500000000.003020) can0 18FEF100#1122       8 digits: 29-bit identifier
//   (1500000000.003040) can0 120##1AABB          CAN FD; the digit after ## holds the flags (1 BRS, 2 ESI, 4 FDF)
//   (1500000000.003060) can0 123#R4              remote frame
//   (1500000000.003080) can0 20000040#00..       error frame: 8 digits with 0x20000000 set
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/files/byte_source.hpp"
#include "rt/can_frame.hpp"

namespace stillcut {

enum class CandumpLine : std::uint8_t {
  frame,    // `frame` was filled
  nothing,  // blank, or a comment that begins with '#': not an error
  bad
};

// Parses one line without its line feed. Trailing direction tokens (" R", " T", as asc2log and python-can write) and a
// carriage return are accepted. Stamps may have up to 9 decimals and are cut to whole microseconds.
// `interface`, when asked for, is a view into `line`. Any thread; no allocation.
CandumpLine parse_candump_line(std::string_view line, CanFrame& frame, std::string_view* interface = nullptr) noexcept;

inline constexpr std::size_t kMaxCandumpLine = 224;      // longest line that format_candump_line writes
inline constexpr std::size_t kMaxCandumpInterface = 32;  // longer interface names are cut

// Writes one line with its line feed and returns its length. Parsing it gives the same frame, bit for bit, as long as
// the stamp is a whole number of microseconds and not negative. Any thread; no allocation.
std::size_t format_candump_line(const CanFrame& frame, std::string_view interface,
                                std::span<char, kMaxCandumpLine> line) noexcept;

// Walks through a log file, frame after frame in the file's order; stamps that go back are delivered as they are. Lines
// that are no frame are counted and passed over, and so is a last line without a line end: it was cut short.
// One thread at a time.
class CandumpReader {
 public:
  enum class Load : std::uint8_t {
    streaming,  // through a buffer of 1 MiB: logs of any length, pipes too
    whole       // all of the file is in memory when the constructor returns: next() then makes no system call
  };

  // A name that ends in .zst is compressed (zstd). `interface`: deliver only its frames; empty: the frames of all
  // interfaces. Throws InputError when the file cannot be read or holds not one valid frame.
  explicit CandumpReader(const std::filesystem::path& file, std::string interface = {}, Load load = Load::streaming);
  ~CandumpReader();
  CandumpReader(const CandumpReader&) = delete;
  CandumpReader& operator=(const CandumpReader&) = delete;

  // The next frame; false at the end of the file. Allocates nothing.
  bool next(CanFrame& frame) noexcept;

  // Interface of the frame that next() delivered last; valid until the following call of next().
  [[nodiscard]] std::string_view interface() const noexcept { return interface_; }
  [[nodiscard]] std::int64_t frames() const noexcept { return frames_; }
  [[nodiscard]] std::int64_t frames_bad() const noexcept { return frames_bad_; }

  // One line for the user about what was passed over so far, naming the first bad line; empty when all is well.
  [[nodiscard]] std::string warning() const;

 private:
  bool next_line(std::string_view& line, bool& complete) noexcept;
  bool next_frame(CanFrame& frame) noexcept;
  std::size_t read_some(char* to, std::size_t bytes) noexcept;
  void load_whole();
  void count_bad(std::string_view line, bool complete) noexcept;

  std::string file_;
  std::string only_interface_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;  // unread part of the buffer
  ByteSource source_;
  int read_error_ = 0;  // errno that ended the reading
  bool at_end_ = false;
  bool in_long_line_ = false;
  bool first_pending_ = false;  // the constructor has read the first frame already
  CanFrame first_;
  std::string_view interface_;
  std::int64_t line_number_ = 0, frames_ = 0, frames_bad_ = 0;
  std::int64_t first_bad_line_ = 0;
  bool first_bad_complete_ = true;
  std::array<char, 60> first_bad_text_{};
};

}  // namespace stillcut
