// The files of a recording: cut short, full, marked, in several runs.
#include "tools/recording_folder.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <fstream>

#include "drivers/can/candump_log.hpp"
#include "drivers/files/compressed_file.hpp"
#include "drivers/lcm/lcm_log.hpp"
#include "drivers/lcm/recording_messages.hpp"
#include "tests/drivers/files/temp_folder.hpp"
#include "tools/recorded_frames.hpp"

namespace stillcut {
namespace {

namespace fs = std::filesystem;

std::string line_of(int i) {
  CanFrame frame;
  frame.stamp_ns = 1'700'000'000'000'000'000 + i * std::int64_t{1'000'000};
  frame.id = 0x120;
  frame.length = 8;
  for (std::size_t b = 0; b < 8; ++b) frame.data[b] = static_cast<std::uint8_t>(i * 2654435761U >> (b * 3));
  std::array<char, kMaxCandumpLine> line{};
  return {line.data(), format_candump_line(frame, "can0", line)};
}

std::vector<std::int64_t> stamps_of(const std::vector<fs::path>& logs) {
  RecordedFrames log{logs};
  std::vector<std::int64_t> stamps;
  for (CanFrame frame; log.next(frame);) stamps.push_back(frame.stamp_ns);
  return stamps;
}

std::size_t segments_in(const fs::path& folder) {
  std::size_t n = 0;
  for (const auto& entry : fs::directory_iterator{folder}) n += entry.path().string().ends_with(".can.log.zst") ? 1 : 0;
  return n;
}

// Wherever a power cut ends the file behind a flush, all before the flush is there.
TEST(CompressedFile, CutShortGivesAllThatWasFlushed) {
  const TempFolder folder;
  const fs::path file = folder.path() / "a.can.log.zst", cut = folder.path() / "cut.can.log.zst";
  std::vector<std::pair<std::int64_t, int>> flushed;  // bytes on the disk, lines
  {
    CompressedFile log{file};
    for (int i = 0; i < 3000; ++i) {
      log.write(line_of(i));
      if (i % 500 != 499) continue;
      ASSERT_TRUE(log.flush());
      flushed.emplace_back(log.bytes_on_disk(), i + 1);
    }
  }
  const auto whole = static_cast<std::int64_t>(fs::file_size(file));
  for (std::int64_t size = flushed.front().first; size <= whole; size += 1031) {
    fs::copy_file(file, cut, fs::copy_options::overwrite_existing);
    fs::resize_file(cut, static_cast<std::uintmax_t>(size));
    int sure = 0;
    for (const auto& [bytes, lines] : flushed) sure = bytes <= size ? lines : sure;
    ASSERT_GE(std::ssize(stamps_of({cut})), sure) << size << " of " << whole << " bytes";
    fs::resize_file(cut, static_cast<std::uintmax_t>(size + 4096));  // and zeros behind, as ext4 may leave
    ASSERT_GE(std::ssize(stamps_of({cut})), sure) << size << " of " << whole << " bytes, then zeros";
  }
}

TEST(RecordingFolder, PlaysItsSegmentsInOrderAndTheNewestRecording) {
  const TempFolder folder;
  for (const char* name : {"20260101-000000", "20260102-000000"}) {
    RecordingFolder recording{{.folder = folder.path()}, name};
    for (int i = 0; i < 40; ++i) {
      if (i % 10 == 0) {
        ASSERT_TRUE(recording.begin(i));
      }
      recording.write_can(line_of(i));
      ASSERT_TRUE(recording.flush(i));
    }
    recording.close(40);
  }
  const RecordedSegments newest = find_segments(folder.path());
  EXPECT_EQ(newest.name, "20260102-000000");
  EXPECT_EQ(newest.others, 1);
  EXPECT_TRUE(newest.from_the_start);
  const std::vector<std::int64_t> stamps = stamps_of(newest.can);
  EXPECT_EQ(stamps.size(), 40U);
  EXPECT_TRUE(std::is_sorted(stamps.begin(), stamps.end()));
  EXPECT_EQ(find_segments(folder.path() / "20260101-000000").name, "20260101-000000");
  EXPECT_THROW(find_segments(folder.path() / "20260103-000000"), InputError);
}

// Writes segments of about `mib` each, one a second, until `seconds`; marks at `mark_at`.
void write_segments(RecordingFolder& recording, int seconds, int mark_at) {
  int line = 0;
  for (int second = 0; second < seconds; ++second) {
    ASSERT_TRUE(recording.begin(second));
    std::string text;
    while (text.size() < 3'000'000) text += line_of(line++);
    recording.write_can(text);
    if (second == mark_at) recording.mark("chatter onset", second);
    ASSERT_TRUE(recording.flush(second));
  }
  recording.close(seconds);
}

double mib_in(const fs::path& folder) {
  double bytes = 0.0;
  for (const auto& entry : fs::directory_iterator{folder}) bytes += static_cast<double>(entry.file_size());
  return bytes / 1048576.0;
}

TEST(RecordingFolder, StaysInItsBoundAndKeepsWhatIsMarked) {
  const TempFolder folder;
  RecordingFolder recording{
      {.folder = folder.path(), .keep_mib = 2.0, .keep_marked_mib = 100.0, .mark_before_s = 2, .mark_after_s = 2},
      "20260101-000000"};
  write_segments(recording, 30, 10);
  for (int kept : {9, 10, 11, 12, 13}) {  // seconds 8 to 12 are segments 9 to 13
    std::array<char, 64> name{};
    std::snprintf(name.data(), name.size(), "20260101-000000-%06d", kept);
    EXPECT_TRUE(fs::exists(folder.path() / (std::string(name.data()) + ".can.log.zst"))) << name.data();
    EXPECT_TRUE(fs::exists(folder.path() / (std::string(name.data()) + ".mark"))) << name.data();
  }
  EXPECT_FALSE(fs::exists(folder.path() / "20260101-000000-000005.can.log.zst"));
  EXPECT_FALSE(find_segments(folder.path()).from_the_start);
  EXPECT_LT(segments_in(folder.path()), 25U);
}

TEST(RecordingFolder, MarkedSegmentsHaveABoundToo) {
  const TempFolder folder;
  RecordingFolder recording{{.folder = folder.path(), .keep_mib = 1.0, .keep_marked_mib = 3.0, .mark_after_s = 1000},
                            "20260101-000000"};
  write_segments(recording, 30, 0);
  EXPECT_LT(mib_in(folder.path()), 6.0);
}

TEST(RecordingFolder, KeepsOnlyMarksWhenAsked) {
  const TempFolder folder;
  RecordingFolder recording{{.folder = folder.path(), .mark_before_s = 2, .mark_after_s = 2, .only_marks = true},
                            "20260101-000000"};
  write_segments(recording, 20, 10);
  EXPECT_LE(segments_in(folder.path()), 10U);
  EXPECT_TRUE(fs::exists(folder.path() / "20260101-000000-000009.can.log.zst"));
  EXPECT_FALSE(fs::exists(folder.path() / "20260101-000000-000002.can.log.zst"));
}

// A disk that takes no more, here a limit on the size of files: the error is told, and a new segment begins after it.
TEST(RecordingFolder, TellsOfARefusedWriteAndBeginsAgain) {
  const TempFolder folder;
  RecordingFolder recording{{.folder = folder.path()}, "20260101-000000"};
  ASSERT_TRUE(recording.begin(0.0));
  signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{1000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  std::string text;
  for (int i = 0; i < 2000; ++i) text += line_of(i);
  recording.write_can(text);
  const bool good = recording.flush(1.0);
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_FALSE(good);
  EXPECT_EQ(recording.error(), EFBIG);
  recording.close(1.0);
  ASSERT_TRUE(recording.begin(2.0));
  recording.write_can(line_of(5000));
  EXPECT_TRUE(recording.flush(2.0));
  recording.close(3.0);
  EXPECT_EQ(recording.number(), 2);
  EXPECT_EQ(stamps_of(find_segments(folder.path()).can).back(), 1'700'000'005'000'000'000);
}

TEST(RecordingMessages, ComeBackAsTheyWere) {
  const MessageBytes question = encode(RobotState{});
  const LobesUsed used{1'700'000'000'000'001'000, 0, 1'700'000'000'250'000'000, 1'700'000'001'000'000'000, true, 7};
  const MessageBytes bytes = encode(used, question);
  const auto back = decode_lobes_used(bytes);
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back.value.question, question);
  EXPECT_EQ(encode(back.value.used, back.value.question), bytes);
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_FALSE(decode_lobes_used(std::span{bytes}.first(length)).ok()) << length;
  const MessageBytes silence = encode(Silence{1'000'000, 5'000'000});
  EXPECT_EQ(decode_silence(silence).value.last_ns, 5'000'000);
  EXPECT_FALSE(decode_silence(bytes).ok());
}

}  // namespace
}  // namespace stillcut
