// DBC files: every signal lies in its message and comes back from it.
#include <array>

#include "drivers/can/dbc.hpp"
#include "drivers/files/input_error.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace stillcut;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) try {
  const Dbc dbc = parse_dbc(text_of(data, size), "a.dbc");
  for (const DbcMessage& message : dbc.messages) {
    require_that(message.length >= 0 && message.length <= 64, "a message has up to 64 bytes");
    require_that(dbc.find(message.name) != nullptr, "a message is found");
    for (const DbcSignal& signal : message.signals) {
      require_that(signal.bits.length >= 1 && signal.bits.length <= 64, "a signal has up to 64 bits");
      require_that(bytes_needed(signal.bits) <= message.length, "a signal lies in its message");
      std::array<std::uint8_t, 64> frame{};
      const std::uint64_t raw = 0xA5C3'96F0'1234'5679U & bit_mask(signal.bits.length);
      write_bits(frame.data(), signal.bits, raw);
      require_that(read_bits(frame.data(), signal.bits) == raw, "a signal comes back from its frame");
    }
  }
  return 0;
} catch (const InputError&) {
  return 0;
}
