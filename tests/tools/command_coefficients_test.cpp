// `stillcut coefficients` as a user meets it: from tables and recordings to a [material] block, and what it refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "drivers/files/cell.hpp"
#include "drivers/files/csv.hpp"
#include "tests/tools/run_program.hpp"
#include "tools/slot_tests.hpp"

namespace stillcut {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::vector<std::string> kKeys{"ktc_mpa", "krc_mpa", "kac_mpa", "kte_n_per_mm", "kre_n_per_mm", "kae_n_per_mm"};
const std::vector<double> kPaper{1661.8, 1240.8, 19.1, 7.1, 15.9, 2.3};  // Liu et al. 2024, Table 1

// The demo cell with the tool of the surface paper and its coefficients.
class SlotCell : public DemoCell {
 public:
  SlotCell() {
    change("shape = \"end\"", "shape = \"ball\"\nhelix_deg = 45.0");
    change("diameter_mm = 20.0", "diameter_mm = 8.0");
    change("runout_mm = 0.004", "");
    change("radial_depth_mm = 10.0", "radial_depth_mm = 8.0");
    change("milling = \"down\"", "milling = \"slot\"");
    for (const auto& [from, to] : {std::pair{"ktc_mpa = 800.0", "ktc_mpa = 1661.8"},
                                   {"krc_mpa = 300.0", "krc_mpa = 1240.8"},
                                   {"kac_mpa = 100.0", "kac_mpa = 19.1"},
                                   {"kte_n_per_mm = 8.0", "kte_n_per_mm = 7.1"},
                                   {"kre_n_per_mm = 6.0", "kre_n_per_mm = 15.9\nkae_n_per_mm = 2.3"}})
      change(from, to);
  }
  [[nodiscard]] Cell cell() const { return read_cell(path() / "cell.toml", {.dbc = false, .bus = false}); }

  // Mean force in the feed frame.
  [[nodiscard]] Eigen::Vector3d mean(double feed_mm, double depth_mm) const {
    return slot_influence(*cell().tool, feed_mm * 1e-3, depth_mm * 1e-3) * six_coefficients(*cell().material);
  }

