// Messages read by the text of their .lcm files, for those who look at a network from outside: every field by its name,
// with what the file says of it. What is decided upon goes through messages.hpp instead, into plain values.
//
// Source of grammar, encoding and fingerprint: LCM 1.3.1, "LCM Type Specification Language" and "LCM type fingerprint".
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace stillcut {

struct SchemaField {
  std::string type;                     // int8_t, int16_t, int32_t, int64_t, float, double, string, boolean, byte
  std::string name;                     // "spindle_speed_rpm"
  std::vector<std::string> dimensions;  // "6", or the name of an integer field before it
  std::string comment;                  // unit and meaning, on one line
};

struct MessageSchema {
  std::string name;     // "monitor_t"
  std::string comment;  // what stands above the package
  std::vector<SchemaField> fields;

  // The eight bytes that lead every message of this type.
  [[nodiscard]] std::uint64_t fingerprint() const;
};

// One struct of primitive types, as all of ours are. Throws std::invalid_argument for anything else.
MessageSchema parse_schema(std::string_view lcm_text);

// Of the .lcm files of this folder.
std::span<const MessageSchema> our_schemas();
const MessageSchema* find_schema(std::uint64_t fingerprint);
const MessageSchema* find_schema(std::string_view name);

struct KnownChannel {
  const char* name;
  const char* type;
  bool recorded_only;  // in a recording's LCM log, never on the network
};
std::span<const KnownChannel> known_channels() noexcept;

using FieldValue = std::variant<std::int64_t, float, double, std::string>;

struct FieldReading {
  const SchemaField* field = nullptr;
  std::vector<std::size_t> sizes;  // of each dimension; empty: one value
  std::vector<FieldValue> values;  // the last dimension runs fastest
};

struct MessageReading {
  std::uint64_t fingerprint = 0;          // 0 also where there are no eight bytes
  const MessageSchema* schema = nullptr;  // nullptr: of a type that is not ours
  std::vector<FieldReading> fields;       // as far as the bytes go
  std::string why_not;                    // empty: whole; "the bytes end within depth_limit_mm"
};

// By the fingerprint, whatever the channel. Never makes room for more values than there are bytes.
MessageReading read_message(std::span<const std::uint8_t> bytes);

}  // namespace stillcut
