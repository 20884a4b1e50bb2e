// What the encoding of every LCM type needs. For the .cpp files that see the generated classes.
#pragma once

#include <cstdint>
#include <span>

#include "drivers/lcm/messages.hpp"

namespace stillcut {

inline constexpr std::int64_t kNsPerUs = 1000;

// Whole microseconds; rounds down, as stamps before 1970 would show.
constexpr std::int64_t to_us(std::int64_t ns) { return ns / kNsPerUs - (ns % kNsPerUs < 0 ? 1 : 0); }
constexpr bool is_time(std::int64_t us) { return us >= -kLastUs && us <= kLastUs; }

template <class Message>
MessageBytes to_bytes(const Message& message) {
  MessageBytes bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

// The four bytes at a place, as LCM writes a count or a length; the caller sees to it that they are there. The
// generated code makes as many elements as they ask for before it looks at the bytes, so they are looked at first.
inline std::size_t count_at(std::span<const std::uint8_t> bytes, std::size_t place) {
  std::size_t count = 0;
  for (const std::uint8_t byte : bytes.subspan(place, 4)) count = count << 8 | byte;
  return count;
}

// `message` comes as its default. False when the bytes are of another type, cut short or too long.
template <class Message>
bool decode_whole(std::span<const std::uint8_t> bytes, Message& message) {
  const int size = static_cast<int>(bytes.size());
  return message.decode(bytes.data(), 0, size) == size;
}

}  // namespace stillcut
