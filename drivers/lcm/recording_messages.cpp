#include "drivers/lcm/recording_messages.hpp"

#include <stillcut/lobes_used_t.hpp>
#include <stillcut/silence_t.hpp>
#include <stillcut/timing_t.hpp>

namespace stillcut {
namespace {

constexpr std::int64_t kNsAUs = 1000;
constexpr std::size_t kLongestQuestion = 65536;
constexpr const char* kNotOfThisType = "the bytes are no message of this type; was it recorded by another version?";

template <class Message>
MessageBytes bytes_of_message(const Message& message) {
  MessageBytes bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

bool is_stamp(std::int64_t us) { return us >= 0 && us <= kLastUs; }

}  // namespace

MessageBytes encode(const LobesUsed& used, std::span<const std::uint8_t> question) {
  lobes_used_t m{};
  m.utime = used.fed_ns / kNsAUs;
  m.posture_utime = used.posture_stamp_ns / kNsAUs;
  m.usable_from_utime = used.usable_from_ns / kNsAUs;
  m.usable_until_utime = used.usable_until_ns / kNsAUs;
  m.ahead = used.ahead ? 1 : 0;
  m.size = static_cast<std::int32_t>(question.size());
  m.question.assign(question.begin(), question.end());
  return bytes_of_message(m);
}

MessageBytes encode(const Silence& silence) {
  silence_t m{};
  m.utime = silence.first_ns / kNsAUs;
  m.last_utime = silence.last_ns / kNsAUs;
  return bytes_of_message(m);
}

MessageBytes encode(const LoopTiming& timing) {
  timing_t m{};
  m.utime = timing.stamp_ns / kNsAUs;
  m.in_time = timing.in_time ? 1 : 0;
  m.longest_gap_ns = timing.longest_gap_ns;
  return bytes_of_message(m);
}

// The generated code makes room for as many bytes as `size` asks for before it looks: the length is checked first.
Received<LobesUsedMessage> decode_lobes_used(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kSizeAt = 8 + 4 * 8 + 1, kDataAt = kSizeAt + 4;
  if (bytes.size() < kDataAt || bytes.size() > kDataAt + kLongestQuestion) return {{}, kNotOfThisType};
  std::size_t size = 0;
  for (const std::uint8_t byte : bytes.subspan(kSizeAt, 4)) size = size << 8 | byte;
  lobes_used_t m{};
  const int length = static_cast<int>(bytes.size());
  if (kDataAt + size != bytes.size() || m.decode(bytes.data(), 0, length) != length) return {{}, kNotOfThisType};
  for (const std::int64_t us : {m.utime, m.posture_utime, m.usable_from_utime, m.usable_until_utime})
    if (!is_stamp(us)) return {{}, "a time is out of range"};
  return {{{.fed_ns = m.utime * kNsAUs,
            .posture_stamp_ns = m.posture_utime * kNsAUs,
            .usable_from_ns = m.usable_from_utime * kNsAUs,
            .usable_until_ns = m.usable_until_utime * kNsAUs,
            .ahead = m.ahead != 0},
           {m.question.begin(), m.question.end()}}};
}

Received<Silence> decode_silence(std::span<const std::uint8_t> bytes) {
  silence_t m{};
  const int length = static_cast<int>(bytes.size());
  if (bytes.size() > 64 || m.decode(bytes.data(), 0, length) != length) return {{}, kNotOfThisType};
  if (!is_stamp(m.utime) || !is_stamp(m.last_utime) || m.last_utime < m.utime) return {{}, "a time is out of range"};
  return {{m.utime * kNsAUs, m.last_utime * kNsAUs}};
}

Received<LoopTiming> decode_timing(std::span<const std::uint8_t> bytes) {
  timing_t m{};
  const int length = static_cast<int>(bytes.size());
  if (bytes.size() > 64 || m.decode(bytes.data(), 0, length) != length) return {{}, kNotOfThisType};
  if (!is_stamp(m.utime)) return {{}, "a time is out of range"};
  return {{.stamp_ns = m.utime * kNsAUs, .in_time = m.in_time != 0, .longest_gap_ns = m.longest_gap_ns}};
}

}  // namespace stillcut
