#include "tools/message_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "drivers/lcm/telemetry_messages.hpp"
#include "tools/styled_text.hpp"
#include "tools/top_panels.hpp"

namespace stillcut {
namespace {

constexpr std::size_t kHexBytes = 32, kValuesInARow = 12;
constexpr int kNameColumns = 28, kValueColumns = 22;

template <class Number>
std::string shortest(Number value) {
  if (std::isnan(value)) return "NaN";
  std::array<char, 32> text{};
  const auto done = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), done.ptr};
}

std::string dimensions_text(const FieldReading& reading) {
  std::string text;
  for (const std::size_t size : reading.sizes) text += printf_text("[%zu]", size);
  return text;
}

// Values of the last dimension, "[1, 2, 3, … 509 more]".
std::string row_text(std::span<const FieldValue> values, bool all) {
  std::string text = "[";
  const std::size_t shown = all ? values.size() : std::min(values.size(), kValuesInARow);
  for (std::size_t i = 0; i < shown; ++i) text.append(i > 0 ? ", " : "").append(value_text(values[i]));
  if (shown < values.size()) text += printf_text(", … %zu more, see --all", values.size() - shown);
  return text + "]";
}

std::string field_text(const FieldReading& reading, bool all) {
  const std::string name = reading.field->name + dimensions_text(reading);
  const std::string comment = reading.field->comment.empty() ? "" : "  // " + reading.field->comment;
  std::string text =
      "  " + name + std::string(static_cast<std::size_t>(std::max(1, kNameColumns - width_of(name))), ' ');
  const bool table = reading.sizes.size() > 1 && !reading.values.empty();
  const std::string value = reading.sizes.empty() ? printable(value_text(reading.values.front()))
                            : table               ? std::string{}
                                                  : row_text(reading.values, all);
  text += value;
  if (!comment.empty())
    text += std::string(static_cast<std::size_t>(std::max(0, kValueColumns - width_of(value))), ' ');
  text += comment + "\n";
  if (!table) return text;
  const std::size_t row = reading.sizes.back();
  for (std::size_t at = 0; row > 0 && at < reading.values.size(); at += row)
    text += std::string(kNameColumns + 2, ' ') + row_text(std::span{reading.values}.subspan(at, row), all) + "\n";
  return text;
}

}  // namespace

std::string value_text(const FieldValue& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return std::to_string(*whole);
  if (const auto* number = std::get_if<float>(&value)) return shortest(*number);
  if (const auto* number = std::get_if<double>(&value)) return shortest(*number);
  std::string text{'"'};
  return text.append(std::get<std::string>(value)).append(1, '"');
}

std::string why_refused(std::string_view channel, std::span<const std::uint8_t> bytes) {
  const auto why = [](const char* why_not) { return std::string(why_not != nullptr ? why_not : ""); };
  if (channel == kRobotStateChannel) return why(decode_robot_state(bytes, 0).why_not);
  if (channel == kRobotPathChannel) return why(decode_robot_path(bytes, 0).why_not);
  if (channel == kRobotAckChannel) return why(decode_correction_ack(bytes, 0).why_not);
  const auto ours = telemetry_channels();
  if (std::find(ours.begin(), ours.end(), channel) == ours.end()) return {};
  return why(decode_telemetry(channel, bytes).why_not);
}

std::string hex_text(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes.first(std::min(bytes.size(), kHexBytes))) text += printf_text("%02x ", byte);
  if (bytes.size() > kHexBytes) text += "… ";
  return text + printf_text("(%zu bytes)", bytes.size());
}

std::string message_text(std::string_view channel, std::span<const std::uint8_t> bytes, std::int64_t received_us,
                         bool all_values) {
  const MessageReading message = read_message(bytes);
  std::string text = clock_text(received_us * 1000) + " " + printable(channel) + "  ";
  if (message.schema == nullptr) {
    text += printf_text("fingerprint 0x%016llx, %zu bytes: ", static_cast<unsigned long long>(message.fingerprint),
                        bytes.size());
    return text + message.why_not + "\n  " + hex_text(bytes) + "\n";
  }
  text += message.schema->name + printf_text(", %zu bytes\n", bytes.size());
  for (const FieldReading& reading : message.fields) text += field_text(reading, all_values);
  const std::string refused = why_refused(channel, bytes);
  if (!message.why_not.empty())
    text += "  ! broken: " + message.why_not + "\n  " + hex_text(bytes) + "\n";
  else if (!refused.empty())
    text += "  ! Stillcut refuses it: " + refused + "\n";
  return text;
}

}  // namespace stillcut
