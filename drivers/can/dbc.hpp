// DBC files: which messages a CAN bus carries and where each signal stands in them. The subset that sensors and drives
// use: messages (BO_), signals (SG_: both byte orders, sign, factor, offset, range, unit, simple multiplexing), float
// signals (SIG_VALTYPE_), names of values (VAL_), comments (CM_), and the attributes VFrameFormat and GenMsgCycleTime
// (BA_).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/can/signal_bits.hpp"

namespace stillcut {

enum class ValueType : std::uint8_t { unsigned_integer, signed_integer, float32, float64 };

struct DbcSignal {
  std::string name;
  BitField bits;
  ValueType type = ValueType::unsigned_integer;
  double factor = 1.0, offset = 0.0;    // physical value = raw * factor + offset
  double minimum = 0.0, maximum = 0.0;  // of the physical value; both 0: not told
  std::string unit;                     // in the file's own character set
  bool multiplexer = false;             // its value selects which multiplexed signals the frame holds
  std::int64_t multiplexed = -1;        // present only when the multiplexer has this value; -1: always present
  std::vector<std::pair<std::int64_t, std::string>> value_names;
  std::string comment;
  int line = 0;  // where it stands in the file
};

struct DbcMessage {
  std::uint32_t id = 0;  // with CanFrame::kExtended for a 29-bit identifier
  std::string name;
  int length = 0;         // bytes
  bool fd = false;        // VFrameFormat says CAN FD, or longer than 8 bytes
  int cycle_time_ms = 0;  // GenMsgCycleTime; 0: not told
  std::vector<DbcSignal> signals;
  std::string comment;
  int line = 0;

  [[nodiscard]] const DbcSignal* find(std::string_view signal) const;
};

struct Dbc {
  std::string file;
  std::vector<DbcMessage> messages;
  std::vector<std::string> warnings;  // one line each: what was passed over

  [[nodiscard]] const DbcMessage* find(std::string_view message) const;
};

// Reads a DBC file. Throws InputError with file and line for a file that cannot be read, a malformed message or signal,
// a signal that does not fit its message, and a message or signal that is there twice.
Dbc read_dbc(const std::filesystem::path& file);

// The same for text at hand; `file` is the name used in messages.
Dbc parse_dbc(std::string_view text, const std::string& file);

}  // namespace stillcut
