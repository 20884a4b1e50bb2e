// A message of LCM as `stillcut echo` prints it: every field with its value and what the .lcm file says of it.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "drivers/lcm/message_schema.hpp"

namespace stillcut {

// "NaN", "0.15", "3330": as few digits as give back the very same value. Texts as they are.
std::string value_text(const FieldValue& value);

// Why the programs of Stillcut would refuse these bytes on this channel; "": they would not, or the channel is not
// ours.
std::string why_refused(std::string_view channel, std::span<const std::uint8_t> bytes);

// Several lines, the last ends with a line feed. all_values: also of arrays longer than a row.
std::string message_text(std::string_view channel, std::span<const std::uint8_t> bytes, std::int64_t received_us,
                         bool all_values);

// The first bytes of a message, "23 a0 01 ... (1000 bytes)".
std::string hex_text(std::span<const std::uint8_t> bytes);

}  // namespace stillcut
