#include "drivers/files/mcap_writer.hpp"

#include <zstd.h>

#include <algorithm>
#include <concepts>
#include <new>

namespace stillcut {
namespace {

// Kinds of records, and the format's other fixed parts: its specification at mcap.dev/spec.
enum McapRecord : std::uint8_t {
  kMcapHeader = 1,
  kMcapFooter = 2,
  kMcapSchema = 3,
  kMcapChannel = 4,
  kMcapMessage = 5,
  kMcapChunk = 6,
  kMcapMessageIndex = 7,
  kMcapChunkIndex = 8,
  kMcapStatistics = 11,
  kMcapSummaryOffset = 14,
  kMcapDataEnd = 15
};
constexpr std::string_view kMcapMagic{"\x89MCAP0\r\n", 8};
constexpr std::size_t kMcapChunkBytes = 1U << 20U;
constexpr int kMcapCompression = 3;  // zstd level

template <std::unsigned_integral Number>
void append(std::string& bytes, Number number) {  // the lowest byte first
  for (std::size_t i = 0; i < sizeof number; ++i) bytes += static_cast<char>(number >> (8 * i) & 0xFFU);
}

void append(std::string& bytes, std::string_view text) {
  append(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += text;
}

std::string record_of(McapRecord kind, std::string_view content) {
  std::string record(1, static_cast<char>(kind));
  append(record, static_cast<std::uint64_t>(content.size()));
  return record += content;
}

// CRC-32 as zip and Ethernet have it: the polynomial 0x04C11DB7, bits reversed.
constexpr std::array<std::uint32_t, 256> kCrcTable = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < table.size(); ++i) {
    std::uint32_t rest = i;
    for (int bit = 0; bit < 8; ++bit) rest = (rest & 1U) != 0 ? rest >> 1U ^ 0xEDB88320U : rest >> 1U;
    table[i] = rest;
  }
  return table;
}();

std::uint32_t crc32(std::string_view bytes) {
  std::uint32_t rest = 0xFFFFFFFFU;
  for (const char byte : bytes) rest = rest >> 8U ^ kCrcTable[(rest ^ static_cast<unsigned char>(byte)) & 0xFFU];
  return ~rest;
}

std::string compressed(std::string_view bytes) {
  std::string result(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress(result.data(), result.size(), bytes.data(), bytes.size(), kMcapCompression);
  if (ZSTD_isError(size) != 0) throw std::bad_alloc();  // the buffer is large enough: nothing else is left
  result.resize(size);
  return result;
}

}  // namespace

void McapWriter::TimeSpan::add(std::uint64_t time_ns) {
  begin_ns = any ? std::min(begin_ns, time_ns) : time_ns;
  end_ns = any ? std::max(end_ns, time_ns) : time_ns;
  any = true;
}

McapWriter::McapWriter(std::ostream& out, const std::string& library) : out_{out} {
  std::string header;
  append(header, std::string_view{});  // profile: none
  append(header, std::string_view{library});
  put(kMcapMagic);
  put(record_of(kMcapHeader, header));
}

void McapWriter::put(std::string_view bytes) {
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  at_ += bytes.size();
}

McapWriter::Channel McapWriter::add_channel(const std::string& topic, const std::string& schema_name,
                                            const std::string& schema) {
  sequence_.push_back(0);
  const auto id = static_cast<Channel>(sequence_.size());
  std::string content;
  append(content, id);
  append(content, std::string_view{schema_name});
  append(content, std::string_view{"jsonschema"});
  append(content, std::string_view{schema});
  const std::string schema_record = record_of(kMcapSchema, content);
  content.clear();
  append(content, id);
  append(content, id);  // its schema
  append(content, std::string_view{topic});
  append(content, std::string_view{"json"});
  append(content, std::uint32_t{0});  // no metadata
  const std::string channel_record = record_of(kMcapChannel, content);
  put(schema_record);
  put(channel_record);
  schemas_ += schema_record;
  channels_ += channel_record;
  return id;
}

void McapWriter::write(Channel channel, std::int64_t time_ns, std::string_view json) {
  const auto time = static_cast<std::uint64_t>(std::max<std::int64_t>(time_ns, 0));
  chunk_index_[channel].push_back({time, chunk_.size()});
  chunk_times_.add(time);
  times_.add(time);
  std::string content;
  append(content, channel);
  append(content, ++sequence_.at(channel - 1U));
  append(content, time);
  append(content, time);
  content += json;
  chunk_ += record_of(kMcapMessage, content);
  ++messages_;
  if (chunk_.size() >= kMcapChunkBytes) end_chunk();
}

void McapWriter::end_chunk() {
  if (chunk_.empty()) return;
  const std::string records = compressed(chunk_);
  Chunk chunk{
      .times = chunk_times_, .at = at_, .compressed = records.size(), .uncompressed = chunk_.size(), .indexes = {}};
  std::string content;
  append(content, chunk.times.begin_ns);
  append(content, chunk.times.end_ns);
  append(content, chunk.uncompressed);
  append(content, crc32(chunk_));
  append(content, std::string_view{"zstd"});
  append(content, chunk.compressed);
  content += records;
  put(record_of(kMcapChunk, content));
  chunk.length = at_ - chunk.at;
  const std::uint64_t indexes_at = at_;
  for (auto& [channel, messages] : chunk_index_) {
    std::stable_sort(messages.begin(), messages.end(),
                     [](const Indexed& a, const Indexed& b) { return a.time_ns < b.time_ns; });
    content.clear();
    append(content, channel);
    append(content, static_cast<std::uint32_t>(messages.size() * 2 * sizeof(std::uint64_t)));
    for (const Indexed& message : messages) {
      append(content, message.time_ns);
      append(content, message.offset);
    }
    chunk.indexes.emplace_back(channel, at_);
    put(record_of(kMcapMessageIndex, content));
  }
  chunk.index_length = at_ - indexes_at;
  chunks_.push_back(std::move(chunk));
  chunk_.clear();
  chunk_index_.clear();
  chunk_times_ = {};
}

std::string McapWriter::chunk_indexes() const {
  std::string records;
  for (const Chunk& chunk : chunks_) {
    std::string content;
    append(content, chunk.times.begin_ns);
    append(content, chunk.times.end_ns);
    append(content, chunk.at);
    append(content, chunk.length);
    append(content, static_cast<std::uint32_t>(chunk.indexes.size() * (sizeof(Channel) + sizeof(std::uint64_t))));
    for (const auto& [channel, at] : chunk.indexes) {
      append(content, channel);
      append(content, at);
    }
    append(content, chunk.index_length);
    append(content, std::string_view{"zstd"});
    append(content, chunk.compressed);
    append(content, chunk.uncompressed);
    records += record_of(kMcapChunkIndex, content);
  }
  return records;
}

std::string McapWriter::statistics() const {
  std::string content;
  append(content, messages_);
  append(content, static_cast<std::uint16_t>(sequence_.size()));  // schemas
  append(content, static_cast<std::uint32_t>(sequence_.size()));  // channels
  append(content, std::uint32_t{0});                              // attachments
  append(content, std::uint32_t{0});                              // metadata
  append(content, static_cast<std::uint32_t>(chunks_.size()));
  append(content, times_.begin_ns);
  append(content, times_.end_ns);
  append(content, static_cast<std::uint32_t>(sequence_.size() * (sizeof(Channel) + sizeof(std::uint64_t))));
  for (std::size_t i = 0; i < sequence_.size(); ++i) {
    append(content, static_cast<Channel>(i + 1));
    append(content, std::uint64_t{sequence_[i]});
  }
  return record_of(kMcapStatistics, content);
}

void McapWriter::finish() {
  end_chunk();
  std::string content;
  append(content, std::uint32_t{0});  // checksum of all data: each chunk has its own
  put(record_of(kMcapDataEnd, content));

  std::string summary, offsets;
  const std::uint64_t summary_at = at_;
  const auto add_group = [&](McapRecord kind, const std::string& records) {
    if (records.empty()) return;
    std::string offset(1, static_cast<char>(kind));
    append(offset, summary_at + summary.size());
    append(offset, static_cast<std::uint64_t>(records.size()));
    offsets += record_of(kMcapSummaryOffset, offset);
    summary += records;
  };
  add_group(kMcapSchema, schemas_);
  add_group(kMcapChannel, channels_);
  add_group(kMcapStatistics, statistics());
  add_group(kMcapChunkIndex, chunk_indexes());
  const std::uint64_t offsets_at = summary_at + summary.size();
  summary += offsets;

  std::string footer;
  append(footer, summary_at);
  append(footer, offsets_at);
  // The checksum covers the footer up to itself, its kind and length included.
  const std::string to_come = record_of(kMcapFooter, footer + std::string(sizeof(std::uint32_t), '\0'));
  summary += to_come.substr(0, to_come.size() - sizeof(std::uint32_t));
  std::string checksum;
  append(checksum, crc32(summary));
  put(summary);
  put(checksum);
  put(kMcapMagic);
}

}  // namespace stillcut
