// stillcut map, as a user runs it.
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

using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::vector<std::string> kMap{"stillcut", "map", "cell.toml"};

Finished map(const DemoCell& cell, std::initializer_list<std::string> more = {}) {
  std::vector<std::string> arguments = kMap;
  arguments.insert(arguments.end(), more);
  return run(arguments, cell.path());
}

TEST(MapCommand, TableNamesEveryPostureAndSaysWhatToUse) {
  const DemoCell cell;
  const Finished done = map(cell);
  ASSERT_EQ(done.exit_code, 0) << done.err;
  for (const char* word : {"home ", "left ", "right ", "far ", "near ", "mean", "frf", "modal", "trend", "worst", "rms",
                           "Use interpolation = \"", " deg", " Hz", " um/N"})
    EXPECT_THAT(done.out, HasSubstr(word));
  EXPECT_EQ(done.err, "");
}

TEST(MapCommand, CsvHasARowForEachPostureWayAndMode) {
  const DemoCell cell;
  const Finished done = map(cell, {"--csv", "-"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const CsvTable table = parse_csv(done.out, "csv");
  EXPECT_EQ(table.rows().size(), 5U * 4U * 6U);
  const auto column = [&](const char* name) { return table.require_column(name); };
  for (const CsvRow& row : table.rows()) {
    EXPECT_GT(table.number(row, column("nearest_distance_deg")), 1.0);
    EXPECT_EQ(table.text(row, column("nearest_distance_mm")), "");
    if (table.text(row, column("predicted_frequency_hz")).empty()) continue;
    const double measured = table.number(row, column("measured_frequency_hz"));
    const double predicted = table.number(row, column("predicted_frequency_hz"));
    EXPECT_NEAR(table.number(row, column("frequency_error")), predicted / measured - 1.0, 1e-12);
  }
}

TEST(MapCommand, JsonIsOneObjectThatAgreesWithItsSummary) {
  const DemoCell cell;
  const Finished done = map(cell, {"--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const auto json = nlohmann::json::parse(done.out);
  ASSERT_EQ(json["postures"].size(), 5U);
  EXPECT_THAT(json["recommended"].get<std::string>(), ::testing::AnyOf("modal", "frf", "trend"));
  double worst = 0.0;
  for (const auto& posture : json["postures"]) {
    EXPECT_TRUE(posture["outside_map"].is_boolean());
    EXPECT_TRUE(posture["nearest_distance_deg"].is_number());
    for (const auto& mode : posture["modal"]["modes"])
      worst = std::max(worst, std::abs(mode["frequency_error"].get<double>()));
  }
  EXPECT_NEAR(json["summary"]["modal"]["frequency_error"]["worst"].get<double>(), worst, 1e-15);
}

TEST(MapCommand, DrawsTheSamePictureEveryTime) {
  const DemoCell cell;
  ASSERT_EQ(map(cell, {"--plot", "a.svg"}).exit_code, 0);
  ASSERT_EQ(map(cell, {"--plot", "b.svg", "--json"}).exit_code, 0);
  EXPECT_GT(content_of(cell.path() / "a.svg").size(), 5000U);
  EXPECT_EQ(content_of(cell.path() / "a.svg"), content_of(cell.path() / "b.svg"));
  ASSERT_EQ(map(cell, {"--posture", "10,-85,88,0,85,10", "--plot", "c.png"}).exit_code, 0);
  EXPECT_GT(content_of(cell.path() / "c.png").size(), 5000U);
}

TEST(MapCommand, PostureGivesItsModesAndDistance) {
  const DemoCell cell;
  const Finished inside = map(cell, {"--posture", "10,-85,88,0,85,10"});
  ASSERT_EQ(inside.exit_code, 0) << inside.err;
  EXPECT_THAT(inside.out, HasSubstr("nearest measured posture home, 15.9 deg away; inside the map"));
  EXPECT_EQ(inside.err, "");
  const Finished measured = map(cell, {"--posture", "left", "--csv", "-"});
  EXPECT_THAT(measured.out, StartsWith("mode,frequency_hz,damping_ratio,stiffness_n_per_m,ux,uy,uz\n"));
  const CsvTable table = parse_csv(measured.out, "csv");
  ASSERT_EQ(table.rows().size(), 6U);
  EXPECT_NEAR(table.number(table.rows()[0], 1), 13.4, 1e-12);
  EXPECT_NEAR(table.number(table.rows()[5], 3), 8.57e6, 1e-3);
}

TEST(MapCommand, PostureFarOutsideIsFlaggedWithItsDistance) {
  const DemoCell cell;
  const Finished done = map(cell, {"--posture", "110,-85,88,0,85,10", "--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.err, StartsWith("stillcut: cell.toml: posture \"110,-85,88,0,85,10\" lies outside the map: "));
  EXPECT_THAT(done.err, HasSubstr("86.7 deg"));
  const auto json = nlohmann::json::parse(done.out);
  EXPECT_TRUE(json["outside_map"]);
  EXPECT_NEAR(json["nearest_distance_deg"].get<double>(), 86.7, 0.05);
}

TEST(MapCommand, FrfIsShownByItsRefitWithTheError) {
  const DemoCell cell;
  const Finished done = map(cell, {"--posture", "10,-85,88,0,85,10", "--interpolation", "frf", "--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const auto json = nlohmann::json::parse(done.out);
  EXPECT_EQ(json["modes"].size(), 30U);
  EXPECT_LE(json["refit"]["modes"].size(), 12U);
  EXPECT_GT(json["refit"]["error_rms"].get<double>(), 0.0);
}

TEST(MapCommand, HexapodDistancesAreInMm) {
  const DemoCell cell;
  (void)cell.write("map/postures.csv", "posture,x_mm,y_mm,z_mm\na,0,0,0\nb,100,0,0\n");
  (void)cell.write("map/modes.csv",
                   "posture,mode,frequency_hz,damping_ratio,stiffness_n_per_m,ux,uy,uz\n"
                   "a,1,20,0.03,2e6,1,0,0\nb,1,22,0.03,2e6,1,0,0\n");
  EXPECT_THAT(map(cell).out, HasSubstr("100 mm"));
  const Finished done = map(cell, {"--posture", "30,0,0"});
  EXPECT_THAT(done.out, HasSubstr("nearest measured posture a, 30 mm away; inside the map"));
}

struct MapRefusal {
  std::vector<std::string> arguments;
  int exit_code;
  std::string names;
};

TEST(MapCommand, RefusesWithOneLine) {
  const DemoCell cell;
  const DemoCell one;
  (void)one.write("map/postures.csv", "posture,x_mm,y_mm,z_mm\na,0,0,0\n");
  (void)one.write("map/modes.csv",
                  "posture,mode,frequency_hz,damping_ratio,stiffness_n_per_m,ux,uy,uz\na,1,20,0.03,2e6,1,0,0\n");
  EXPECT_EQ(map(one, {"--posture", "a"}).exit_code, 0);
  const Finished alone = map(one);
  EXPECT_EQ(alone.exit_code, 3);
  EXPECT_THAT(alone.err, HasSubstr("two postures"));
  const MapRefusal refusals[] = {{{"--posture", "nowhere"}, 3, "nowhere"},
                                 {{"--csv", "none/x.csv"}, 3, "none/x.csv"},
                                 {{"--plot", "x.pdf"}, 3, "x.pdf"},
                                 {{"--json", "--csv", "-"}, 2, "--csv -"},
                                 {{"--interpolation", "frf"}, 2, "--posture"},
                                 {{"--posture", "home", "--interpolation", "best"}, 2, "best"},
                                 {{"--nonsense"}, 2, "--nonsense"}};
  for (const MapRefusal& refusal : refusals) {
    std::vector<std::string> arguments = kMap;
    arguments.insert(arguments.end(), refusal.arguments.begin(), refusal.arguments.end());
    const Finished done = run(arguments, cell.path());
    EXPECT_EQ(done.exit_code, refusal.exit_code) << done.err;
    EXPECT_THAT(done.err, StartsWith("stillcut: "));
    EXPECT_THAT(done.err, HasSubstr(refusal.names));
    EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
    EXPECT_EQ(done.out, "");
  }
}

TEST(MapCommand, HelpHasAnExample) {
  const DemoCell cell;
  const Finished done = map(cell, {"--help"});
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_THAT(done.out, HasSubstr("Example"));
}

TEST(LobesCommand, PostureFarOutsideIsWarnedOfWithItsDistance) {
  const DemoCell cell;
  const Finished done = run({"stillcut", "lobes", "cell.toml", "--posture", "110,-85,88,0,85,10", "--method", "zoa",
                             "--speed", "8000:9000:3"},
                            cell.path());
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr("86.7 deg from the nearest measured posture \"left\""));
}

}  // namespace
}  // namespace stillcut
