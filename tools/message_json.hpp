// A message of LCM as one JSON object, for `stillcut echo --json`. What JSON has no number for, NaN and infinities, is
// the text "NaN", "inf" or "-inf".
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/message_text.hpp"
#include "tools/styled_text.hpp"

namespace stillcut {

inline nlohmann::ordered_json value_json(const FieldValue& value) {
  return std::visit(
      [&](const auto& v) -> nlohmann::ordered_json {
        if constexpr (std::is_floating_point_v<std::decay_t<decltype(v)>>)
          if (!std::isfinite(v)) return value_text(value);
        return v;
      },
      value);
}

// Nested arrays, as the dimensions are; takes the values from `next` on.
inline nlohmann::ordered_json array_json(const FieldReading& reading, std::size_t dimension, std::size_t& next) {
  if (dimension == reading.sizes.size()) return value_json(reading.values[next++]);
  nlohmann::ordered_json array = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < reading.sizes[dimension]; ++i) array.push_back(array_json(reading, dimension + 1, next));
  return array;
}

inline nlohmann::ordered_json message_json(std::string_view channel, std::span<const std::uint8_t> bytes,
                                           std::int64_t received_us) {
  using Json = nlohmann::ordered_json;
  const MessageReading message = read_message(bytes);
  Json json{{"channel", channel}, {"received_utime", received_us}, {"bytes", bytes.size()}};
  json["fingerprint"] = printf_text("0x%016llx", static_cast<unsigned long long>(message.fingerprint));
  json["type"] = message.schema != nullptr ? Json(message.schema->name) : Json(nullptr);
  Json fields = Json::object();
  for (const FieldReading& reading : message.fields) {
    std::size_t next = 0;
    fields[reading.field->name] = array_json(reading, 0, next);
  }
  json["fields"] = std::move(fields);
  const std::string refused = why_refused(channel, bytes);
  json["why_not"] = !message.why_not.empty() ? Json(message.why_not) : refused.empty() ? Json(nullptr) : Json(refused);
  if (!message.why_not.empty()) json["first_bytes"] = hex_text(bytes);
  return json;
}

}  // namespace stillcut
