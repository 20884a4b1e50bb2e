#include "drivers/files/csv.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <sstream>

#include "drivers/files/input_error.hpp"
#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

std::string csv_error(std::string_view text) {
  return message_of<InputError>([&] { parse_csv(text, "t.csv"); });
}

TEST(Csv, ReadsQuotedFieldsAsRfc4180HasThem) {
  const CsvTable table = parse_csv("a,b\r\n\"1,5\",\"say \"\"no\"\"\"\r\n\"two\nlines\",\r\n,last", "t.csv");
  ASSERT_EQ(table.rows().size(), 3U);
  EXPECT_EQ(table.rows()[0].fields, (std::vector<std::string>{"1,5", "say \"no\""}));
  EXPECT_EQ(table.rows()[1].fields, (std::vector<std::string>{"two\nlines", ""}));
  EXPECT_EQ(table.rows()[2].fields, (std::vector<std::string>{"", "last"}));
}

TEST(Csv, CountsLinesThroughCommentsEmptyLinesAndQuotedLineBreaks) {
  const CsvTable table = parse_csv("# made by hand\n\na,b\n1,\"x\ny\"\n# more\n2,z\n", "t.csv");
  EXPECT_EQ(parse_csv("# only a comment\na\n", "t.csv").header_line(), 2);
  ASSERT_EQ(table.rows().size(), 2U);
  EXPECT_EQ(table.rows()[0].line, 4);
  EXPECT_EQ(table.rows()[1].line, 7);
}

TEST(Csv, IgnoresAByteOrderMark) {
  const TempFolder folder;
  EXPECT_EQ(read_csv(folder.write("t.csv", "\xEF\xBB\xBFspeed\n1\n")).header().front(), "speed");
}

TEST(Csv, ReadsNumbersWithOrWithoutBlanksAndSign) {
  const CsvTable table = parse_csv("a, b\n 1.5e3 ,+2\n", "t.csv");
  EXPECT_EQ(table.number(table.rows()[0], table.require_column("a")), 1500.0);
  EXPECT_EQ(table.number(table.rows()[0], table.require_column("b")), 2.0);
}

TEST(Csv, RefusesWhatIsNoFiniteNumberWithLineAndColumn) {
  for (const char* word : {"", "1,5", "nan", "inf", "1e999", "0x10", "1 2", "--1", "+-1", "abc"}) {
    const CsvTable table = parse_csv("n,depth_mm\n1,\"" + std::string(word) + "\"\n", "t.csv");
    const std::string message = message_of<InputError>([&] { (void)table.number(table.rows()[0], 1); });
    EXPECT_TRUE(message.starts_with("t.csv:2: depth_mm: \"" + std::string(word) + "\" is no number")) << message;
  }
}

TEST(Csv, NamesLineOfMalformedRows) {
  EXPECT_EQ(csv_error(""), "t.csv: is empty; a CSV file begins with a header row");
  EXPECT_EQ(csv_error("# comment only\n"), "t.csv: is empty; a CSV file begins with a header row");
  EXPECT_TRUE(csv_error("a,b\n1,2\n3\n").starts_with("t.csv:3: has 1 fields, the header 2"));
  EXPECT_TRUE(csv_error("a,b\n1,2,3\n").starts_with("t.csv:2: has 3 fields"));
  EXPECT_TRUE(csv_error("a,a\n").starts_with("t.csv:1: a: stands twice"));
  EXPECT_TRUE(csv_error("a\n1\n\"open\n\n").starts_with("t.csv:3: a quote is never closed"));
  EXPECT_TRUE(csv_error("a\n\"x\"y\n").starts_with("t.csv:2: text after the closing quote"));
  EXPECT_TRUE(csv_error("a\nx\"y\"\n").starts_with("t.csv:2: a quote within a field"));
}

TEST(Csv, NamesAMissingColumnAndFile) {
  const CsvTable table = parse_csv("a\n", "t.csv");
  EXPECT_EQ(message_of<InputError>([&] { (void)table.require_column("b"); }),
            "t.csv:1: b: the header lacks this column; add it");
  EXPECT_FALSE(table.find_column("b"));
  EXPECT_EQ(message_of<InputError>([] { read_csv("/no/such/file.csv"); }),
            "/no/such/file.csv: no such file; check the path");
}

TEST(Csv, WritesNumbersThatReadBackBitForBit) {
  std::mt19937_64 random(7);
  std::string text = "v\n";
  std::vector<double> values;
  while (values.size() < 2000) {
    const double value = std::bit_cast<double>(random());
    if (!std::isfinite(value)) continue;
    values.push_back(value);
    text += csv_number(value) + "\n";
  }
  const CsvTable table = parse_csv(text, "t.csv");
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(table.number(table.rows()[i], 0)), std::bit_cast<std::uint64_t>(values[i]));
  }
  EXPECT_EQ(csv_number(0.1), "0.1");
  EXPECT_EQ(csv_number(-std::numeric_limits<double>::quiet_NaN()), "nan");
  EXPECT_EQ(csv_number(-std::numeric_limits<double>::infinity()), "-inf");
  EXPECT_EQ(csv_number_or_empty(std::nan("")), "");
}

TEST(Csv, WritesTextThatReadsBack) {
  std::mt19937 random(11);
  constexpr std::string_view kLetters = "a,\"\n\r# x";
  for (int i = 0; i < 2000; ++i) {
    std::vector<std::string> row(2);
    for (std::string& field : row) {
      for (std::size_t length = random() % 8; length > 0; --length) field += kLetters[random() % kLetters.size()];
    }
    std::ostringstream out;
    write_csv_row(out, std::vector<std::string>{"one", "two"});
    write_csv_row(out, std::vector<std::string>{csv_text(row[0]), csv_text(row[1])});
    const CsvTable table = parse_csv(out.str(), "t.csv");
    ASSERT_EQ(table.rows().size(), 1U) << out.str();
    EXPECT_EQ(table.rows()[0].fields, row);
  }
}

}  // namespace
}  // namespace stillcut
