#include "drivers/lcm/recording_messages.hpp"

#include <stillcut/lobes_used_t.hpp>
#include <stillcut/silence_t.hpp>
#include <stillcut/timing_t.hpp>

#include "drivers/lcm/message_bytes.hpp"

namespace stillcut {
namespace {

constexpr std::size_t kLongestQuestion = 65536;
constexpr const char* kNotOfThisType = "the bytes are no message of this type; was it recorded by another version?";

bool is_stamp(std::int64_t us) { return us >= 0 && us <= kLastUs; }

}  // namespace

MessageBytes encode(const LobesUsed& used, std::span<const std::uint8_t> question) {
  lobes_used_t m{};
  m.utime = used.fed_ns / kNsPerUs;
  m.posture_utime = used.posture_stamp_ns / kNsPerUs;
  m.usable_from_utime = used.usable_from_ns / kNsPerUs;
  m.usable_until_utime = used.usable_until_ns / kNsPerUs;
  m.ahead = used.ahead ? 1 : 0;
  m.size = static_cast<std::int32_t>(question.size());
  m.question.assign(question.begin(), question.end());
  return to_bytes(m);
}

MessageBytes encode(const Silence& silence) {
  silence_t m{};
  m.utime = silence.first_ns / kNsPerUs;
  m.last_utime = silence.last_ns / kNsPerUs;
  return to_bytes(m);
}

MessageBytes encode(const LoopTiming& timing) {
  timing_t m{};
  m.utime = timing.stamp_ns / kNsPerUs;
  m.in_time = timing.in_time ? 1 : 0;
  m.longest_gap_ns = timing.longest_gap_ns;
  return to_bytes(m);
}

Received<LobesUsedMessage> decode_lobes_used(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kSizeAt = 8 + 4 * 8 + 1, kDataAt = kSizeAt + 4;
  if (bytes.size() < kDataAt || bytes.size() > kDataAt + kLongestQuestion) return {{}, kNotOfThisType};
  lobes_used_t m{};
  if (kDataAt + count_at(bytes, kSizeAt) != bytes.size() || !decode_whole(bytes, m)) return {{}, kNotOfThisType};
  for (const std::int64_t us : {m.utime, m.posture_utime, m.usable_from_utime, m.usable_until_utime})
    if (!is_stamp(us)) return {{}, "a time is out of range"};
  return {{{.fed_ns = m.utime * kNsPerUs,
            .posture_stamp_ns = m.posture_utime * kNsPerUs,
            .usable_from_ns = m.usable_from_utime * kNsPerUs,
            .usable_until_ns = m.usable_until_utime * kNsPerUs,
            .ahead = m.ahead != 0},
           {m.question.begin(), m.question.end()}}};
}

Received<Silence> decode_silence(std::span<const std::uint8_t> bytes) {
  silence_t m{};
  const int length = static_cast<int>(bytes.size());
  if (bytes.size() > 64 || m.decode(bytes.data(), 0, length) != length) return {{}, kNotOfThisType};
  if (!is_stamp(m.utime) || !is_stamp(m.last_utime) || m.last_utime < m.utime) return {{}, "a time is out of range"};
  return {{m.utime * kNsPerUs, m.last_utime * kNsPerUs}};
}

Received<LoopTiming> decode_timing(std::span<const std::uint8_t> bytes) {
  timing_t m{};
  const int length = static_cast<int>(bytes.size());
  if (bytes.size() > 64 || m.decode(bytes.data(), 0, length) != length) return {{}, kNotOfThisType};
  if (!is_stamp(m.utime)) return {{}, "a time is out of range"};
  return {{.stamp_ns = m.utime * kNsPerUs, .in_time = m.in_time != 0, .longest_gap_ns = m.longest_gap_ns}};
}

}  // namespace stillcut
