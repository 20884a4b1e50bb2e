// `stillcut surface` as a user meets it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "drivers/files/height_map_file.hpp"
#include "tests/tools/surface_cell.hpp"
#include "tools/surface_study.hpp"

namespace stillcut {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using Json = nlohmann::json;

const std::vector<std::string> kRoughnessKeys{"ra_um", "rq_um", "rt_um", "rz_um", "rsk", "rku",
                                              "sa_um", "sq_um", "sz_um", "ssk",   "sku"};

Json answered(const Finished& done) {
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(done.err, "");
  return Json::parse(done.out);
}

// Of arcs of 4 mm, `width_mm` apart.
double arc_ra_um(double width_mm) { return 1e3 * 4.0 / (9.0 * std::sqrt(3.0)) * width_mm * width_mm / (8.0 * 4.0); }

// Breaks with another profile direction, unit or axis, and where --grid counts points.
TEST(SurfaceCommand, WithoutVibrationLeavesTheArcsOfTheBall) {
  const SurfaceCell cell;
  cell.make_simple();
  const Json across =
      answered(cell.surface({"--no-vibration", "--size", "0.2x1.6", "--grid", "20x160", "--json", "--csv", "map.csv"}));
  EXPECT_NEAR(across["ra_um"].get<double>(), arc_ra_um(0.4), 0.01 * arc_ra_um(0.4));
  EXPECT_NEAR(across["texture_interval_across_mm"].get<double>(), 0.4, 0.01);
  EXPECT_EQ(across["grid"], Json({20, 160}));
  EXPECT_NEAR(across["spacing_um"][0].get<double>(), 10.0, 1e-9);
  EXPECT_EQ(read_height_map(cell.path() / "map.csv").along, 21u);
  const Json along =
      answered(cell.surface({"--no-vibration", "--size", "2x0.4", "--grid", "800x40", "--profile", "along", "--json"}));
  // Close to the ridges the marks of two passes shorten each other.
  EXPECT_NEAR(along["ra_um"].get<double>(), arc_ra_um(0.1), 0.03 * arc_ra_um(0.1));
  EXPECT_NEAR(along["texture_interval_along_mm"].get<double>(), 0.1, 0.001);
  EXPECT_GT(along["sa_um"].get<double>(), 5.0 * along["ra_um"].get<double>());  // whatever the profiles' direction
}

// Breaks with a pinned key renamed or missing.
TEST(SurfaceCommand, JsonHoldsBothSurfacesAndTheVibration) {
  const SurfaceCell cell;
  cell.make_quick();
  const Json json = answered(cell.surface({"--size", "0.8x0.4", "--json"}));
  for (const std::string& key : kRoughnessKeys) {
    EXPECT_TRUE(std::isfinite(json[key].get<double>())) << key;
    EXPECT_TRUE(std::isfinite(json["without_vibration"][key].get<double>())) << key;
  }
  EXPECT_NEAR(json["without_vibration"]["texture_interval_along_mm"].get<double>(), 0.2, 0.02);
  EXPECT_LE(json["ra_grid_error_percent"].get<double>(), 1.0);
  EXPECT_EQ(json["vibration"]["posture"], "A");
  EXPECT_EQ(json["vibration"]["modes"], 2);
  for (const char* axis : {"x", "y", "z"}) {
    const double rms = json["vibration"]["rms_um"][axis], peak = json["vibration"]["peak_um"][axis];
    EXPECT_GT(rms, 0.0) << axis;
    EXPECT_GE(peak, rms) << axis;
  }
  EXPECT_NE(json["ra_um"], json["without_vibration"]["ra_um"]);
  EXPECT_EQ(json["warnings"], Json::array());
  EXPECT_FALSE(json.contains("measured"));
  const Json still = answered(cell.surface({"--size", "0.8x0.4", "--no-vibration", "--json"}));
  EXPECT_TRUE(still["vibration"].is_null());
  EXPECT_TRUE(still["without_vibration"].is_null());
  const double sa = json["without_vibration"]["sa_um"];
  EXPECT_NEAR(still["sa_um"].get<double>(), sa, 0.05 * sa);  // with the phases of other passes
}

// Breaks where the result hangs on the order of the threads' work, or on anything but the question.
TEST(SurfaceCommand, SaysTheSameHoweverOftenAndByHoweverManyThreads) {
  const SurfaceCell cell;
  cell.make_quick();
  const auto asked = [&](const std::string& jobs, const std::string& file) {
    const Finished done = cell.surface({"--size", "2.8x0.4", "--grid", "280x40", "--jobs", jobs, "--json", "--csv",
                                        file + ".csv", "--sdf", file + ".sdf", "--stl", file + ".stl", "--plot",
                                        file + ".svg", "--relief", file + "-relief.svg"});
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return done.out;
  };
  EXPECT_EQ(asked("1", "one"), asked("2", "two"));
  for (const char* ending : {".csv", ".sdf", ".stl", ".svg", "-relief.svg"}) {
    const std::string one = content_of(cell.path() / ("one" + std::string(ending)));
    EXPECT_GT(one.size(), 1000u) << ending;
    EXPECT_TRUE(one == content_of(cell.path() / ("two" + std::string(ending)))) << ending;
  }
  const Finished other = cell.surface({"--size", "2.8x0.4", "--grid", "280x40", "--json", "--seed", "2"});
  EXPECT_NE(answered(other)["ra_um"], Json::parse(asked("2", "two"))["ra_um"]);
}

// Breaks where figures are of another map than the one that is written, and where a measured map is treated otherwise
// than the predicted one.
TEST(SurfaceCommand, ReadsItsOwnMapsAsMeasuredOnes) {
  const SurfaceCell cell;
  const auto asked = [&](std::initializer_list<std::string> more) {
    std::vector<std::string> arguments{"stillcut", "surface", "cell.toml", "--no-vibration", "--size",
                                       "0.4x0.3",  "--grid",  "80x60",     "--form",         "quadratic",
                                       "--cutoff", "0.2",     "--json"};
    arguments.insert(arguments.end(), more);
    return answered(run(arguments, cell.path()));
  };
  for (const std::string file : {"map.csv", "map.sdf"}) {
    const Json first = asked({file == "map.csv" ? "--csv" : "--sdf", file});
    const HeightMap map = read_height_map(cell.path() / file);
    const SurfaceFigures figures = surface_figures(map, ProfileDirection::across, {SurfaceForm::quadratic, 0.2e-3});
    EXPECT_NEAR(1e6 * figures.profiles.mean.ra, first["ra_um"].get<double>(), 1e-12);
    EXPECT_NEAR(1e6 * figures.area.sq, first["sq_um"].get<double>(), 1e-12);
    const Json compared = asked({"--compare", file, "--plot", "both.svg"});
    for (const std::string& key : kRoughnessKeys) {
      EXPECT_NEAR(compared["difference"][key].get<double>(), 0.0, 1e-12) << file << ' ' << key;
      EXPECT_NEAR(compared["measured"][key].get<double>(), first[key].get<double>(), 1e-12) << file << ' ' << key;
    }
  }
  EXPECT_THAT(content_of(cell.path() / "both.svg"), HasSubstr("<svg"));
}

TEST(SurfaceCommand, ResamplesWhatItTells) {
  const SurfaceCell cell;
  const Json json = answered(cell.surface({"--no-vibration", "--size", "0.4x0.3", "--grid", "100x60", "--resample",
                                           "40x30", "--csv", "map.csv", "--json"}));
  EXPECT_EQ(json["resampled"], Json({40, 30}));
  EXPECT_EQ(json["grid"], Json({100, 60}));
  const HeightMap map = read_height_map(cell.path() / "map.csv");
  EXPECT_EQ(map.along, 40u);
  EXPECT_EQ(map.across, 30u);
  EXPECT_NEAR(1e6 * areal_roughness(map).sa, json["sa_um"].get<double>(), 1e-12);
}

TEST(SurfaceCommand, TellsPeopleBothSurfacesSideBySide) {
  const SurfaceCell cell;
  cell.make_quick();
  const Finished done = cell.surface({"--size", "0.4x0.4", "--grid", "40x40", "--posture", "B"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, StartsWith("0.4 x 0.4 mm of AL7075-T6 by a 8 mm ball end, 2 teeth, 6000 rpm; feed 0.1 mm a "
                                   "tooth, step-over 0.2 mm, tilt 5°, lead 10°\ngrid of 40 x 40 cells, 10 µm;"));
  for (const char* text : {"vibrating       still\n", "R_a across, µm ", "S_sk ", "vibration at posture B, 2 modes"})
    EXPECT_THAT(done.out, HasSubstr(text));
  EXPECT_EQ(done.out.find('\t'), std::string::npos);
  const Finished table = cell.surface({"--size", "0.4x0.4", "--grid", "40x40", "--no-vibration", "--csv", "-"});
  EXPECT_THAT(table.out, StartsWith("x_mm,y_mm,z_mm\n0,0,"));
  EXPECT_EQ(std::count(table.out.begin(), table.out.end(), '\n'), 1 + 41 * 41);
}

// A map of one's own is extrapolated with a word.
TEST(SurfaceCommand, WarnsOutsideTheMap) {
  const SurfaceCell cell;
  cell.make_quick();
  const Finished done = cell.surface({"--size", "0.2x0.2", "--grid", "20x20", "--posture", "900,400,0", "--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.err, StartsWith("stillcut: cell.toml: "));
  EXPECT_THAT(done.err, HasSubstr("the vibration is an extrapolation\n"));
  EXPECT_EQ(Json::parse(done.out)["warnings"].size(), 1u);
}

// Rows 0.4 mm apart over a plane that rises by a tenth: scallops of the ball, less the slope. Breaks with a path that
// is read in other units, a rectangle elsewhere, or a form that stays.
TEST(SurfaceCommand, AToolPathLeavesTheScallopsOfItsRows) {
  const SurfaceCell cell;
  cell.make_simple();
  std::string path = "UNITS/MM\nSPINDL/RPM,6000,CLW\nFEDRAT/MMPM,1200\n";
  for (int row = 0; row < 9; ++row) {
    const std::string y = std::to_string(0.4 * row);
    path += "RAPID\nGOTO/-5," + y + ",5\nGOTO/-5," + y + ",-0.5,0.3,0,0.95\n";
    path += "GOTO/9," + y + ",0.9,0.3,0,0.95\nRAPID\nGOTO/9," + y + ",5\n";
  }
  (void)cell.write("rows.cls", path);
  const Json json = answered(
      cell.surface({"--path", "rows.cls", "--size", "0.3x1.6", "--grid", "60x160", "--corner", "1x0.8", "--json"}));
  EXPECT_NEAR(json["ra_um"].get<double>(), arc_ra_um(0.4), 0.03 * arc_ra_um(0.4));
  EXPECT_EQ(json["path"]["file"], "rows.cls");
  EXPECT_EQ(json["form"], "quadratic");
  EXPECT_TRUE(json["vibration"].is_null());
  const Json teeth = answered(cell.surface({"--path", "rows.cls", "--size", "0.3x1.6", "--grid", "60x160", "--corner",
                                            "1x0.8", "--form", "envelope", "--json"}));
  EXPECT_LT(teeth["ra_um"].get<double>(), 0.3 * json["ra_um"].get<double>());
}

}  // namespace
}  // namespace stillcut
