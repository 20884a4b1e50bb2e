#include "drivers/can/candump_log.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/drivers/can/random_frame.hpp"

namespace stillcut {
namespace {

CanFrame parsed(std::string_view line) {
  CanFrame frame;
  EXPECT_EQ(parse_candump_line(line, frame), CandumpLine::frame) << line;
  return frame;
}

TEST(CandumpLine, EveryFrameSurvivesTheWayThroughALine) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 20'000; ++i) {
    const CanFrame sent = random_frame(random);
    std::array<char, kMaxCandumpLine> line{};
    const std::size_t length = format_candump_line(sent, "can0", line);
    ASSERT_EQ(line[length - 1], '\n');
    const std::string_view text(line.data(), length - 1);
    CanFrame read = random_frame(random);  // whatever was in it before must be gone
    std::string_view interface;
    ASSERT_EQ(parse_candump_line(text, read, &interface), CandumpLine::frame) << text;
    EXPECT_EQ(interface, "can0");
    EXPECT_TRUE(same_frame(sent, read)) << text;
  }
}

TEST(CandumpLine, WritesWhatCandumpWrites) {
  const auto formatted = [](const CanFrame& frame) {
    std::array<char, kMaxCandumpLine> line{};
    return std::string(line.data(), format_candump_line(frame, "can0", line));
  };
  for (const char* line :
       {"(1500000000.003000) can0 123#1122\n", "(1500000000.000001) can0 18FEF100#\n",
        "(0000000000.000000) can0 120##5AABB\n", "(1500000000.003000) can0 123#R4\n",
        "(1500000000.003000) can0 7FF#R\n", "(1500000000.003000) can0 20000040#0000000000000000\n"}) {
    EXPECT_EQ(formatted(parsed(std::string_view(line).substr(0, std::string_view(line).size() - 1))), line);
  }
}

TEST(CandumpLine, ReadsStampIdentifierFlagsAndData) {
  const CanFrame classic = parsed("(1500000000.250001) can0 123#A1b2");
  EXPECT_EQ(classic.stamp_ns, 1'500'000'000'250'001'000);
  EXPECT_EQ(classic.id, 0x123U);
  EXPECT_EQ(classic.length, 2);
  EXPECT_EQ(classic.data[0], 0xA1);
  EXPECT_EQ(classic.data[1], 0xB2);
  EXPECT_FALSE(classic.fd);

  const CanFrame fd = parsed("(1.000000) vcan0 18FEF100##7" + std::string(128, 'F'));
  EXPECT_EQ(fd.id, 0x18FEF100U | CanFrame::kExtended);
  EXPECT_TRUE(fd.fd);
  EXPECT_EQ(fd.fd_flags, 7);
  EXPECT_EQ(fd.length, 64);
  EXPECT_EQ(fd.data[63], 0xFF);

  const CanFrame error = parsed("(1.000000) can0 20000040#0000000000000000");
  EXPECT_TRUE(error.is_error());
  EXPECT_EQ(error.id, CanFrame::kError | 0x40U);
}

TEST(CandumpLine, CutsStampsToWholeMicroseconds) {
  EXPECT_EQ(parsed("(12.123456789) can0 1AB#").stamp_ns, 12'123'456'000);
  EXPECT_EQ(parsed("(12.5) can0 1AB#").stamp_ns, 12'500'000'000);
}

TEST(CandumpLine, AcceptsWhatOtherWritersAdd) {
  for (const char* tail : {" R", " T", " RX BRS -", "\r", " R\r", "  "}) {
    EXPECT_EQ(parsed(std::string("(1.000000)   can0  123#1122") + tail).length, 2) << tail;
    EXPECT_EQ(parsed(std::string("(1.000000) can0 123##11122") + tail).length, 2) << tail;
  }
  EXPECT_EQ(parsed("(1.000000) can0 123#1122334455667788_E").length, 8);
}

TEST(CandumpLine, PassesOverCommentsAndBlankLines) {
  CanFrame frame;
  for (const char* line : {"", "   ", "\r", "# clock: phc0", "  # cell"}) {
    EXPECT_EQ(parse_candump_line(line, frame), CandumpLine::nothing) << line;
  }
}

TEST(CandumpLine, RefusesWhatIsNoFrame) {
  CanFrame frame;
  for (const char* line : {"hello",
                           "(",
                           "()",
                           "(1.000000)",
                           "(1.000000) ",
                           "(1.000000) can0",
                           "(1.000000) can0 ",
                           "(1.000000) can0 123",
                           "(1.000000)can0 123#11",
                           "1.000000 can0 123#11",
                           "(-1.000000) can0 123#11",
                           "(1000000) can0 123#11",
                           "(1.) can0 123#11",
                           "(1.0000000000) can0 123#11",
                           "(9300000000.000000) can0 123#11",
                           "(99999999999.000000) can0 123#11",
                           "(1.000000) can0 123#1",
                           "(1.000000) can0 123#11G1",
                           "(1.000000) can0 12#11",
                           "(1.000000) can0 800#11",
                           "(1.000000) can0 1234#11",
                           "(1.000000) can0 40000000#11",
                           "(1.000000) can0 #11",
                           "(1.000000) can0 123#112233445566778899",
                           "(1.000000) can0 123##",
                           "(1.000000) can0 123##G11",
                           "(1.000000) can0 123#R9",
                           "(1.000000) can0 20000040#R",
                           "(1.000000) can0 123#11 22",
                           "(1.000000) can0 123#11 RIGHT",
                           "(1.000000) can0 123##11_8"}) {
    EXPECT_EQ(parse_candump_line(line, frame), CandumpLine::bad) << line;
  }
  const std::string too_long = "(1.000000) can0 123##1" + std::string(130, '0');
  EXPECT_EQ(parse_candump_line(too_long, frame), CandumpLine::bad);
}

// Any cut or damaged line is either refused or a frame within its bounds; the sanitizers watch the reads.
TEST(CandumpLine, BearsDamagedLines) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 20'000; ++i) {
    std::array<char, kMaxCandumpLine> buffer{};
    std::string line(buffer.data(), format_candump_line(random_frame(random), "can0", buffer));
    line.resize(random() % line.size());
    line.shrink_to_fit();
    if (!line.empty()) line[random() % line.size()] = static_cast<char>(random());
    CanFrame frame;
    if (parse_candump_line(line, frame) == CandumpLine::frame) {
      EXPECT_LE(frame.length, frame.fd ? 64 : 8);
      EXPECT_EQ(frame.stamp_ns % 1'000, 0);
    }
  }
}

}  // namespace
}  // namespace stillcut
