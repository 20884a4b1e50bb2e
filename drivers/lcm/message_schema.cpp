#include "drivers/lcm/message_schema.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <stdexcept>

#include "drivers/lcm/lcm_texts.hpp"
#include "drivers/lcm/recording_messages.hpp"
#include "drivers/lcm/telemetry_messages.hpp"

namespace stillcut {
namespace {

constexpr std::size_t kFingerprintBytes = 8, kLengthBytes = 4;

struct Primitive {
  const char* name;
  std::size_t bytes;  // 0: a string, which tells its own length
};
constexpr std::array kPrimitives{Primitive{"int8_t", 1},  Primitive{"int16_t", 2}, Primitive{"int32_t", 4},
                                 Primitive{"int64_t", 8}, Primitive{"float", 4},   Primitive{"double", 8},
                                 Primitive{"boolean", 1}, Primitive{"byte", 1},    Primitive{"string", 0}};

const Primitive* find_primitive(std::string_view name) {
  const auto* const found =
      std::find_if(kPrimitives.begin(), kPrimitives.end(), [&](const Primitive& p) { return name == p.name; });
  return found != kPrimitives.end() ? found : nullptr;
}

bool is_number(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r"), last = text.find_last_not_of(" \t\r");
  return first == std::string_view::npos ? std::string_view{} : text.substr(first, last - first + 1);
}

void add_comment(std::string& comment, std::string_view more) {
  if (!comment.empty() && !more.empty()) comment += ' ';
  comment += more;
}

// "float   m_per_s2[samples][3]"
SchemaField parse_field(std::string_view text) {
  const auto gap = text.find_first_of(" \t");
  if (gap == std::string_view::npos) throw std::invalid_argument("not TYPE NAME: " + std::string(text));
  SchemaField field;
  field.type = text.substr(0, gap);
  if (find_primitive(field.type) == nullptr) throw std::invalid_argument("no primitive type: " + field.type);
  std::string_view name = trimmed(text.substr(gap));
  const auto bracket = std::min(name.find('['), name.size());
  field.name = trimmed(name.substr(0, bracket));
  for (name.remove_prefix(bracket); !name.empty();) {
    const auto end = name.find(']');
    if (name.front() != '[' || end == std::string_view::npos)
      throw std::invalid_argument("not [SIZE]: " + std::string(name));
    field.dimensions.emplace_back(trimmed(name.substr(1, end - 1)));
    name = trimmed(name.substr(end + 1));
  }
  return field;
}

std::uint64_t mixed(std::uint64_t hash, char character) {
  const auto sign = static_cast<std::uint64_t>(static_cast<std::int64_t>(hash) >> 55);  // LCM shifts a signed number
  return ((hash << 8) ^ sign) + static_cast<std::uint64_t>(static_cast<std::int64_t>(character));
}
std::uint64_t mixed(std::uint64_t hash, std::string_view text) {
  hash = mixed(hash, static_cast<char>(text.size()));
  for (const char character : text) hash = mixed(hash, character);
  return hash;
}

// Takes bytes from the front.
class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> bytes) : left_{bytes} {}

  [[nodiscard]] std::size_t left() const { return left_.size(); }
  std::optional<std::uint64_t> number(std::size_t size) {
    if (left_.size() < size) return {};
    std::uint64_t value = 0;
    for (const std::uint8_t byte : left_.first(size)) value = value << 8 | byte;
    left_ = left_.subspan(size);
    return value;
  }
  std::optional<std::string> text() {
    const auto length = number(kLengthBytes);
    if (!length || *length < 1 || *length > left_.size()) return {};
    std::string value(left_.begin(), left_.begin() + static_cast<std::ptrdiff_t>(*length - 1));  // its zero counts
    left_ = left_.subspan(static_cast<std::size_t>(*length));
    return value;
  }

 private:
  std::span<const std::uint8_t> left_;
};

std::optional<FieldValue> read_value(Bytes& bytes, const Primitive& type) {
  const std::string_view name = type.name;
  if (type.bytes == 0) {
    auto text = bytes.text();
    return text ? std::optional<FieldValue>{std::move(*text)} : std::nullopt;
  }
  const auto bits = bytes.number(type.bytes);
  if (!bits) return {};
  if (name == "double") return std::bit_cast<double>(*bits);
  if (name == "float") return std::bit_cast<float>(static_cast<std::uint32_t>(*bits));
  if (name == "byte") return static_cast<std::int64_t>(*bits);
  const auto unused = static_cast<int>(64 - 8 * type.bytes);
  return static_cast<std::int64_t>(*bits << unused) >> unused;
}

// How many values a dimension has; nothing where its count is negative.
std::optional<std::size_t> size_of(const std::string& dimension, const std::vector<FieldReading>& before) {
  if (is_number(dimension)) {
    std::size_t size = 0;
    std::from_chars(dimension.data(), dimension.data() + dimension.size(), size);
    return size;
  }
  for (const FieldReading& reading : before) {
    if (reading.field->name != dimension || reading.values.size() != 1) continue;
    const auto* const count = std::get_if<std::int64_t>(&reading.values.front());
    return count != nullptr && *count >= 0 ? std::optional{static_cast<std::size_t>(*count)} : std::nullopt;
  }
  return {};
}

