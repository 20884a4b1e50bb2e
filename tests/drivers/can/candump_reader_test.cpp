#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "drivers/can/candump_log.hpp"
#include "drivers/files/input_error.hpp"
#include "tests/drivers/can/random_frame.hpp"
#include "tests/drivers/can/temporary_file.hpp"

namespace stillcut {
namespace {

const std::string kLine1 = "(1.000000) can0 123#01\n", kLine2 = "(1.001000) can1 124##102\n",
                  kLine3 = "(1.002000) can0 125#03\n";

std::vector<CanFrame> all_frames(CandumpReader& reader) {
  std::vector<CanFrame> frames;
  for (CanFrame frame; reader.next(frame);) frames.push_back(frame);
  return frames;
}

class CandumpReaderBothWays : public testing::TestWithParam<CandumpReader::Load> {};
INSTANTIATE_TEST_SUITE_P(Loads, CandumpReaderBothWays,
                         testing::Values(CandumpReader::Load::streaming, CandumpReader::Load::whole),
                         [](const auto& info) {
                           return info.param == CandumpReader::Load::streaming ? "Streaming" : "Whole";
                         });

TEST_P(CandumpReaderBothWays, DeliversEveryFrameInTheFilesOrder) {
  std::mt19937_64 random(3);
  std::vector<CanFrame> sent;
  std::string text;
  while (text.size() < std::size_t{3} << 20) {  // several buffers long
    sent.push_back(random_frame(random));
    std::array<char, kMaxCandumpLine> line{};
    text.append(line.data(), format_candump_line(sent.back(), "can0", line));
  }
  const TemporaryFile file(text);
  CandumpReader reader(file.path(), {}, GetParam());
  const std::vector<CanFrame> read = all_frames(reader);
  ASSERT_EQ(read.size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) ASSERT_TRUE(same_frame(read[i], sent[i])) << i;
  EXPECT_EQ(reader.frames(), static_cast<std::int64_t>(sent.size()));
  EXPECT_EQ(reader.frames_bad(), 0);
  EXPECT_EQ(reader.warning(), "");
}

TEST_P(CandumpReaderBothWays, CountsBadLinesAndNamesTheFirst) {
  const TemporaryFile file("# a comment\n\n" + kLine1 +
                           "gar\x01"
                           "bage\n" +
                           kLine2 + "(1.0) can0 12\n" + kLine3);
  CandumpReader reader(file.path(), {}, GetParam());
  EXPECT_EQ(all_frames(reader).size(), 3U);
  EXPECT_EQ(reader.frames_bad(), 2);
  EXPECT_EQ(reader.warning(),
            file.string() + ":4: 2 lines are no CAN frame and passed over; the first reads: gar?bage");
}

TEST_P(CandumpReaderBothWays, CountsALastLineCutShort) {
  // Cut in the middle of its data it would still be a frame, one that is too short.
  const TemporaryFile file(kLine1 + "(1.001000) can0 123#0102");
  CandumpReader reader(file.path(), {}, GetParam());
  EXPECT_EQ(all_frames(reader).size(), 1U);
  EXPECT_EQ(reader.frames_bad(), 1);
  EXPECT_EQ(reader.warning(), file.string() +
                                  ":2: one line is no CAN frame and passed over; the first was cut short: "
                                  "(1.001000) can0 123#0102");
}

TEST_P(CandumpReaderBothWays, DeliversStampsThatGoBack) {
  const TemporaryFile file(kLine3 + kLine1);
  CandumpReader reader(file.path(), {}, GetParam());
  const std::vector<CanFrame> frames = all_frames(reader);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_GT(frames[0].stamp_ns, frames[1].stamp_ns);
}

TEST_P(CandumpReaderBothWays, SurvivesALineLongerThanItsBuffer) {
  const TemporaryFile file(kLine1 + std::string(std::size_t{5} << 20, 'x') + "\n" + kLine2);
  CandumpReader reader(file.path(), {}, GetParam());
  EXPECT_EQ(all_frames(reader).size(), 2U);
  EXPECT_EQ(reader.frames_bad(), 1);
}

TEST(CandumpReader, TakesAllInterfacesOrTheOneAskedFor) {
  const TemporaryFile file(kLine1 + kLine2 + kLine3);
  CandumpReader all(file.path());
  CanFrame frame;
  ASSERT_TRUE(all.next(frame));
  ASSERT_TRUE(all.next(frame));
  EXPECT_EQ(all.interface(), "can1");
  CandumpReader one(file.path(), "can1");
  const std::vector<CanFrame> frames = all_frames(one);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].id, 0x124U);
  EXPECT_EQ(message_of<InputError>([&] { CandumpReader(file.path(), "can7"); }),
            file.string() + ": no frame of interface 'can7' in this log");
}

TEST(CandumpReader, RefusesWhatIsNoLog) {
  EXPECT_EQ(message_of<InputError>([] { CandumpReader("/nowhere/x.log"); }),
            "/nowhere/x.log: cannot be opened: No such file or directory");
  EXPECT_EQ(message_of<InputError>([] { CandumpReader("/tmp"); }), "/tmp: cannot be read: Is a directory");
  for (const char* content : {"", "\n\n# only comments\n", "not a log\n", "(1.0) can0 123#11"}) {
    const TemporaryFile file(content);
    EXPECT_EQ(message_of<InputError>([&] { CandumpReader reader(file.path()); }),
              file.string() + ": not one valid frame; a CAN log is what `candump -L` writes")
        << content;
  }
}

// tests/data/can_by_python_can.log was written by python-can 4.1.0 (can.CanutilsLogWriter).
TEST(CandumpReader, ReadsWhatPythonCanWrites) {
  CandumpReader reader(TEST_DATA "/can_by_python_can.log");
  const std::vector<CanFrame> f = all_frames(reader);
  ASSERT_EQ(f.size(), 7U);
  EXPECT_EQ(reader.frames_bad(), 0);
  EXPECT_EQ(f[0].stamp_ns, 1'500'000'000'000'001'000);
  EXPECT_EQ(f[0].id, 0x123U);
  EXPECT_EQ(f[0].length, 3);
  EXPECT_EQ(f[1].id, 0x18FEF100U | CanFrame::kExtended);
  EXPECT_EQ(f[1].data[7], 7);
  EXPECT_TRUE(f[2].fd);
  EXPECT_EQ(f[2].fd_flags, 1);
  EXPECT_EQ(f[2].length, 64);
  EXPECT_EQ(f[2].data[63], 63);
  EXPECT_EQ(f[3].id, 0x01ABCDEFU | CanFrame::kExtended);
  EXPECT_EQ(f[3].fd_flags, 3);
  EXPECT_EQ(f[3].length, 12);
  EXPECT_EQ(f[4].id, 0x7FFU | CanFrame::kRemote);
  EXPECT_EQ(f[5].id, 0U);
  EXPECT_EQ(f[5].length, 0);
  EXPECT_TRUE(f[6].is_error());
}

}  // namespace
}  // namespace stillcut
