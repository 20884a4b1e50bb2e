// Where a signal's bits lie in a CAN frame, in both byte orders of DBC files, and how to read and write them.
//
// Intel (little endian, "@1"): `start` is the least significant bit, counted through the frame byte by byte, bit 0 of a
// byte first. Motorola (big endian, "@0"): `start` is the most significant bit in the same count; the signal goes on
// towards bit 0 of its byte and then from bit 7 of the next byte.
#pragma once

#include <cstdint>

namespace stillcut {

struct BitField {
  std::uint16_t start = 0;
  std::uint8_t length = 0;  // 1..64
  bool little_endian = true;
};

// Bits from the frame's first one to the field's last one in transmission order; the field needs this many of 8 *
// bytes.
constexpr int end_bit(BitField field) noexcept {
  const int first = field.little_endian ? field.start : (field.start & ~7) + 7 - (field.start & 7);
  return first + field.length;
}
constexpr int bytes_needed(BitField field) noexcept { return (end_bit(field) + 7) / 8; }

constexpr std::uint64_t bit_mask(int length) noexcept { return length >= 64 ? ~0ULL : (1ULL << length) - 1; }

// The field as an unsigned number. `data` holds at least bytes_needed(field) bytes.
constexpr std::uint64_t read_bits(const std::uint8_t* data, BitField field) noexcept {
  const int first_byte = field.start / 8;
  const int last_byte = bytes_needed(field) - 1;  // at most 8 further: a field of 64 bits may touch 9 bytes
  std::uint64_t value = 0;
  if (field.little_endian) {
    const int shift = field.start & 7;
    for (int i = last_byte; i > first_byte; --i) value = value << 8 | data[i];
    value = value << (8 - shift) | data[first_byte] >> shift;
  } else {
    const int shift = (8 - (end_bit(field) & 7)) & 7;  // bits of the last byte that follow the field
    for (int i = first_byte; i < last_byte; ++i) value = value << 8 | data[i];
    value = value << (8 - shift) | data[last_byte] >> shift;
  }
  return value & bit_mask(field.length);
}

// Puts the low bits of `value` into the field and leaves all other bits as they are.
constexpr void write_bits(std::uint8_t* data, BitField field, std::uint64_t value) noexcept {
  int bit = field.start;
  for (int i = 0; i < field.length; ++i) {
    const int from = field.little_endian ? i : field.length - 1 - i;
    const auto mask = static_cast<std::uint8_t>(1U << (bit & 7));
    data[bit / 8] = static_cast<std::uint8_t>((value >> from & 1U) != 0 ? data[bit / 8] | mask : data[bit / 8] & ~mask);
    if (field.little_endian) {
      ++bit;
    } else {
      bit = (bit & 7) == 0 ? bit + 15 : bit - 1;
    }
  }
}

// Two's complement of `length` bits.
constexpr std::int64_t sign_extend(std::uint64_t raw, int length) noexcept {
  const std::uint64_t sign = 1ULL << (length - 1);
  return static_cast<std::int64_t>((raw ^ sign) - sign);
}

}  // namespace stillcut
