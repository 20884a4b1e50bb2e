#include "tools/styled_text.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tools/big_letters.hpp"

namespace stillcut {
namespace {

std::string random_bytes(std::mt19937& random, std::size_t length) {
  std::string bytes;
  for (std::size_t i = 0; i < length; ++i) bytes += static_cast<char>(random());
  return bytes;
}

TEST(StyledText, PrintableKeepsWordsOfOursAndNothingThatATerminalObeys) {
  EXPECT_EQ(printable("11 220 rpm, 45°, ±2 µm – n = 60 f_c/(N k) → stable…"),
            "11 220 rpm, 45°, ±2 µm – n = 60 f_c/(N k) → stable…");
  EXPECT_EQ(printable("\x1b[2J\x07\r\n\x7f\xc2\x9b!"),
            "?[2J?????"
            "!");
  EXPECT_EQ(printable("\xff\xc0\xaf\xe2\x82"), "?????");
  EXPECT_EQ(printable("漢e\u0301\u202e"), "?e??") << "wide, combining, turning around";
  std::mt19937 random{4};
  for (int round = 0; round < 2000; ++round) {
    const std::string text = printable(random_bytes(random, random() % 60));
    EXPECT_EQ(printable(text), text);
    for (const char c : text) EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7F);
    for (const char c : ascii(text)) EXPECT_TRUE(c >= ' ' && c <= '~');
    EXPECT_EQ(width_of(ascii(text)), width_of(text));
  }
}

TEST(StyledText, ClippedIsNeverTooWideAndSaysThatItIsCut) {
  EXPECT_EQ(clipped("µµµ", 3), "µµµ");
  EXPECT_EQ(clipped("µµµµ", 3), "µµ…");
  EXPECT_EQ(clipped("abc", 0), "");
  std::mt19937 random{5};
  for (int round = 0; round < 2000; ++round) {
    TextLine line;
    for (unsigned pieces = random() % 4; pieces > 0; --pieces)
      line.push_back({Ink::plain, printable(random_bytes(random, random() % 12))});
    const int width = static_cast<int>(random() % 24);
    const TextLine cut = clipped(line, width);
    if (width_of(line) <= width) {
      EXPECT_EQ(text_of(cut), text_of(line));
    } else {
      EXPECT_EQ(width_of(cut), width);
      EXPECT_TRUE(width == 0 || text_of(cut).ends_with("…"));
    }
    EXPECT_EQ(width_of(padded(text_of(line), width)), width);
  }
}

TEST(StyledText, WrappedLosesNoWord) {
  std::mt19937 random{6};
  for (int round = 0; round < 1000; ++round) {
    TextLine line;
    std::string words;
    for (unsigned count = 1 + random() % 12; count > 0; --count) {
      const std::string word(1 + random() % 9, static_cast<char>('a' + random() % 26));
      words += word;
      line.push_back({random() % 2 == 0 ? Ink::plain : Ink::good, word + " "});
    }
    const int width = 20 + static_cast<int>(random() % 40);
    std::string found;
    for (const TextLine& one : wrapped(line, width, 4)) {
      EXPECT_LE(width_of(one), width);
      for (const char c : text_of(one))
        if (c != ' ') found += c;
    }
    EXPECT_EQ(found, words);
  }
  EXPECT_EQ(wrapped("one two three", 7, 2), (std::vector<std::string>{"one two", "three"}));
  EXPECT_EQ(wrapped("one two three four", 7, 2), (std::vector<std::string>{"one two", "three …"}));
}

TEST(BigLetters, HaveThreeRowsOfTheSaidWidth) {
  for (const char* word : {"stable", "not cutting", "cannot tell", "fault", "w3?"})
    for (const std::string& row : big_letters(word)) EXPECT_EQ(width_of(row), big_width(word)) << word;
  EXPECT_EQ(big_letters("L")[0], "█   ");
  EXPECT_EQ(big_letters("l")[2], "▀▀▀ ");
}

}  // namespace
}  // namespace stillcut
