// A recorded exchange: what an adapter got and gave, with times, as text. Written by --record; played through the
// adapter's own code again it must give the same bytes, so a field problem becomes a test.
//
// One line an entry: the time in ns, what it is, its bytes. Bytes are written as they are where they are printable and
// as \xNN otherwise (a backslash too). Lines that start with # are comments.
#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adapters/correction_follower.hpp"

namespace stillcut {

enum class ExchangeKind { packet, answer, correction, ack, state };  // from and to the controller; from and to LCM

struct ExchangeEntry {
  std::int64_t time_ns = 0;
  ExchangeKind kind = ExchangeKind::packet;
  std::string bytes;  // of LCM messages the encoded ones
  bool operator==(const ExchangeEntry&) const = default;
};

std::string exchange_line(const ExchangeEntry& entry);  // without the line break
// Throws InputError with file and line.
std::vector<ExchangeEntry> read_exchange(const std::string& file);

// Writes entries while the adapter runs; does nothing without a file.
class ExchangeRecorder {
 public:
  ExchangeRecorder() = default;
  // Throws InputError when the file cannot be written.
  ExchangeRecorder(const std::string& file, const std::string& comment);

  void put(std::int64_t time_ns, ExchangeKind kind, std::string_view bytes);
  void put(std::int64_t time_ns, const Correction& correction);
  void put(std::int64_t time_ns, const Answer& answer);
  void put(std::int64_t time_ns, const RobotState& state);

 private:
  std::ofstream out_;
};

std::string_view text_of(std::span<const std::uint8_t> bytes);
std::span<const std::uint8_t> bytes_of(std::string_view text);

}  // namespace stillcut
