// Reads the robot's messages from a log that lcm-logger or the recorder wrote, for playback; writes such a log's
// events.
//
// An event of the file is, all big endian: the word 0xEDA1DA01, event number (8 bytes), time in microseconds (8),
// length of the channel's name (4), length of the data (4), name, data. A damaged part is skipped up to the next event.
#pragma once

#include <cstdint>
#include <filesystem>
#include <istream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "drivers/lcm/messages.hpp"

namespace stillcut {

using RobotMessage = std::variant<RobotState, CorrectionAck, RobotPath>;  // stamp_ns: the time of the log's event

struct LcmLogEvent {
  std::int64_t stamp_ns = 0;
  std::string channel;
  MessageBytes data;  // of ROBOT_... and STILLCUT_... only
};

// Appends one event of a log to `log`.
void append_lcm_event(std::string& log, std::int64_t number, std::int64_t stamp_ns, std::string_view channel,
                      std::span<const std::uint8_t> data);

class LcmLogReader {
 public:
  // A name that ends in .zst is compressed (zstd), and then read into memory whole. Throws InputError when the file is
  // missing, a folder, unreadable, or holds no whole event at all.
  explicit LcmLogReader(const std::filesystem::path& file);

  // The next message on ROBOT_STATE, ROBOT_ACK or ROBOT_PATH, in the file's order; nothing at its end.
  std::optional<RobotMessage> next();

  // The next event of any channel.
  std::optional<LcmLogEvent> next_event();

  // Takes note of a message that its user cannot trust.
  void count_bad() noexcept { ++bad_; }

  [[nodiscard]] std::int64_t events() const noexcept { return events_; }  // whole ones, of every channel
  // Damaged parts (a last event cut short too), and robot messages that cannot be trusted.
  [[nodiscard]] std::int64_t bad() const noexcept { return bad_; }

 private:
  std::optional<LcmLogEvent> read_event_here();
  void skip_to_sync_word();
  bool read_at(std::int64_t position, std::span<std::uint8_t> bytes);

  std::unique_ptr<std::istream> in_;
  std::int64_t position_ = 0;  // of the next event
  std::int64_t size_ = 0;
  std::int64_t events_ = 0;
  std::int64_t bad_ = 0;
};

}  // namespace stillcut