  [[nodiscard]] std::string table(double scale = 1.0) const {
    std::vector<SlotTest> tests;
    for (const double depth : {0.5, 1.0})
      for (const double feed : {0.02, 0.04, 0.06, 0.08, 0.1})
        tests.push_back({feed * 1e-3, depth * 1e-3, scale * mean(feed, depth)});
    std::ostringstream text;
    write_slot_tests(text, tests);
    return text.str();
  }
};

Finished coefficients(const DemoCell& cell, std::initializer_list<std::string> more) {
  std::vector<std::string> arguments{"stillcut", "coefficients", "cell.toml"};
  arguments.insert(arguments.end(), more);
  return run(arguments, cell.path());
}

void expect_paper(const std::string& json, double relative) {
  const auto object = nlohmann::json::parse(json);
  for (std::size_t i = 0; i < kKeys.size(); ++i) {
    EXPECT_NEAR(object[kKeys[i]].get<double>(), kPaper[i], relative * kPaper[i]) << kKeys[i];
    EXPECT_GE(object[kKeys[i] + "_se"].get<double>(), 0.0);
  }
}

// Breaks with a unit, a key, or a column that is not the contract's.
TEST(CoefficientsCommand, GivesBackWhatMadeTheTable) {
  const SlotCell cell;
  (void)cell.write("slots.csv", cell.table());
  const Finished json = coefficients(cell, {"slots.csv", "--json", "--plot", "a.svg", "--csv", "c.csv"});
  ASSERT_EQ(json.exit_code, 0) << json.err;
  EXPECT_EQ(json.err, "");
  expect_paper(json.out, 1e-9);
  EXPECT_THAT(content_of(cell.path() / "c.csv"), StartsWith("coefficient,value,standard_error\nktc_mpa,1661.8"));
  ASSERT_EQ(coefficients(cell, {"slots.csv", "--plot", "b.svg"}).exit_code, 0);
  EXPECT_THAT(content_of(cell.path() / "a.svg"), HasSubstr("<svg"));
  EXPECT_EQ(content_of(cell.path() / "a.svg"), content_of(cell.path() / "b.svg"));
}

// Breaks with a block that no cell file takes.
TEST(CoefficientsCommand, PrintsABlockToPaste) {
  const SlotCell cell;
  (void)cell.write("slots.csv", cell.table());
  const Finished people = coefficients(cell, {"slots.csv"});
  ASSERT_EQ(people.exit_code, 0) << people.err;
  EXPECT_THAT(people.out, StartsWith("10 slots of a 8 mm ball end, 2 teeth: 5 feeds per tooth, 0.02 to 0.1 mm; 0.5 to "
                                     "1 mm deep\n"));
  const auto block = people.out.find("[material]");
  ASSERT_NE(block, std::string::npos);
  const auto file = cell.write("pasted.toml", people.out.substr(block));
  const Material material = *read_cell(file, {.dbc = false, .bus = false}).material;
  EXPECT_EQ(material.name, "AL7075-T6");
  EXPECT_NEAR(material.ktc, 1661.8e6, 1e3);
  EXPECT_NEAR(material.kae, 2.3e3, 1.0);
}

TEST(CoefficientsCommand, WarnsOfForcesOnTheWorkpiece) {
  const SlotCell cell;
  (void)cell.write("slots.csv", cell.table(-1.0));
  const Finished done = coefficients(cell, {"slots.csv", "--json"});
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_THAT(done.err,
              HasSubstr("stillcut: slots.csv: ktc and krc are negative: are these the forces on the workpiece"));
  EXPECT_EQ(nlohmann::json::parse(done.out)["warnings"].size(), 2u) << done.out;
}

struct Instrument {
  double offset = 0.0, drift = 0.0;  // N, N/s
  double entry_s = 1.0, cut_s = 3.7, end_s = 4.0;
};

// What a dynamometer shows of a slot: air, the force growing as the tool enters, tooth passing and runout in the cut,
// air; at a rate that fits no turn.
std::string recorded(const Eigen::Vector3d& mean, double direction, double turn_s, const Instrument& instrument) {
  std::ostringstream text;
  text.precision(12);
  text << "time_s,fx_n,fy_n,fz_n\n";
  const double c = std::cos(direction), s = std::sin(direction);
  const Eigen::Vector3d workpiece(c * mean.x() - s * mean.y(), s * mean.x() + c * mean.y(), mean.z());
  constexpr double kRate = 5321.0, kEntryTakes = 0.4;
  for (int i = 0; i < static_cast<int>(instrument.end_s * kRate); ++i) {
    const double t = i / kRate;
    double cutting = std::clamp((t - instrument.entry_s) / kEntryTakes, 0.0, 1.0);
    if (t > instrument.cut_s) cutting = 0.0;
    const double turn = kTwoPi * t / turn_s;
    const double wave = 1.0 + 0.7 * std::cos(2.0 * turn) + 0.3 * std::cos(turn + 1.0);
    text << t;
    for (int axis = 0; axis < 3; ++axis)
      text << ',' << cutting * wave * workpiece[axis] + instrument.offset + instrument.drift * t;
    text << '\n';
  }
  return text.str();
}

std::string write_recordings(const SlotCell& cell, double direction, const Instrument& instrument) {
  std::string list = "file,feed_per_tooth_mm,axial_depth_mm,spindle_speed_rpm\n";
  for (const std::string feed : {"0.04", "0.07", "0.1"}) {
    (void)cell.write("slots/" + feed + ".csv", recorded(cell.mean(std::stod(feed), 1.0), direction, 0.012, instrument));
    list += feed + ".csv," + feed + ",1,5000\n";
  }
  (void)cell.write("slots/tests.csv", list);
  return list;
}

// Breaks with part turns, with the offset left in, with the feed frame turned the wrong way, with entry counted as cut.
TEST(CoefficientsCommand, FindsTheMeanForcesInRecordings) {
  const SlotCell cell;
  write_recordings(cell, deg_to_rad(30), {.offset = 12.0, .drift = -2.0});
  const Finished done = coefficients(cell, {"--forces", "slots", "--feed-direction", "30", "--zero", "0:0.9", "--zero",
                                            "3.75:3.95", "--means", "means.csv", "--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(done.err, "");
  const std::vector<SlotTest> means = read_slot_tests(cell.path() / "means.csv");
  ASSERT_EQ(means.size(), 3u);
  for (const SlotTest& test : means) {
    const Eigen::Vector3d made = cell.mean(test.feed_per_tooth * 1e3, 1.0);
    EXPECT_LT((test.mean_force - made).norm(), 2e-3 * made.norm()) << test.mean_force.transpose();
  }
  const Finished again = coefficients(cell, {"means.csv", "--json"});
  for (const std::string& key : kKeys)
    EXPECT_NEAR(nlohmann::json::parse(again.out)[key].get<double>(), nlohmann::json::parse(done.out)[key].get<double>(),
                1e-6);
  // The drift is seen where nothing takes it off; the direction may stand in the list.
  write_recordings(cell, deg_to_rad(30), {.drift = -10.0});
  EXPECT_THAT(coefficients(cell, {"--forces", "slots", "--zero", "0:0.9", "--json"}).err,
              HasSubstr("slots/0.04.csv: the force drifts within the cut"));
}

// The chain of docs/coefficients.md, on the cell's own structure; breaks where the simulation's frames or signs change.
TEST(CoefficientsCommand, ReadsWhatSimulateWrites) {
  const SlotCell cell;
  cell.change("feed_direction_deg = 0.0", "feed_direction_deg = -60.0");
  std::string list = "file,feed_per_tooth_mm,axial_depth_mm,spindle_speed_rpm\n", feed = "0.05";
  for (const std::string next : {"0.04", "0.08", "0.12"}) {
    cell.change("feed_per_tooth_mm = " + feed, "feed_per_tooth_mm = " + next);
    feed = next;
    const Finished done = run({"stillcut", "simulate", "cell.toml", "--duration", "0.5", "--depth", "0:0.3",
                               "--force-noise", "0", "--csv", feed + ".csv"},
                              cell.path());
    ASSERT_EQ(done.exit_code, 0) << done.err;
    list += feed + ".csv," + feed + ",0.3,8500\n";
  }
  (void)cell.write("list.csv", list);
  const Finished done = coefficients(cell, {"--forces", "list.csv", "--cut", "0.2:0.5", "--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const auto object = nlohmann::json::parse(done.out);
  EXPECT_NEAR(object["ktc_mpa"].get<double>(), 1661.8, 0.005 * 1661.8);
  EXPECT_NEAR(object["krc_mpa"].get<double>(), 1240.8, 0.01 * 1240.8);
  EXPECT_NEAR(object["kre_n_per_mm"].get<double>(), 15.9, 0.01 * 15.9);
}

struct BadTable {
  const char* name;
  std::string text;
  const char *line_starts, *line_names;
};
void PrintTo(const BadTable& bad, std::ostream* out) { *out << bad.name; }
class CoefficientsRefuses : public ::testing::TestWithParam<BadTable> {};

void expect_refusal(const Finished& done, const std::string& starts, const std::string& names) {
  EXPECT_EQ(done.exit_code, 3) << done.err;
  EXPECT_EQ(done.out, "");
  EXPECT_THAT(done.err, StartsWith("stillcut: " + starts));
  EXPECT_THAT(done.err, HasSubstr(names));
  EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
}

TEST_P(CoefficientsRefuses, WithOneLineThatNamesThePlace) {
  const SlotCell cell;
  (void)cell.write("slots.csv", GetParam().text);
  expect_refusal(coefficients(cell, {"slots.csv", "--csv", "-"}), GetParam().line_starts, GetParam().line_names);
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

TEST(CoefficientsCommand, RefusesBadRecordings) {
  const SlotCell cell;
  const std::string list = write_recordings(cell, 0.0, {});
  const auto refused = [&](std::initializer_list<std::string> more, const std::string& starts,
                           const std::string& names) {
    std::vector<std::string> arguments{"stillcut", "coefficients", "cell.toml", "--forces", "slots"};
    arguments.insert(arguments.end(), more);
    expect_refusal(run(arguments, cell.path()), starts, names);
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
  spoilt(recorded({10, 10, 10}, 0.0, 0.012, {.cut_s = 1.7}), "slots/0.07.csv: the cut lasts", "longer slot");
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
  expect_refusal(run({"stillcut", "coefficients", "tool.toml", "--forces", "slots"}, cell.path()),
                 "slots/tests.csv:1: ", "--feed-direction");
  expect_refusal(coefficients(cell, {"--forces", "nowhere"}), "nowhere: ", "no such file");
}

TEST(CoefficientsCommand, RefusesWrongUsage) {
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
