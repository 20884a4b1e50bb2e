// `stillcut lobes` as a user meets it: one diagram and several, bands of confidence, measured cuts, and what it
// refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "drivers/files/csv.hpp"
#include "tests/tools/run_program.hpp"

namespace stillcut {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::vector<std::string> lobes(std::initializer_list<std::string> more) {
  std::vector<std::string> arguments{"stillcut", "lobes", "cell.toml", "--speed", "7000:9000:5"};
  arguments.insert(arguments.end(), more);
  return arguments;
}

CsvTable csv_of(const DemoCell& cell, std::initializer_list<std::string> more) {
  std::vector<std::string> arguments = lobes(more);
  arguments.insert(arguments.end(), {"--csv", "-"});
  const Finished done = run(arguments, cell.path());
  EXPECT_EQ(done.exit_code, 0) << done.err;
  return parse_csv(done.out, "stdout");
}

const std::vector<std::string> kPinned{"spindle_speed_rpm", "a_lim_mm", "chatter_frequency_hz"};

TEST(LobesCommand, OneDiagramIsAsPinned) {
  const DemoCell cell;
  const CsvTable table = csv_of(cell, {"--feed-direction", "-45", "--posture", "0,-90,90,0,90,0"});
  EXPECT_EQ(table.header(), kPinned);
  ASSERT_EQ(table.rows().size(), 5u);
  const CsvTable by_id = csv_of(cell, {"--feed-direction", "-45", "--posture", "home"});
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(table.text(table.rows()[i], 0), csv_number(7000.0 + 500.0 * static_cast<double>(i)));
    EXPECT_EQ(table.rows()[i].fields, by_id.rows()[i].fields);
  }
}

TEST(LobesCommand, SeveralDiagramsAreTheSingleOnesSideBySide) {
  const DemoCell cell;
  const CsvTable all = csv_of(cell, {"--posture", "home", "--posture", "10,-85,88,0,85,10", "--feed-direction", "0",
                                     "--feed-direction", "-30.5"});
  std::vector<std::string> header{"posture", "feed_direction_deg"};
  header.insert(header.end(), kPinned.begin(), kPinned.end());
  EXPECT_EQ(all.header(), header);
  ASSERT_EQ(all.rows().size(), 20u);
  std::size_t row = 0;
  for (const std::string posture : {"home", "10,-85,88,0,85,10"}) {
    for (const std::string direction : {"0", "-30.5"}) {
      const CsvTable single = csv_of(cell, {"--posture", posture, "--feed-direction", direction});
      for (const CsvRow& expected : single.rows()) {
        const std::vector<std::string>& fields = all.rows()[row++].fields;
        EXPECT_EQ(fields[0], posture);
        EXPECT_EQ(fields[1], direction);
        EXPECT_TRUE(std::equal(expected.fields.begin(), expected.fields.end(), fields.begin() + 2));
      }
    }
  }
}

TEST(LobesCommand, JsonHoldsOneDiagramOrAListOfThem) {
  const DemoCell cell;
  const json one = json::parse(run(lobes({"--json"}), cell.path()).out);
  for (const char* key : {"posture", "feed_direction_deg", "method", "mode_coupling", "modes", "points"}) {
    EXPECT_TRUE(one.contains(key)) << key;
  }
  EXPECT_TRUE(one["mode_coupling"].contains("depth_mm"));
  EXPECT_TRUE(one["mode_coupling"]["undamped"].contains("frequency_hz"));
  const json two = json::parse(run(lobes({"--json", "--posture", "home", "--posture", "far"}), cell.path()).out);
  ASSERT_EQ(two["diagrams"].size(), 2u);
  EXPECT_EQ(two["diagrams"][0], one);
  EXPECT_EQ(two["diagrams"][1]["posture"], "far");
}

