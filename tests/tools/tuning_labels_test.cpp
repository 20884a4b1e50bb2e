#include "tools/tuning_labels.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/files/input_error.hpp"
#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

// Two logs, and labels.csv with `text`.
class LabelFolder : public TempFolder {
 public:
  explicit LabelFolder(const std::string& text) {
    for (const char* name : {"a.log", "b, c.log", "notes.txt"}) (void)write(name, "");
    (void)write("labels.csv", text);
  }

  // The message without the folder's name, which is random.
  [[nodiscard]] std::string error() const {
    std::string message = message_of<InputError>([&] { (void)read_labelled_logs(path()); });
    const std::string prefix = path().string() + "/";
    return message.starts_with(prefix) ? message.substr(prefix.size()) : message;
  }
};

TEST(Labels, AreReadForEveryLogInOrder) {
  const LabelFolder folder(
      "log,from_s,to_s,kind\n\"b, c.log\",5,6.5,unknown\na.log,,,\n\"b, c.log\",1.25,2,structural\n"
      "\"b, c.log\",1.5,3,regenerative\n\"b, c.log\",8,9,\n");
  const std::vector<LabelledLog> logs = read_labelled_logs(folder.path());
  ASSERT_EQ(logs.size(), 2U);
  EXPECT_EQ(logs[0].file, folder.path() / "a.log");
  EXPECT_TRUE(logs[0].stretches.empty());
  ASSERT_EQ(logs[1].stretches.size(), 4U);
  EXPECT_EQ(logs[1].lines, (std::vector<int>{4, 5, 2, 6}));
  EXPECT_EQ(logs[1].stretches[0].time.from_s, 1.25);
  EXPECT_EQ(logs[1].stretches[0].time.to_s, 2.0);
  EXPECT_EQ(logs[1].stretches[0].kind, ChatterKind::structural);
  EXPECT_EQ(logs[1].stretches[1].kind, ChatterKind::regenerative);
  EXPECT_EQ(logs[1].stretches[2].kind, ChatterKind::unknown);
  EXPECT_EQ(logs[1].stretches[3].kind, ChatterKind::unknown);
}

TEST(Labels, MayLeaveTheKindOut) {
  const LabelFolder folder("to_s,log,from_s,remark\n2,a.log,1,loud\n,\"b, c.log\",,\n");
  EXPECT_EQ(read_labelled_logs(folder.path())[0].stretches.at(0).time.from_s, 1.0);
}

struct BadLabel {
  std::string rows, starts, names;
};

TEST(Labels, MistakesNameFileLineAndColumn) {
  const std::string sound = "a.log,,,\n\"b, c.log\",,,\n";
  const std::vector<BadLabel> mistakes{
      {"", "labels.csv:1: ", "no label follows the header"},
      {"a.log,,,\n", "labels.csv:1: log: b, c.log is not listed", "\"\"b, c.log\",,,\""},
      {sound + "d.log,1,2,\n", "labels.csv:4: log: ", "\"d.log\" is no log of this folder"},
      {sound + "a.log,1,2,\n", "labels.csv:4: log: ", "free of chatter by line 2"},
      {sound + "a.log,,,\n", "labels.csv:4: log: ", "free of chatter by line 2"},
      {"a.log,1,2,\na.log,,,\n", "labels.csv:3: from_s: ", "line 2 says where a.log chatters"},
      {"a.log,1,,\n", "labels.csv:2: to_s: ", "give both times, or neither"},
      {"a.log,,1,\n", "labels.csv:2: from_s: ", "give both times, or neither"},
      {"a.log,,,unknown\n", "labels.csv:2: kind: ", "a log without chatter has no kind"},
      {"a.log,one,2,\n", "labels.csv:2: from_s: ", "\"one\" is no number"},
      {"a.log,1,nan,\n", "labels.csv:2: to_s: ", "is no number"},
      {"a.log,-1,2,\n", "labels.csv:2: from_s: ", "before the log's first frame"},
      {"a.log,2,2,\n", "labels.csv:2: to_s: ", "not after from_s"},
      {"a.log,1,2,loud\n", "labels.csv:2: kind: ", "\"loud\" is no kind; write regenerative"},
      {"a.log,1,2,unknown\na.log,1.5,3,\n", "labels.csv:3: from_s: ", "overlaps the stretch of line 2"},
      {"a.log,1\n", "labels.csv:2: ", "2 fields"},
      {"\"a.log,1,2,\n", "labels.csv:2: ", "quote is never closed"},
  };
  for (const BadLabel& mistake : mistakes) {
    const std::string message = LabelFolder("log,from_s,to_s,kind\n" + mistake.rows).error();
    EXPECT_THAT(message, testing::StartsWith(mistake.starts));
    EXPECT_THAT(message, testing::HasSubstr(mistake.names));
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
  EXPECT_THAT(LabelFolder("log,from,to_s,kind\n").error(), testing::StartsWith("labels.csv:1: from"));
  EXPECT_THAT(LabelFolder("").error(), testing::StartsWith("labels.csv: is empty"));
}

TEST(Labels, NeedAFolderWithLogsAndLabels) {
  const TempFolder folder;
  const auto error = [](const std::filesystem::path& path) {
    return message_of<InputError>([&] { (void)read_labelled_logs(path); });
  };
  EXPECT_THAT(error(folder.path()), testing::HasSubstr("holds no *.log"));
  EXPECT_THAT(error(folder.path() / "none"), testing::HasSubstr("is no folder"));
  (void)folder.write("a.log", "");
  EXPECT_THAT(error(folder.path()), testing::HasSubstr("labels.csv: no such file"));
}

TEST(Labels, EndWithTheirLog) {
  const LabelFolder folder("log,from_s,to_s,kind\na.log,1,2,\na.log,4,5.005,\n\"b, c.log\",,,\n");
  const LabelledLog log = read_labelled_logs(folder.path()).front();
  EXPECT_NO_THROW(check_labels_end(folder.path(), log, 5.0));
  const std::string message = message_of<InputError>([&] { check_labels_end(folder.path(), log, 4.5); });
  EXPECT_THAT(message, testing::HasSubstr("labels.csv:3: to_s: 5.005 is beyond the end of a.log, which is 4.5 s"));
}

}  // namespace
}  // namespace stillcut
