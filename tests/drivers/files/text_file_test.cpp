#include "drivers/files/text_file.hpp"

#include <gtest/gtest.h>

#include "drivers/files/input_error.hpp"
#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

std::size_t files_in(const std::filesystem::path& folder) {
  std::size_t count = 0;
  for (const auto& unused : std::filesystem::directory_iterator(folder)) {
    (void)unused;
    ++count;
  }
  return count;
}

TEST(TextFiles, AreWrittenTogetherIntoANewFolder) {
  const TempFolder folder;
  const auto place = folder.path() / "new" / "map";
  write_text_files(place, {{"a.csv", "one\n"}, {"b.csv", std::string(100000, 'x')}});
  EXPECT_EQ(read_text_file(place / "a.csv"), "one\n");
  EXPECT_EQ(read_text_file(place / "b.csv").size(), 100000U);
  write_text_files(place, {{"a.csv", "two\n"}});
  EXPECT_EQ(read_text_file(place / "a.csv"), "two\n");
  EXPECT_EQ(files_in(place), 2U);
}

TEST(TextFiles, StayAsTheyWereWhereOneCannotBeWritten) {
  const TempFolder folder;
  (void)folder.write("a.csv", "old\n");
  std::filesystem::create_directory(folder.path() / "b.csv");
  const std::string message = message_of<InputError>([&] {
    write_text_files(folder.path(), {{"a.csv", "new\n"}, {"b.csv", "new\n"}});
  });
  EXPECT_EQ(message, (folder.path() / "b.csv").string() + ": is a folder; remove it");
  EXPECT_EQ(read_text_file(folder.path() / "a.csv"), "old\n");
  EXPECT_EQ(files_in(folder.path()), 2U);
}

}  // namespace
}  // namespace stillcut