TEST(LobesCommand, ConfidenceAddsTwoColumnsAroundTheLimit) {
  const DemoCell cell;
  const CsvTable plain = csv_of(cell, {"--method", "zoa"});
  const CsvTable sure = csv_of(cell, {"--method", "zoa", "--confidence", "0.95"});
  const CsvTable material = csv_of(
      cell, {"--method", "zoa", "--confidence", "0.95", "--tolerance", "frequency=0,damping=0,stiffness=0,ktc=0.1"});
  std::vector<std::string> header = kPinned;
  header.insert(header.end(), {"a_low_mm", "a_high_mm"});
  EXPECT_EQ(sure.header(), header);
  for (std::size_t i = 0; i < plain.rows().size(); ++i) {
    const CsvRow& row = sure.rows()[i];
    EXPECT_EQ(row.fields[1], plain.rows()[i].fields[1]);
    EXPECT_LT(sure.number(row, 3), sure.number(row, 1));
    EXPECT_GT(sure.number(row, 4), sure.number(row, 1));
    const double factor = std::exp(-1.6448536269514722 * std::sqrt(std::log(1.01)));
    const double limit = plain.number(plain.rows()[i], 1);
    EXPECT_NEAR(material.number(material.rows()[i], 3), limit * factor, 5e-3 * limit);
  }
}

TEST(LobesCommand, TakesTheToleranceFromTheMapUnlessItIsStated) {
  const DemoCell cell;
  const auto tolerance = [&](std::initializer_list<std::string> more) {
    std::vector<std::string> words = lobes({"--json", "--method", "zoa", "--confidence", "0.9"});
    words.insert(words.end(), more);
    const Finished done = run(words, cell.path());
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return json::parse(done.out)["tolerance"];
  };
  const json of_map = tolerance({});
  EXPECT_EQ(of_map["from_map"], true);
  EXPECT_EQ(of_map["ktc"], 0.1);
  const json report = json::parse(run({"stillcut", "map", "cell.toml", "--json"}, cell.path()).out);
  EXPECT_NEAR(of_map["frequency"].get<double>(), report["summary"]["modal"]["frequency_error"]["rms"].get<double>(),
              1e-12);
  const json stated = tolerance({"--tolerance", "damping=0.25,ktc=0"});
  EXPECT_EQ(stated["damping"], 0.25);
  EXPECT_EQ(stated["ktc"], 0.0);
  EXPECT_EQ(stated["frequency"], of_map["frequency"]);
}

TEST(LobesCommand, FitsFewModesOnlyWhereFrfSuperposesMoreThanItTakesAndSaysSo) {
  const DemoCell cell;
  cell.change("interpolation = \"modal\"", "interpolation = \"frf\"");
  const auto command = lobes({"--json", "--posture", "10,-85,88,0,85,10"});
  const auto exact = json::parse(run(command, cell.path()).out);
  EXPECT_EQ(exact["modes"].size(), 30U);
  EXPECT_TRUE(exact["modes_fitted_from"].is_null());
  // Ten more postures beside those measured, with the same modes each: 90 superposed ones.
  std::string postures = content_of(cell.path() / "map/postures.csv"),
              modes = content_of(cell.path() / "map/modes.csv");
  const CsvTable home = parse_csv(modes, "modes.csv");
  for (int i = 1; i <= 10; ++i) {
    const std::string id = "p" + std::to_string(i);
    postures += id + "," + std::to_string(2 * i) + ",-90,90,0,90,0,0,0,0\n";
    for (const CsvRow& row : home.rows()) {
      if (row.fields[0] != "home") continue;
      modes += id;
      for (std::size_t field = 1; field < row.fields.size(); ++field) modes += "," + row.fields[field];
      modes += "\n";
    }
  }
  (void)cell.write("map/postures.csv", postures);
  (void)cell.write("map/modes.csv", modes);
  const Finished done = run(command, cell.path());
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr("superposes 90 modes; the lobes use 12 fitted ones"));
  EXPECT_EQ(json::parse(done.out)["modes"].size(), 12U);
  EXPECT_EQ(json::parse(done.out)["modes_fitted_from"], 90);
}

