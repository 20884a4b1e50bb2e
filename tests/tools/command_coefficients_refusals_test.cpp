// What `stillcut coefficients` refuses, and how it says so.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/tools/slot_cell.hpp"

namespace stillcut {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

struct BadTable {
  const char* name;
  std::string text;
  const char *line_starts, *line_names;
};
void PrintTo(const BadTable& bad, std::ostream* out) { *out << bad.name; }
class CoefficientsRefuses : public ::testing::TestWithParam<BadTable> {};

void expect_slot_refusal(const Finished& done, const std::string& starts, const std::string& names) {
  EXPECT_EQ(done.exit_code, 3) << done.err;
  EXPECT_EQ(done.out, "");
  EXPECT_THAT(done.err, StartsWith("stillcut: " + starts));
  EXPECT_THAT(done.err, HasSubstr(names));
  EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
}

TEST_P(CoefficientsRefuses, WithOneLineThatNamesThePlace) {
  const SlotCell cell;
  (void)cell.write("slots.csv", GetParam().text);
  expect_slot_refusal(coefficients(cell, {"slots.csv", "--csv", "-"}), GetParam().line_starts, GetParam().line_names);
}

const std::string kMeans = "feed_per_tooth_mm,axial_depth_mm,fx_mean_n,fy_mean_n,fz_mean_n\n";

INSTANTIATE_TEST_SUITE_P(
    Tables, CoefficientsRefuses,
    ::testing::Values(
        BadTable{"depth_negative", kMeans + "0.05,1,1,1,1\n0.05,-1,1,1,1\n",
                 "slots.csv:3: axial_depth_mm: ", "above 0"},
        BadTable{"depth_zero", kMeans + "0.05,0,1,1,1\n", "slots.csv:2: axial_depth_mm: ", "above 0"},
        BadTable{"feed_zero", kMeans + "0,1,1,1,1\n", "slots.csv:2: feed_per_tooth_mm: ", "above 0"},
        BadTable{"feed_in_um", kMeans + "50,1,1,1,1\n", "slots.csv:2: feed_per_tooth_mm: ", "up to 10"},
        BadTable{"force_missing", kMeans + "0.05,1,1,1,\n", "slots.csv:2: fz_mean_n: ", "number"},
        BadTable{"force_infinite", kMeans + "0.05,1,inf,1,1\n", "slots.csv:2: fx_mean_n: ", "inf"},
        BadTable{"force_impossible", kMeans + "0.05,1,1e300,1,1\n", "slots.csv:2: fx_mean_n: ", "out of range"},
        BadTable{"no_column", "feed_per_tooth_mm,axial_depth_mm,fx_mean_n,fy_mean_n\n0.05,1,1,1\n",
                 "slots.csv:1: fz_mean_n: ", "add it"},
        BadTable{"misspelt", "feed_per_tooth_mm,axial_depth_mm,fx_mean_n,fy_mean_n,fz_men_n\n0.05,1,1,1,1\n",
                 "slots.csv:1: fz_men_n: ", "did you mean fz_mean_n"},
        BadTable{"header_only", kMeans, "slots.csv:1: ", "add a row"}, BadTable{"empty", "", "slots.csv: ", "empty"},
        BadTable{"two_tests", kMeans + "0.05,1,1,1,1\n0.1,1,1,2,1\n", "slots.csv: 2 slot tests", "at least 3"},
        BadTable{"one_feed", kMeans + "0.05,1,1,1,1\n0.05,2,1,2,1\n0.05,3,1,2,1\n", "slots.csv: all tests",
                 "add tests at other feeds"},
        BadTable{"no_axial", kMeans + "0.05,1,1,1,0\n0.06,1,1,2,0\n0.07,1,1,2,0\n", "slots.csv: all axial",
                 "measure fz"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(CoefficientsCommandRefuses, RefusesBadRecordings) {
  const SlotCell cell;
  const std::string list = write_recordings(cell, 0.0, {});
  const auto refused = [&](std::initializer_list<std::string> more, const std::string& starts,
                           const std::string& names) {
    std::vector<std::string> arguments{"stillcut", "coefficients", "cell.toml", "--forces", "slots"};
    arguments.insert(arguments.end(), more);
    expect_slot_refusal(run(arguments, cell.path()), starts, names);
  };
  ASSERT_EQ(coefficients(cell, {"--forces", "slots", "--json"}).exit_code, 0);
  refused({"--zero", "0:2"}, "slots/0.04.csv: --zero 0:2 s overlaps the cut", "air only");
  refused({"--zero", "3:9"}, "slots/0.04.csv: --zero 3:9 s lies outside the recording", "0:3.9");
  refused({"--cut", "2:2.01"}, "slots/0.04.csv: --cut 2:2.01 s is shorter than a turn", "widen it");
  const auto spoilt = [&](const std::string& text, const std::string& starts, const std::string& names) {
    (void)cell.write("slots/0.07.csv", text);
    refused({}, starts, names);
  };
  const std::string header = "time_s,fx_n,fy_n,fz_n\n";
  spoilt(header + "0,1,1,1\n0,1,1,1\n", "slots/0.07.csv:3: time_s: ", "sort the rows");
  spoilt(header + "0,1,1,1\n", "slots/0.07.csv:1: ", "no two samples");
  spoilt(header + "0,0,0,0\n1,0,0,0\n", "slots/0.07.csv: holds no force", "");
  spoilt(header + "0,1,1,1\n0.001,1,1,1\n", "slots/0.07.csv: is shorter than a turn", "");
  spoilt(header + "0,1,1,1\n2,1,1,1\n", "slots/0.07.csv: no sample at 0:2 s", "sample faster");
  spoilt(dynamometer_recording({10, 10, 10}, 0.0, 0.012, {.cut_s = 1.7}), "slots/0.07.csv: the cut lasts",
         "longer slot");
  spoilt("time_s,fx_n,fy_n\n0,1,1\n", "slots/0.07.csv:1: fz_n: ", "add it");
  (void)cell.write("slots/tests.csv", list + "none.csv,0.05,1,5000\n,0.05,1,5000\n");
  std::filesystem::copy(cell.path() / "slots/0.04.csv", cell.path() / "slots/0.07.csv",
                        std::filesystem::copy_options::overwrite_existing);
  refused({}, "slots/none.csv: no such file", "");
  (void)cell.write("slots/tests.csv", list + "0.04.csv,0.05,1,0\n");
  refused({}, "slots/tests.csv:5: spindle_speed_rpm: ", "above 0");
  (void)cell.write("slots/tests.csv", list + ",0.05,1,5000\n");
  refused({}, "slots/tests.csv:5: file: ", "name the recording");
  (void)cell.write("tool.toml", "[tool]\nshape = \"ball\"\ndiameter_mm = 8.0\nteeth = 2\n");
  expect_slot_refusal(run({"stillcut", "coefficients", "tool.toml", "--forces", "slots"}, cell.path()),
                      "slots/tests.csv:1: ", "--feed-direction");
  expect_slot_refusal(coefficients(cell, {"--forces", "nowhere"}), "nowhere: ", "no such file");
}

TEST(CoefficientsCommandRefuses, RefusesWrongUsage) {
  const SlotCell cell;
  (void)cell.write("slots.csv", cell.table());
  const auto refused = [&](std::initializer_list<std::string> more, const std::string& names) {
    const Finished done = coefficients(cell, more);
    EXPECT_EQ(done.exit_code, 2) << done.err;
    EXPECT_THAT(done.err, HasSubstr(names));
  };
  refused({}, "--forces");
  refused({"slots.csv", "--zero", "0:1"}, "recordings");
  refused({"--forces", "slots", "--zero", "1:0"}, "FROM:TO");
  refused({"--forces", "slots", "--cut", "now"}, "FROM:TO");
  refused({"slots.csv", "--json", "--csv", "-"}, "--json");
  refused({"slots.csv", "--json", "--means", "-"}, "--means");
  EXPECT_THAT(coefficients(cell, {"--help"}).out, HasSubstr("Example: "));
}

}  // namespace
}  // namespace stillcut