// False, with the reason, where the bytes do not hold the field.
bool read_field(Bytes& bytes, const SchemaField& field, MessageReading& message) {
  FieldReading reading{&field, {}, {}};
  const Primitive& type = *find_primitive(field.type);
  const std::size_t most = bytes.left() / (type.bytes == 0 ? kLengthBytes + 1 : type.bytes);
  std::size_t count = 1;
  for (const std::string& dimension : field.dimensions) {
    const auto size = size_of(dimension, message.fields);
    if (!size) return message.why_not = dimension + " is no count for " + field.name, false;
    if (!is_number(dimension) && *size > most)
      return message.why_not = field.name + " is said to be longer than the message", false;
    reading.sizes.push_back(*size);
    count = *size > 0 && count > most / *size ? most + 1 : count * *size;
  }
  if (count > most) return message.why_not = "the bytes end within " + field.name, false;
  reading.values.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    auto value = read_value(bytes, type);
    if (!value) return message.why_not = "the bytes end within " + field.name, false;
    reading.values.push_back(std::move(*value));
  }
  message.fields.push_back(std::move(reading));
  return true;
}

}  // namespace

std::uint64_t MessageSchema::fingerprint() const {
  std::uint64_t hash = 0x12345678;
  for (const SchemaField& field : fields) {
    hash = mixed(mixed(hash, field.name), field.type);
    hash = mixed(hash, static_cast<char>(field.dimensions.size()));
    for (const std::string& dimension : field.dimensions)
      hash = mixed(mixed(hash, static_cast<char>(is_number(dimension) ? 0 : 1)), dimension);
  }
  return std::rotl(hash, 1);
}

MessageSchema parse_schema(std::string_view lcm_text) {
  MessageSchema schema;
  enum class Place : std::uint8_t { above, between, inside, behind } place = Place::above;
  while (!lcm_text.empty()) {
    const auto end = std::min(lcm_text.find('\n'), lcm_text.size());
    std::string_view line = lcm_text.substr(0, end);
    lcm_text.remove_prefix(std::min(end + 1, lcm_text.size()));
    const auto slashes = line.find("//");
    const std::string_view comment =
        slashes == std::string_view::npos ? std::string_view{} : trimmed(line.substr(slashes + 2));
    std::string_view code = trimmed(line.substr(0, slashes));
    if (code.empty() && place == Place::inside && !schema.fields.empty()) {  // a comment goes on below its field
      add_comment(schema.fields.back().comment, comment);
    } else if (code.empty()) {
      if (place != Place::behind) add_comment(schema.comment, comment);
    } else if (code.starts_with("package ") && place == Place::above) {
      place = Place::between;
    } else if (code.starts_with("struct ") && code.ends_with('{') && place != Place::inside) {
      code.remove_suffix(1);
      schema.name = trimmed(code.substr(7));
      place = Place::inside;
    } else if (code == "}" && place == Place::inside) {
      place = Place::behind;
    } else if (code.ends_with(';') && place == Place::inside) {
      code.remove_suffix(1);
      schema.fields.push_back(parse_field(code));
      schema.fields.back().comment = comment;
    } else {
      throw std::invalid_argument("not read here: " + std::string(code));
    }
  }
  if (place != Place::behind) throw std::invalid_argument("no whole struct");
  return schema;
}

std::span<const MessageSchema> our_schemas() {
  static const std::vector<MessageSchema> kSchemas = [] {
    std::vector<MessageSchema> schemas;
    for (const char* text : kLcmTexts) schemas.push_back(parse_schema(text));
    return schemas;
  }();
  return kSchemas;
}

const MessageSchema* find_schema(std::uint64_t fingerprint) {
  for (const MessageSchema& schema : our_schemas())
    if (schema.fingerprint() == fingerprint) return &schema;
  return nullptr;
}

const MessageSchema* find_schema(std::string_view name) {
  for (const MessageSchema& schema : our_schemas())
    if (schema.name == name) return &schema;
  return nullptr;
}

std::span<const KnownChannel> known_channels() noexcept {
  static const std::array kChannels{KnownChannel{kRobotStateChannel, "robot_state_t", false},
                                    KnownChannel{kRobotPathChannel, "robot_path_t", false},
                                    KnownChannel{kRobotAckChannel, "correction_ack_t", false},
                                    KnownChannel{kCorrectionChannel, "correction_t", false},
                                    KnownChannel{kEventChannel, "event_t", false},
                                    KnownChannel{kStatusChannel, "status_t", false},
                                    KnownChannel{kMonitorChannel, "monitor_t", false},
                                    KnownChannel{kSpectrumChannel, "spectrum_t", false},
                                    KnownChannel{kVibrationChannel, "vibration_t", false},
                                    KnownChannel{kDiagramChannel, "diagram_t", false},
                                    KnownChannel{kHealthChannel, "health_t", false},
                                    KnownChannel{kLatencyChannel, "loop_times_t", false},
                                    KnownChannel{kHistogramChannel, "histogram_t", false},
                                    KnownChannel{kLobesChannel, "lobes_used_t", true},
                                    KnownChannel{kSilenceChannel, "silence_t", true},
                                    KnownChannel{kTimingChannel, "timing_t", true}};
  return kChannels;
}

MessageReading read_message(std::span<const std::uint8_t> bytes) {
  MessageReading message;
  Bytes left{bytes};
  const auto fingerprint = left.number(kFingerprintBytes);
  if (!fingerprint) {
    message.why_not = "shorter than a fingerprint: no message of LCM's types";
    return message;
  }
  message.fingerprint = *fingerprint;
  message.schema = find_schema(*fingerprint);
  if (message.schema == nullptr) {
    message.why_not = "of a type that is not Stillcut's, or of another version";
    return message;
  }
  for (const SchemaField& field : message.schema->fields)
    if (!read_field(left, field, message)) return message;
  if (left.left() > 0) message.why_not = std::to_string(left.left()) + " bytes too many";
  return message;
}

}  // namespace stillcut
