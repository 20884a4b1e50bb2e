#include "drivers/lcm/lcm_log.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>

#include "drivers/files/byte_source.hpp"
#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

constexpr std::array<std::uint8_t, 4> kSyncWord{0xED, 0xA1, 0xDA, 0x01};
constexpr std::int64_t kHeaderBytes = 28;
constexpr std::int64_t kLongestChannel = 63;  // LCM_MAX_CHANNEL_NAME_LENGTH

std::int64_t big_endian(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8 | byte;
  return static_cast<std::int64_t>(value);
}

void append_big_endian(std::string& to, std::int64_t value, int bytes) {
  const auto bits = static_cast<std::uint64_t>(value);
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) to.push_back(static_cast<char>(bits >> shift & 0xFF));
}

}  // namespace

void append_lcm_event(std::string& log, std::int64_t number, std::int64_t stamp_ns, std::string_view channel,
                      std::span<const std::uint8_t> data) {
  log.append(kSyncWord.begin(), kSyncWord.end());
  append_big_endian(log, number, 8);
  append_big_endian(log, stamp_ns / 1000, 8);
  append_big_endian(log, std::ssize(channel), 4);
  append_big_endian(log, std::ssize(data), 4);
  log.append(channel);
  log.append(data.begin(), data.end());
}

LcmLogReader::LcmLogReader(const std::filesystem::path& file) {
  const auto fail = [&](const char* message) { throw InputError(file.string(), 0, message); };
  std::error_code error;
  if (!std::filesystem::exists(file, error)) fail("no such file; check the path");
  if (!std::filesystem::is_regular_file(file, error)) fail("is no ordinary file; name a log of lcm-logger");
  if (is_compressed(file)) {
    std::string content = read_whole(file);
    size_ = std::ssize(content);
    in_ = std::make_unique<std::istringstream>(std::move(content), std::ios::binary);
  } else {
    in_ = std::make_unique<std::ifstream>(file, std::ios::binary);
    size_ = static_cast<std::int64_t>(std::filesystem::file_size(file, error));
  }
  if (!*in_ || error) fail("cannot be opened; check its permissions");
  if (!next_event()) fail("holds no LCM event; name a log of lcm-logger");
  position_ = events_ = bad_ = 0;
}

std::optional<RobotMessage> LcmLogReader::next() {
  while (const auto event = next_event()) {
    if (event->channel == kRobotStateChannel) {
      const auto state = decode_robot_state(event->data, event->stamp_ns);
      if (state.ok()) return state.value;
      ++bad_;
    } else if (event->channel == kRobotPathChannel) {
      const auto path = decode_robot_path(event->data, event->stamp_ns);
      if (path.ok()) return path.value;
      ++bad_;
    } else if (event->channel == kRobotAckChannel) {
      const auto ack = decode_correction_ack(event->data, event->stamp_ns);
      if (ack.ok()) return ack.value;
      ++bad_;
    }
  }
  return std::nullopt;
}

std::optional<LcmLogEvent> LcmLogReader::next_event() {
  bool in_damage = false;  // a damaged part is counted once, however long
  while (position_ < size_) {
    if (auto event = read_event_here()) {
      ++events_;
      return event;
    }
    if (!in_damage) ++bad_;
    in_damage = true;
    skip_to_sync_word();
  }
  return std::nullopt;
}

// The event at position_, which then moves behind it; nothing when there is no whole one. What follows it must be the
// next event or the file's end: a damaged length would otherwise swallow good events.
std::optional<LcmLogEvent> LcmLogReader::read_event_here() {
  std::array<std::uint8_t, kHeaderBytes> header{};
  if (!read_at(position_, header) || !std::equal(kSyncWord.begin(), kSyncWord.end(), header.begin())) return {};
  const std::span<const std::uint8_t> fields(header);
  const std::int64_t time_us = big_endian(fields.subspan(12, 8));
  const std::int64_t channel_length = big_endian(fields.subspan(20, 4));
  const std::int64_t data_length = big_endian(fields.subspan(24, 4));
  const std::int64_t end = position_ + kHeaderBytes + channel_length + data_length;
  if (channel_length < 1 || channel_length > kLongestChannel || end > size_) return {};
  if (time_us < -kLastUs || time_us > kLastUs) return {};
  std::array<std::uint8_t, kSyncWord.size()> following{};
  if (read_at(end, following) && following != kSyncWord) return {};

  LcmLogEvent event;
  event.stamp_ns = time_us * 1000;
  MessageBytes channel(static_cast<std::size_t>(channel_length));
  if (!read_at(position_ + kHeaderBytes, channel)) return {};
  event.channel.assign(channel.begin(), channel.end());
  if (event.channel.starts_with("ROBOT_") || event.channel.starts_with("STILLCUT_")) {
    event.data.resize(static_cast<std::size_t>(data_length));
    if (!read_at(end - data_length, event.data)) return {};
  }
  position_ = end;
  return event;
}

// Moves position_ to the next sync word behind it, or to the file's end.
void LcmLogReader::skip_to_sync_word() {
  constexpr std::int64_t kChunk = 65536;
  std::vector<std::uint8_t> chunk;
  for (++position_; position_ < size_; position_ += kChunk - std::ssize(kSyncWord) + 1) {
    chunk.resize(static_cast<std::size_t>(std::min(kChunk, size_ - position_)));
    if (!read_at(position_, chunk)) break;
    const auto found = std::search(chunk.begin(), chunk.end(), kSyncWord.begin(), kSyncWord.end());
    if (found != chunk.end()) {
      position_ += found - chunk.begin();
      return;
    }
  }
  position_ = size_;
}

bool LcmLogReader::read_at(std::int64_t position, std::span<std::uint8_t> bytes) {
  in_->clear();
  in_->seekg(position);
  in_->read(reinterpret_cast<char*>(bytes.data()), std::ssize(bytes));
  return in_->gcount() == std::ssize(bytes);
}

}  // namespace stillcut
