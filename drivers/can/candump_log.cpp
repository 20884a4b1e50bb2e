#include "drivers/can/candump_log.hpp"

#include <algorithm>
#include <array>

namespace stillcut {
namespace {

constexpr std::uint8_t kNoDigit = 0xF0;  // hexadecimal digits are below 0x10

constexpr std::array<std::uint8_t, 256> hex_digits() {
  std::array<std::uint8_t, 256> value{};
  value.fill(kNoDigit);
  for (std::uint8_t i = 0; i < 10; ++i) value['0' + i] = i;
  for (std::uint8_t i = 0; i < 6; ++i) value['A' + i] = value['a' + i] = static_cast<std::uint8_t>(10 + i);
  return value;
}
constexpr std::array<std::uint8_t, 256> kHexDigit = hex_digits();

std::uint8_t hex_digit(char c) { return kHexDigit[static_cast<unsigned char>(c)]; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }
const char* skip_spaces(const char* p, const char* end) {
  while (p != end && is_space(*p)) ++p;
  return p;
}

// "(seconds.fraction)" to nanoseconds, cut to whole microseconds. Returns the position after it, or null.
const char* parse_stamp(const char* p, const char* end, std::int64_t& stamp_ns) {
  constexpr std::int64_t kMaxSeconds = 9'223'372'035;  // the next ones do not fit 64 bits of nanoseconds
  if (p == end || *p++ != '(') return nullptr;
  std::int64_t seconds = 0;
  const char* first = p;
  for (; p != end && is_digit(*p) && p - first < 10; ++p) seconds = 10 * seconds + (*p - '0');
  if (p == first || p == end || *p++ != '.' || seconds > kMaxSeconds) return nullptr;
  std::int64_t microseconds = 0;
  int decimals = 0;
  for (; p != end && is_digit(*p) && decimals < 9; ++p, ++decimals) {
    if (decimals < 6) microseconds = 10 * microseconds + (*p - '0');
  }
  if (decimals == 0 || p == end || *p++ != ')') return nullptr;
  for (; decimals < 6; ++decimals) microseconds *= 10;
  stamp_ns = seconds * 1'000'000'000 + microseconds * 1'000;
  return p;
}

// 3 or 8 hexadecimal digits up to '#'. Returns the position after the '#', or null.
const char* parse_identifier(const char* p, const char* end, std::uint32_t& id) {
  std::uint32_t value = 0;
  int digits = 0;
  for (; p != end && digits < 9; ++p, ++digits) {
    const std::uint8_t digit = hex_digit(*p);
    if (digit == kNoDigit) break;
    value = value << 4 | digit;
  }
  if (p == end || *p++ != '#') return nullptr;
  if (value > (digits == 3 ? 0x7FFU : 0x3FFFFFFFU) || (digits != 3 && digits != 8)) return nullptr;
  id = value;  // in an error frame the bit 0x20000000 is CanFrame::kError itself
  if (digits == 8 && (value & CanFrame::kError) == 0) id |= CanFrame::kExtended;
  return p;
}

// Pairs of hexadecimal digits, as many as there are. Returns the position after them, or null past `most` bytes.
const char* parse_data(const char* p, const char* end, std::size_t most, CanFrame& frame) {
  std::size_t n = 0;
  while (end - p >= 2) {
    const std::uint8_t high = hex_digit(p[0]), low = hex_digit(p[1]);
    if (((high | low) & kNoDigit) != 0) break;
    if (n == most) return nullptr;
    frame.data[n++] = static_cast<std::uint8_t>(high << 4 | low);
    p += 2;
  }
  frame.length = static_cast<std::uint8_t>(n);
  return p;
}

// What may follow a frame: the raw DLC of a classic frame ("_F"), then short words such as R, T, TX, B (direction, bit
// rate) that some writers add.
bool only_trailing_tokens(const char* p, const char* end, bool classic) {
  if (classic && end - p >= 2 && p[0] == '_' && hex_digit(p[1]) != kNoDigit) p += 2;
  while (p != end) {
    if (!is_space(*p)) return false;
    p = skip_spaces(p, end);
    const char* word = p;
    while (p != end && ((*p >= 'A' && *p <= 'Z') || *p == '-')) ++p;
    if (p - word > 3) return false;
  }
  return true;
}

char* write_hex(char* p, std::uint32_t value, int digits) {
  for (int shift = 4 * (digits - 1); shift >= 0; shift -= 4) *p++ = "0123456789ABCDEF"[value >> shift & 0xF];
  return p;
}

char* write_decimal(char* p, std::int64_t value, int digits) {
  for (int i = digits - 1; i >= 0; --i, value /= 10) p[i] = static_cast<char>('0' + value % 10);
  return p + digits;
}

}  // namespace

CandumpLine parse_candump_line(std::string_view line, CanFrame& frame, std::string_view* interface) noexcept {
  const char* end = line.data() + line.size();
  const char* p = skip_spaces(line.data(), end);
  if (p == end || *p == '#') return CandumpLine::nothing;

  p = parse_stamp(p, end, frame.stamp_ns);
  if (p == nullptr || p == end || !is_space(*p)) return CandumpLine::bad;
  p = skip_spaces(p, end);
  const char* name = p;
  while (p != end && !is_space(*p)) ++p;
  if (p == name || p == end) return CandumpLine::bad;
  if (interface != nullptr) *interface = {name, static_cast<std::size_t>(p - name)};
  p = skip_spaces(p, end);

  p = parse_identifier(p, end, frame.id);
  if (p == nullptr) return CandumpLine::bad;
  frame.fd = p != end && *p == '#';
  frame.fd_flags = 0;
  frame.length = 0;
  if (frame.fd) {
    ++p;
    if (p == end || hex_digit(*p) == kNoDigit) return CandumpLine::bad;
    frame.fd_flags = hex_digit(*p++);
    p = parse_data(p, end, 64, frame);
  } else if (p != end && *p == 'R' && !frame.is_error()) {
    frame.id |= CanFrame::kRemote;
    ++p;
    if (p != end && *p >= '0' && *p <= '8') frame.length = static_cast<std::uint8_t>(*p++ - '0');
    frame.data.fill(0);
    return only_trailing_tokens(p, end, true) ? CandumpLine::frame : CandumpLine::bad;
  } else {
    p = parse_data(p, end, 8, frame);
  }
  if (p == nullptr || !only_trailing_tokens(p, end, !frame.fd)) return CandumpLine::bad;
  std::fill(frame.data.begin() + frame.length, frame.data.end(), std::uint8_t{0});
  return CandumpLine::frame;
}

std::size_t format_candump_line(const CanFrame& frame, std::string_view interface,
                                std::span<char, kMaxCandumpLine> line) noexcept {
  const std::int64_t microseconds = std::max<std::int64_t>(frame.stamp_ns, 0) / 1'000;
  char* p = line.data();
  *p++ = '(';
  p = write_decimal(p, microseconds / 1'000'000, 10);
  *p++ = '.';
  p = write_decimal(p, microseconds % 1'000'000, 6);
  *p++ = ')';
  *p++ = ' ';
  p = std::copy_n(interface.data(), std::min(interface.size(), kMaxCandumpInterface), p);
  *p++ = ' ';
  if (frame.is_error()) {
    p = write_hex(p, frame.id & 0x3FFFFFFFU, 8);
  } else if ((frame.id & CanFrame::kExtended) != 0) {
    p = write_hex(p, frame.id & 0x1FFFFFFFU, 8);
  } else {
    p = write_hex(p, frame.id & 0x7FFU, 3);
  }
  *p++ = '#';
  const int length = std::min<int>(frame.length, frame.fd ? 64 : 8);
  if (frame.fd) {
    *p++ = '#';
    p = write_hex(p, frame.fd_flags & 0xFU, 1);
  } else if ((frame.id & CanFrame::kRemote) != 0 && !frame.is_error()) {
    *p++ = 'R';
    if (length > 0) p = write_decimal(p, length, 1);
  }
  if (frame.fd || frame.is_error() || (frame.id & CanFrame::kRemote) == 0) {
    for (int i = 0; i < length; ++i) p = write_hex(p, frame.data[static_cast<std::size_t>(i)], 2);
  }
  *p++ = '\n';
  return static_cast<std::size_t>(p - line.data());
}

}  // namespace stillcut
