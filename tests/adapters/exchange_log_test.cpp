#include "adapters/exchange_log.hpp"

#include <gtest/gtest.h>

#include <random>

#include "drivers/files/input_error.hpp"
#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

TEST(ExchangeLog, KeepsEveryByte) {
  std::mt19937 random{5};
  std::vector<ExchangeEntry> entries;
  for (int i = 0; i < 200; ++i) {
    ExchangeEntry entry{std::int64_t{i} * 1'000'003, static_cast<ExchangeKind>(i % 5), {}};
    for (int n = i; n > 0; --n) entry.bytes += static_cast<char>(random());
    entries.push_back(entry);
  }
  const TempFolder folder;
  const std::string file = (folder.path() / "exchange.txt").string();
  {
    ExchangeRecorder recorder{file, "a test"};
    for (const ExchangeEntry& entry : entries) recorder.put(entry.time_ns, entry.kind, entry.bytes);
  }
  EXPECT_EQ(read_exchange(file), entries);
}

TEST(ExchangeLog, ShowsTextAsItIs) {
  EXPECT_EQ(exchange_line({12, ExchangeKind::packet, "<Rob X=\"1\"/>\n\\"}), R"(12 packet <Rob X="1"/>\0a\5c)");
}

TEST(ExchangeLog, NamesTheLineThatItCannotRead) {
  const TempFolder folder;
  for (const char* line :
       {"packet <Rob/>", "12 parcel x", "12 packet", "x packet y", R"(12 packet \0)", R"(12 packet \y0)"}) {
    const std::string file = folder.write("bad.txt", std::string{"# a comment\n\n1 packet x\n"} + line + "\n").string();
    EXPECT_EQ(message_of<InputError>([&] { read_exchange(file); }),
              file + ":4: is not 'TIME KIND BYTES' as an adapter's --record writes it");
  }
  EXPECT_EQ(message_of<InputError>([] { read_exchange("/nowhere"); }), "/nowhere: cannot be read; check the name");
}

}  // namespace
}  // namespace stillcut
