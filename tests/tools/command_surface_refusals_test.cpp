// What `stillcut surface` refuses, and how it says so.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/tools/surface_cell.hpp"

namespace stillcut {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

void expect_surface_refusal(const Finished& done, int code, const std::string& starts, const std::string& names) {
  EXPECT_EQ(done.exit_code, code) << done.err;
  EXPECT_EQ(done.out, "");
  EXPECT_THAT(done.err, StartsWith("stillcut: " + starts));
  EXPECT_THAT(done.err, HasSubstr(names));
  EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
}

struct BadSurfaceCell {
  const char* name;
  std::string from, to;
  const char *line_starts, *line_names;
};
void PrintTo(const BadSurfaceCell& bad, std::ostream* out) { *out << bad.name; }
class SurfaceRefuses : public ::testing::TestWithParam<BadSurfaceCell> {};

TEST_P(SurfaceRefuses, WithOneLineThatNamesTheKey) {
  const SurfaceCell cell;
  cell.change(GetParam().from, GetParam().to);
  expect_surface_refusal(cell.surface({"--json"}), 3, GetParam().line_starts, GetParam().line_names);
}

INSTANTIATE_TEST_SUITE_P(
    Cells, SurfaceRefuses,
    ::testing::Values(
        BadSurfaceCell{"contact_on_the_shank", "tilt_deg = 5.0", "tilt_deg = 85.0",
                       "cell.toml: cut.tilt_deg, cut.lead_deg: turn the contact by 85.",
                       "cuts the surface alone up to 8"},
        BadSurfaceCell{"ball_beside_the_surface", "lead_deg = 10.0", "lead_deg = -90.0",
                       "cell.toml: cut.tilt_deg, cut.lead_deg: ", "onto the shank"},
        BadSurfaceCell{"feed_beyond_the_ball", "feed_per_tooth_mm = 0.025", "feed_per_tooth_mm = 3",
                       "cell.toml: cut.feed_per_tooth_mm, cut.step_over_mm, tool.runout_mm: edges farther ",
                       "6 mm of feed a turn"},
        BadSurfaceCell{"tilt_in_no_range", "tilt_deg = 5.0", "tilt_deg = 91.0",
                       "cell.toml:28: cut.tilt_deg: ", "-90 to 90"},
        BadSurfaceCell{"negative_engagement", "radial_depth_mm = 0.1", "radial_depth_mm = -0.1",
                       "cell.toml:23: cut.radial_depth_mm: ", "above 0"},
        BadSurfaceCell{"negative_depth", "axial_depth_mm = 0.5", "axial_depth_mm = -0.5",
                       "cell.toml:24: cut.axial_depth_mm: ", "above 0"},
        BadSurfaceCell{"negative_feed", "feed_per_tooth_mm = 0.025", "feed_per_tooth_mm = -0.025",
                       "cell.toml:25: cut.feed_per_tooth_mm: ", "above 0"},
        BadSurfaceCell{"step_over_wider_than_the_tool", "tilt_deg = 5.0", "step_over_mm = 9",
                       "cell.toml: cut.step_over_mm: 9 mm must be", "less than the 8 mm"},
        BadSurfaceCell{"ridges_above_the_stock", "axial_depth_mm = 0.5", "axial_depth_mm = 0.0001",
                       "cell.toml: cut.radial_depth_mm: leaves ridges of 0.0003125 mm", "axial depth of 0.0001 mm"},
        BadSurfaceCell{"no_tool",
                       "[tool]\nshape = \"ball\"\ndiameter_mm = 8.0\nteeth = 2\nhelix_deg = 45.0\n"
                       "runout_mm = 0.02\naxial_runout_mm = 0.005\n",
                       "", "cell.toml: [tool] is missing", "add this section"},
        BadSurfaceCell{"no_such_posture", "posture = \"A\"", "posture = \"Z\"",
                       "cell.toml: dynamics.posture: ", "not in the map"}),
    [](const auto& test) { return std::string(test.param.name); });

// Breaks where the grid that would do is wrong: it is taken at the end.
TEST(SurfaceCommandRefuses, AGridTooCoarseWithOneThatWouldDo) {
  const SurfaceCell cell;
  const std::vector<std::string> first{"stillcut", "surface", "cell.toml", "--no-vibration",
                                       "--json",   "--size",  "0.203x0.1"};
  const auto with = [&](std::initializer_list<std::string> more) {
    std::vector<std::string> arguments = first;
    arguments.insert(arguments.end(), more);
    return run(arguments, cell.path());
  };
  const std::string advice = "use --grid 41x20 or finer, or --allow-coarse";
  expect_surface_refusal(with({"--grid", "40x20"}), 3,
                         "cell.toml: --grid: 0.005075 mm between points is too coarse for this feed and step-over, at "
                         "most 0.005 mm; ",
                         advice);
  expect_surface_refusal(with({"--grid", "100x10"}), 3, "cell.toml: --grid: 0.01 mm between points", advice);
  EXPECT_EQ(with({"--grid", "41x20"}).exit_code, 0);
  EXPECT_EQ(with({"--grid", "10x10", "--allow-coarse"}).exit_code, 0);
  expect_surface_refusal(with({"--grid", "50000x50000"}), 3, "cell.toml: --grid: 50000x50000 cells", "100 million");
  expect_surface_refusal(cell.surface({"--size", "9000x9000"}), 3, "cell.toml: --grid: ", "--size");
}

TEST(SurfaceCommandRefuses, OptionsThatCannotBe) {
  const SurfaceCell cell;
  (void)cell.write("bad.sdf", "aISO-1.0\n");
  (void)cell.write("flat.csv", "x_mm,y_mm,z_mm\n0,0,\n0,1,\n1,0,\n1,1,0\n");
  const auto usage = [&](std::initializer_list<std::string> more, const std::string& names) {
    expect_surface_refusal(cell.surface(more), 2, "--", names);
  };
  for (const std::string size : {"2", "2x", "0x2", "2x-1", "2xnan", "2x2x2", "1e9x1"})
    usage({"--size", size}, "'" + size + "' is not ALONGxACROSS the feed in mm");
  for (const std::string grid : {"500", "0x500", "1x5", "5.5x5", "99999999x5"})
    usage({"--grid", grid}, "'" + grid + "' is not ALONGxACROSS the feed in cells");
  usage({"--resample", "2x100"}, "in points");
  usage({"--profile", "aslant"}, "{across,along}");
  usage({"--form", "round"}, "{linear,quadratic,envelope}");
  usage({"--cutoff", "-1"}, "not in range 0.000001 to 10000");
  usage({"--json", "--csv", "-"}, "standard output");
  usage({"--json", "--sdf", "-"}, "standard output");
  usage({"--csv", "-", "--stl", "-"}, "standard output");
  const auto input = [&](std::initializer_list<std::string> more, const std::string& starts, const std::string& names) {
    expect_surface_refusal(cell.surface(more), 3, starts, names);
  };
  input({"--compare", "nowhere.csv"}, "nowhere.csv: ", "no such file");
  input({"--compare", "bad.sdf"}, "bad.sdf", "");
  input({"--compare", "flat.csv"}, "flat.csv: ", "known");
  input({"--compare", "map.x3p"}, "map.x3p: ", ".csv or .sdf");
  input({"--plot", "a.pdf"}, "a.pdf: ", ".svg or .png");
  input({"--relief", "a.pdf"}, "a.pdf: ", ".svg or .png");
  input({"--no-vibration", "--size", "0.1x0.1", "--cutoff", "1", "--json"}, "cell.toml: --cutoff: ", "not be longer");
  input({"--resample", "1000000x101"}, "cell.toml: --resample: 1000000x101 are more than 100 million", "ask for fewer");
  input({"--posture", "Z"}, "cell.toml: --posture: ", "not in the map");
  input({"--no-vibration", "--size", "0.1x0.1", "--sdf", "/nowhere/a.sdf", "--json"}, "/nowhere/a.sdf: ", "written");
}

TEST(SurfaceCommandRefuses, ACutThatIsFarFromStable) {
  const SurfaceCell cell;
  cell.make_quick();
  cell.change("axial_depth_mm = 0.1", "axial_depth_mm = 1.0");
  (void)cell.write("map/modes.csv",
                   "posture,mode,frequency_hz,damping_ratio,stiffness_n_per_m,ux,uy,uz\n"
                   "A,1,620,0.03,1.4e3,1,0,0\nA,2,840,0.03,1.6e3,0,1,0\n"
                   "B,1,620,0.03,1.4e3,1,0,0\nB,2,840,0.03,1.6e3,0,1,0\n"
                   "C,1,620,0.03,1.4e3,1,0,0\nC,2,840,0.03,1.6e3,0,1,0\n");
  expect_surface_refusal(cell.surface({"--size", "0.4x0.4", "--json"}), 3,
                         "cell.toml: the vibration cannot be simulated: ", "; --no-vibration leaves it out");
}

// Breaks where memory is asked for that the machine may not have: the stock is as fine as the feed.
TEST(SurfaceCommandRefuses, AStockThatDoesNotFitIntoMemory) {
  const SurfaceCell cell;
  cell.change("feed_per_tooth_mm = 0.025", "feed_per_tooth_mm = 0.0001");
  expect_surface_refusal(cell.surface({"--size", "0.01x0.01", "--grid", "20x20", "--allow-coarse"}), 3,
                         "cell.toml: the vibration cannot be simulated: the stock around the passes would have more",
                         "; --no-vibration leaves it out");
}

// Without vibration the cell need know nothing of the machine; with it, it must.
TEST(SurfaceCommandRefuses, AsksForTheMapOnlyWhereTheToolVibrates) {
  const SurfaceCell cell;
  std::filesystem::remove_all(cell.path() / "map");
  EXPECT_EQ(cell.surface({"--no-vibration", "--size", "0.1x0.1", "--grid", "20x20"}).exit_code, 0);
  expect_surface_refusal(cell.surface({"--size", "0.1x0.1"}), 3, "cell.toml:", "map");
  EXPECT_THAT(cell.surface({"--help"}).out, HasSubstr("Examples: "));
}

TEST(SurfaceRefusesPaths, WithTheFileAndTheLine) {
  const SurfaceCell cell;
  (void)cell.write("unknown.cls", "FEDRAT/MMPM,500\nGOTO/0,0,0\nWARP/9\nGOTO/5,0,0\n");
  expect_surface_refusal(cell.surface({"--path", "unknown.cls", "--json"}), 3, "unknown.cls:3: ", "WARP");
  (void)cell.write("short.cls", "FEDRAT/MMPM,500\nSPINDL/RPM,6000,CLW\nGOTO/0,0,0\nGOTO/5,0,0\n");
  expect_surface_refusal(cell.surface({"--path", "short.cls", "--corner", "90x90", "--json"}), 3,
                         "short.cls: ", "does not come to the rectangle");
  expect_surface_refusal(cell.surface({"--corner", "1x1"}), 2, "--path: ", "tool path");
  expect_surface_refusal(cell.surface({"--form", "envelope"}), 2, "--path: ", "tool path");
}

}  // namespace
}  // namespace stillcut
