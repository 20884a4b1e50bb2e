// `stillcut coefficients` as a user meets it: from tables and recordings to a [material] block.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/tools/slot_cell.hpp"

namespace stillcut {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::vector<std::string> kKeys{"ktc_mpa", "krc_mpa", "kac_mpa", "kte_n_per_mm", "kre_n_per_mm", "kae_n_per_mm"};
const std::vector<double> kPaper{1661.8, 1240.8, 19.1, 7.1, 15.9, 2.3};  // Liu et al. 2024, Table 1

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
  EXPECT_THAT(content_of(cell.path() / "c.csv"), StartsWith("coefficient,value,standard_error\nktc_mpa,1661."));
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

// A coefficient that the cell file does not take below zero, and that is zero within its error. Breaks where the block
// is refused by the cell file.
TEST(CoefficientsCommand, PrintsABlockToPasteWhereNoiseTurnsASign) {
  const SlotCell cell;
  (void)cell.write("slots.csv",
                   "feed_per_tooth_mm,axial_depth_mm,fx_mean_n,fy_mean_n,fz_mean_n\n"
                   "0.02,1,-6,16,6\n0.06,1,-16,50,16\n0.1,1,-25,81,25\n0.1,1,-27,85,27\n");
  const Finished people = coefficients(cell, {"slots.csv"});
  ASSERT_EQ(people.exit_code, 0) << people.err;
  EXPECT_THAT(people.out, HasSubstr("kte_n_per_mm = 0.0  # fitted -"));
  const auto file = cell.write("pasted.toml", people.out.substr(people.out.find("[material]")));
  EXPECT_EQ(read_cell(file, {.dbc = false, .bus = false}).material->kte, 0.0);
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

}  // namespace
}  // namespace stillcut
