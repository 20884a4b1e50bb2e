#include "drivers/lcm/raw_listener.hpp"

#include <gtest/gtest.h>

#include <map>
#include <stdexcept>

namespace stillcut {
namespace {

std::map<std::string, int> heard_by(std::vector<std::string> patterns) {
  const LcmConnection lcm = open_lcm("memq://");
  std::map<std::string, int> heard;
  RawListener listener{lcm, patterns, [&](const RawMessage& message) {
                         heard[std::string(message.channel)] += static_cast<int>(message.bytes.size());
                       }};
  const std::vector<std::uint8_t> bytes{1, 2, 3};
  for (const char* channel : {"A", "AB", "B.C", "XAB"}) lcm_publish(lcm.get(), channel, bytes.data(), 3);
  lcm_publish(lcm.get(), "END", bytes.data(), 1);
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(listener.wait(0));
  return heard;
}

TEST(RawListener, HearsNamesAndPatternsThatMatchAWholeNameOnce) {
  EXPECT_EQ(heard_by({"A"}), (std::map<std::string, int>{{"A", 3}}));
  EXPECT_EQ(heard_by({"A", "A.*", "END"}), (std::map<std::string, int>{{"A", 3}, {"AB", 3}, {"END", 1}}));
  EXPECT_EQ(heard_by({".*"}).size(), 5U);
}

TEST(RawListener, RefusesPatternsThatAreNone) {
  for (const char* pattern : {"[", "a)b", "*"}) {
    EXPECT_NE(why_no_pattern(pattern), "") << pattern;
    EXPECT_THROW((void)heard_by({pattern}), std::invalid_argument) << pattern;
  }
  EXPECT_EQ(why_no_pattern("STILLCUT_.*"), "");
}

}  // namespace
}  // namespace stillcut
