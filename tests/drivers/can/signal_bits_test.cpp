#include "drivers/can/signal_bits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

namespace stillcut {
namespace {

using Data = std::array<std::uint8_t, 64>;

// Oracle: the frame's bits one after the other, the least significant bit of the signal first, as DBC numbers them.
std::vector<int> bit_numbers(BitField field) {
  std::vector<int> numbers;
  int bit = field.start;
  for (int i = 0; i < field.length; ++i) {
    numbers.push_back(bit);
    if (field.little_endian) {
      ++bit;
    } else {
      bit = bit % 8 == 0 ? bit + 15 : bit - 1;  // from bit 0 of a byte to bit 7 of the next one
    }
  }
  if (!field.little_endian) return {numbers.rbegin(), numbers.rend()};
  return numbers;
}

std::uint64_t oracle(const Data& data, BitField field) {
  std::uint64_t value = 0;
  const std::vector<int> numbers = bit_numbers(field);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto bit = static_cast<std::size_t>(numbers[i]);
    value |= static_cast<std::uint64_t>(data[bit / 8] >> (bit % 8) & 1) << i;
  }
  return value;
}

BitField random_field(std::mt19937_64& random) {
  for (;;) {
    const BitField field{static_cast<std::uint16_t>(random() % 512), static_cast<std::uint8_t>(1 + random() % 64),
                         random() % 2 == 0};
    if (end_bit(field) <= 512) return field;
  }
}

Data random_data(std::mt19937_64& random) {
  Data data;
  for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random());
  return data;
}

TEST(SignalBits, ReadsAsBitByBitInBothOrders) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 100'000; ++i) {
    const BitField field = random_field(random);
    const Data data = random_data(random);
    ASSERT_EQ(read_bits(data.data(), field), oracle(data, field))
        << field.start << '|' << int{field.length} << '@' << field.little_endian;
  }
}

TEST(SignalBits, WritingThenReadingGivesTheValueAndSparesItsNeighbours) {
  std::mt19937_64 random(5);
  for (int i = 0; i < 20'000; ++i) {
    const BitField field = random_field(random);
    const Data before = random_data(random);
    Data data = before;
    const std::uint64_t value = random() & bit_mask(field.length);
    write_bits(data.data(), field, value);
    ASSERT_EQ(oracle(data, field), value);
    write_bits(data.data(), field, oracle(before, field));
    ASSERT_EQ(data, before);
  }
}

TEST(SignalBits, NeedsTheBytesThatItsLastBitLiesIn) {
  std::mt19937_64 random(6);
  for (int i = 0; i < 20'000; ++i) {
    const BitField field = random_field(random);
    int last = 0;
    for (const int bit : bit_numbers(field)) last = std::max(last, bit / 8);
    ASSERT_EQ(bytes_needed(field), last + 1);
  }
}

TEST(SignalBits, ReadsKnownMotorolaSignals) {
  const std::array<std::uint8_t, 8> data = {0x12, 0x34, 0x56, 0x78, 0x9A, 0xBC, 0xDE, 0xF0};
  EXPECT_EQ(read_bits(data.data(), {7, 16, false}), 0x1234U);  // whole bytes from the first
  EXPECT_EQ(read_bits(data.data(), {7, 24, false}), 0x123456U);
  EXPECT_EQ(read_bits(data.data(), {3, 8, false}), 0x23U);  // low half of byte 0, high half of byte 1
  EXPECT_EQ(read_bits(data.data(), {8, 1, false}), 0U);     // bit 0 of byte 1 (0x34)
  EXPECT_EQ(read_bits(data.data(), {10, 3, false}), 4U);    // low three bits of 0x34
  EXPECT_EQ(read_bits(data.data(), {7, 64, false}), 0x123456789ABCDEF0U);
  EXPECT_EQ(read_bits(data.data(), {0, 64, true}), 0xF0DEBC9A78563412U);
}

TEST(SignalBits, ExtendsTheSign) {
  EXPECT_EQ(sign_extend(0x1, 1), -1);
  EXPECT_EQ(sign_extend(0x7F, 8), 127);
  EXPECT_EQ(sign_extend(0x80, 8), -128);
  EXPECT_EQ(sign_extend(0xFFF, 12), -1);
  EXPECT_EQ(sign_extend(0x8000000000000000U, 64), INT64_MIN);
}

}  // namespace
}  // namespace stillcut
