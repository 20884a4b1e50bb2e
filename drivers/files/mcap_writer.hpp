// Writes MCAP files (mcap.dev): stamped messages on named topics, as Foxglove, PlotJuggler and the format's own tools
// read them. Messages and their schemas are JSON. They stand in chunks, compressed with zstd, with an index by time and
// checksums.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace stillcut {

class McapWriter {
 public:
  using Channel = std::uint16_t;

  // `library` names the program in the file. The stream must outlive the writer and is written from its beginning on.
  McapWriter(std::ostream& out, const std::string& library);

  // `schema` is a JSON Schema of an object, `schema_name` a name of its own.
  Channel add_channel(const std::string& topic, const std::string& schema_name, const std::string& schema);

  // One message. Times need not rise. Held are the chunk at hand (1 MiB) and the index (some 200 bytes a chunk).
  void write(Channel channel, std::int64_t time_ns, std::string_view json);

  // The rest, index, statistics and end. Whether all reached the stream is for the caller to ask.
  void finish();

  [[nodiscard]] std::uint64_t messages() const { return messages_; }

 private:
  struct TimeSpan {
    std::uint64_t begin_ns = 0, end_ns = 0;
    bool any = false;
    void add(std::uint64_t time_ns);
  };
  struct Indexed {
    std::uint64_t time_ns = 0, offset = 0;
  };
  struct Chunk {
    TimeSpan times;
    std::uint64_t at = 0, length = 0, index_length = 0, compressed = 0, uncompressed = 0;
    std::vector<std::pair<Channel, std::uint64_t>> indexes;  // where the index of each channel stands
  };

  void put(std::string_view bytes);
  void end_chunk();
  std::string chunk_indexes() const;
  std::string statistics() const;

  std::ostream& out_;
  std::uint64_t at_ = 0;                 // bytes written
  std::string schemas_, channels_;       // their records, for the summary too
  std::vector<std::uint32_t> sequence_;  // of each channel: messages so far
  std::string chunk_;
  TimeSpan chunk_times_, times_;
  std::map<Channel, std::vector<Indexed>> chunk_index_;
  std::vector<Chunk> chunks_;
  std::uint64_t messages_ = 0;
};

}  // namespace stillcut
