// MCAP files, walked through record by record after the format's specification. tests/system/export.py lets the
// format's own reader read them.
#include "drivers/files/mcap_writer.hpp"

#include <gtest/gtest.h>
#include <zstd.h>

#include <algorithm>
#include <random>
#include <sstream>

namespace stillcut {
namespace {

struct Reader {
  std::string_view bytes;
  std::size_t at = 0;

  std::uint64_t number(std::size_t size) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i)
      value |= std::uint64_t{static_cast<unsigned char>(bytes.at(at + i))} << (8 * i);
    at += size;
    return value;
  }
  std::string_view text(std::size_t size) {
    at += size;
    return bytes.substr(at - size, size);
  }
  std::string_view text() { return text(number(4)); }
};

struct Record {
  int kind = 0;
  std::size_t at = 0;
  std::string_view content;
};

std::vector<Record> records_in(std::string_view bytes, std::size_t begin = 0) {
  std::vector<Record> records;
  for (Reader reader{bytes, begin}; reader.at < bytes.size();) {
    const std::size_t at = reader.at;
    const int kind = static_cast<int>(reader.number(1));
    records.push_back({kind, at, reader.text(reader.number(8))});
  }
  return records;
}

struct Message {
  std::uint64_t channel = 0, time_ns = 0;
  std::string json;
  friend bool operator==(const Message&, const Message&) = default;
};

Message message_of(const Record& record) {
  Reader reader{record.content};
  Message message;
  message.channel = reader.number(2);
  reader.number(4);
  message.time_ns = reader.number(8);
  EXPECT_EQ(reader.number(8), message.time_ns) << "published when logged";
  message.json = reader.text(record.content.size() - reader.at);
  return message;
}

// The messages of a chunk in their order, and those that its index names.
std::string unpacked(const Record& chunk) {
  Reader reader{chunk.content};
  reader.number(8);
  reader.number(8);
  std::string records(reader.number(8), '\0');
  reader.number(4);
  EXPECT_EQ(reader.text(), "zstd");
  const std::string_view packed = reader.text(reader.number(8));
  EXPECT_EQ(reader.at, chunk.content.size());
  EXPECT_EQ(ZSTD_decompress(records.data(), records.size(), packed.data(), packed.size()), records.size());
  return records;
}

TEST(McapWriter, HoldsEveryMessageOnceAndIndexesEach) {
  std::ostringstream out;
  McapWriter writer{out, "test"};
  const auto a = writer.add_channel("/a", "A", R"({"type":"object"})"), b = writer.add_channel("/b", "B", "{}");
  std::mt19937 random{5};
  std::vector<Message> written;
  for (int i = 0; i < 40'000; ++i) {
    const auto channel = random() % 3 == 0 ? b : a;
    const std::uint64_t time = 1'000'000 + 10 * static_cast<std::uint64_t>(i) + random() % 1000;  // not in order
    const std::string json = R"({"n":)" + std::to_string(random()) + std::string(random() % 60, ' ') + "}";
    writer.write(channel, static_cast<std::int64_t>(time), json);
    written.push_back({channel, time, json});
  }
  writer.finish();
  const std::string file = out.str();
  const std::string_view magic{"\x89MCAP0\r\n", 8};
  ASSERT_TRUE(file.starts_with(magic) && file.ends_with(magic));
  const std::string_view inside = std::string_view{file}.substr(0, file.size() - magic.size());
  const std::vector<Record> records = records_in(inside, magic.size());
  EXPECT_EQ(records.front().kind, 1);
  ASSERT_EQ(records.back().kind, 2);

  std::vector<Message> found, indexed;
  std::string chunk;
  int chunks = 0;
  for (const Record& record : records) {
    if (record.kind == 6) {
      ++chunks;
      chunk = unpacked(record);
      for (const Record& message : records_in(chunk)) found.push_back(message_of(message));
    } else if (record.kind == 7) {
      Reader reader{record.content};
      const std::uint64_t channel = reader.number(2), bytes = reader.number(4);
      std::uint64_t last = 0;
      for (std::uint64_t i = 0; i < bytes / 16; ++i) {
        const std::uint64_t time = reader.number(8), offset = reader.number(8);
        EXPECT_GE(time, last);
        last = time;
        Reader at{chunk, offset};
        EXPECT_EQ(at.number(1), 5U);
        indexed.push_back(message_of({5, offset, at.text(at.number(8))}));
        EXPECT_EQ(indexed.back().channel, channel);
        EXPECT_EQ(indexed.back().time_ns, time);
      }
    }
  }
  EXPECT_GT(chunks, 1);
  EXPECT_TRUE(found == written) << found.size();
  EXPECT_EQ(indexed.size(), written.size());

  Reader footer{records.back().content};
  const std::uint64_t summary = footer.number(8), offsets = footer.number(8);
  int kind_before = 0, indexes = 0;
  for (const Record& record : records_in(inside, summary)) {
    if (record.at < offsets && record.kind == 8) {
      Reader index{record.content, 16};
      const std::uint64_t at = index.number(8), length = index.number(8);
      EXPECT_EQ(file[at], 6) << "an index that names no chunk";
      EXPECT_EQ(file[at + length], 7) << "nor its end";
      ++indexes;
    }
    if (record.kind == 14) {
      Reader offset{record.content};
      const auto group = offset.number(1);
      EXPECT_EQ(static_cast<std::uint64_t>(file[offset.number(8)]), group);
    }
    kind_before = record.kind;
  }
  EXPECT_EQ(kind_before, 2);
  EXPECT_EQ(indexes, chunks);
}

TEST(McapWriter, WithoutAMessageIsAFileAllTheSame) {
  std::ostringstream out;
  McapWriter writer{out, "test"};
  writer.add_channel("/a", "A", "{}");
  writer.finish();
  const std::string file = out.str();
  const auto records = records_in(std::string_view{file}.substr(0, file.size() - 8), 8);
  const auto statistics = std::find_if(records.begin(), records.end(), [](const Record& r) { return r.kind == 11; });
  ASSERT_NE(statistics, records.end());
  EXPECT_EQ(Reader{statistics->content}.number(8), 0U);
}

}  // namespace
}  // namespace stillcut
