// The section [recording] of a cell file.
#include <gtest/gtest.h>

#include "drivers/files/cell.hpp"
#include "tests/drivers/files/example_cell.hpp"

namespace stillcut {
namespace {

TEST(CellRecording, EveryKeyIsReadAndTheFolderStartsAtTheCell) {
  const TempFolder folder;
  const RecordingSettings read = read_cell(write_example_cell(folder, kExampleCell + R"([recording]
folder = "../recordings"
segment_s = 30
keep_mib = 100
keep_marked_mib = 200
mark_before_s = 5
mark_after_s = 7
only_marks = true
)"))
                                     .recording;
  EXPECT_EQ(read.folder, (std::filesystem::absolute(folder.path()).parent_path() / "recordings").lexically_normal());
  EXPECT_EQ(read.segment_s, 30.0);
  EXPECT_EQ(read.keep_mib, 100.0);
  EXPECT_EQ(read.keep_marked_mib, 200.0);
  EXPECT_EQ(read.mark_before_s, 5.0);
  EXPECT_EQ(read.mark_after_s, 7.0);
  EXPECT_TRUE(read.only_marks);
}

TEST(CellRecording, WithoutTheSectionNothingIsRecorded) {
  const TempFolder folder;
  EXPECT_TRUE(read_cell(write_example_cell(folder, kExampleCell)).recording.folder.empty());
}

TEST(CellRecording, MistakesNameTheKey) {
  for (const char* wrong : {"folder = \"r\"\nsegment_s = 0", "folder = \"r\"\nkeep_mb = 3", "segment_s = 60"}) {
    const TempFolder folder;
    try {
      (void)read_cell(write_example_cell(folder, kExampleCell + "[recording]\n" + wrong + "\n"));
      ADD_FAILURE() << wrong << " was accepted";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("recording."), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace stillcut