TEST(LobesCommand, DrawsEverythingAtOnce) {
  const DemoCell cell;
  (void)cell.write("cuts.csv",
                   "spindle_speed_rpm,axial_depth_mm,verdict\n7000,1,stable\n8000,3.7,marginal\n8500,5,chatter\n");
  for (const char* picture : {"lobes.svg", "lobes.png"}) {
    const Finished done = run(lobes({"--plot", picture, "--cuts", "cuts.csv", "--posture", "home", "--posture", "far",
                                     "--confidence", "0.9", "--samples", "10", "--method", "zoa"}),
                              cell.path());
    EXPECT_EQ(done.exit_code, 0) << done.err;
    EXPECT_THAT(done.out, HasSubstr("mode coupling"));
    EXPECT_GT(std::filesystem::file_size(cell.path() / picture), 5000u);
  }
}

TEST(LobesCommand, RefusesWhatItCannotDo) {
  const DemoCell cell;
  const std::string header = "spindle_speed_rpm,axial_depth_mm,verdict\n";
  const auto refused = [&](std::initializer_list<std::string> more, int code, const std::string& names) {
    const Finished done = run(lobes(more), cell.path());
    EXPECT_EQ(done.exit_code, code) << done.err;
    EXPECT_EQ(done.out, "");
    EXPECT_THAT(done.err, HasSubstr(names));
    EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
  };
  const auto refused_cuts = [&](const std::string& text, const std::string& names) {
    (void)cell.write("cuts.csv", text);
    refused({"--plot", "p.svg", "--cuts", "cuts.csv"}, 3, names);
  };
  refused_cuts(header + "8500,1,good\n",
               "cuts.csv:2: verdict: \"good\" is no verdict; write stable, marginal or chatter");
  refused_cuts(header + "8500,1,\n", "cuts.csv:2: verdict: ");
  refused_cuts(header + "0,1,stable\n", "cuts.csv:2: spindle_speed_rpm: ");
  refused_cuts("spindle_speed_rpm,axial_depth_mm\n8500,1\n", "cuts.csv:1: verdict: ");
  refused_cuts("spindle_speed_rpm,axial_depth_mm,verdikt\n8500,1,stable\n", "did you mean verdict");
  refused_cuts(header, "cuts.csv:1: ");
  refused({"--cuts", "cuts.csv"}, 2, "--plot");
  refused({"--posture", "away"}, 3, "cell.toml: --posture: posture \"away\"");
  refused({"--posture", "home", "far"}, 2, "far");
  refused({"--confidence", "0.4"}, 2, "--confidence");
  refused({"--confidence", "1"}, 2, "--confidence");
  refused({"--confidence", "0.95", "--samples", "5"}, 2, "--samples");
  refused({"--tolerance", "ktc=0.1"}, 2, "--confidence");
  refused({"--confidence", "0.9", "--tolerance", "mass=0.1"}, 2, "mass=0.1");
  refused({"--confidence", "0.9", "--tolerance", "ktc"}, 2, "'ktc'");
  refused({"--confidence", "0.9", "--tolerance", "ktc=1.5"}, 2, "ktc=1.5");
  cell.change("teeth = 2", "teeth = 2\npitch_deg = [170.0, 190.0]");
  const Finished uneven = run(lobes({}), cell.path());  // is no longer refused: teeth of unequal pitch have lobes
  EXPECT_EQ(uneven.exit_code, 0) << uneven.err;
  EXPECT_THAT(uneven.out, HasSubstr("9000,"));
  std::vector<std::string> many = lobes({"--plot", "p.svg"});
  for (int i = 0; i < 9; ++i) many.insert(many.end(), {"--feed-direction", std::to_string(10 * i)});
  EXPECT_EQ(run(many, cell.path()).exit_code, 2);
}

}  // namespace
}  // namespace stillcut
