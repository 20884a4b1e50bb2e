#include "drivers/files/cell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/drivers/files/example_cell.hpp"

namespace stillcut {
namespace {

using std::numbers::pi;

// Values after conversion are compared to one part in 10^14: the factor may round once.
void expect_close(double value, double expected) { EXPECT_NEAR(value, expected, 1e-14 * std::abs(expected)); }

Cell read(const std::string& text, const CellNeeds& needs = {}) {
  const TempFolder folder;
  return read_cell(write_example_cell(folder, text), needs);
}

TEST(Cell, ReadsToolMaterialAndCutOfTheExampleInSiUnits) {
  const Cell cell = read(kExampleCell);
  ASSERT_TRUE(cell.tool && cell.material && cell.cut);
  EXPECT_EQ(cell.tool->shape, ToolShape::end);
  expect_close(cell.tool->diameter, 0.025);
  EXPECT_EQ(cell.tool->teeth, 2);
  ASSERT_EQ(cell.tool->pitch.size(), 2U);
  for (const double pitch : cell.tool->pitch) expect_close(pitch, pi);
  EXPECT_EQ(cell.tool->helix, 0.0);
  EXPECT_EQ(cell.tool->runout, 0.0);
  EXPECT_EQ(cell.tool->runout_angle, 0.0);
  EXPECT_EQ(cell.tool->axial_runout, 0.0);

  EXPECT_EQ(cell.material->name, "AL7075-T6");
  expect_close(cell.material->ktc, 800e6);
  expect_close(cell.material->krc, 300e6);
  for (const double zero : {cell.material->kac, cell.material->kte, cell.material->kre, cell.material->kae,
                            cell.material->process_damping}) {
    EXPECT_EQ(zero, 0.0);
  }

  EXPECT_EQ(cell.cut->milling, Milling::down);
  expect_close(cell.cut->radial_depth, 0.0125);
  expect_close(cell.cut->axial_depth, 0.15e-3);
  expect_close(cell.cut->feed_per_tooth, 0.05e-3);
  expect_close(cell.cut->spindle_speed, 3330.0 / 60.0 * 2.0 * pi);
  for (const double zero :
       {cell.cut->feed_direction, cell.cut->tilt, cell.cut->lead, cell.cut->redundancy, cell.cut->step_over}) {
    EXPECT_EQ(zero, 0.0);
  }
  EXPECT_EQ(cell.cut->path, PathKind::unidirectional);
}

TEST(Cell, ReadsRegionSpindleAndDynamicsOfTheExampleInSiUnits) {
  const TempFolder folder;
  const Cell cell = read_cell(write_example_cell(folder));
  ASSERT_TRUE(cell.region && cell.spindle && cell.dynamics);
  ASSERT_EQ(cell.region->polygon.size(), 4U);
  expect_close(cell.region->polygon[2][0], 0.3);
  expect_close(cell.region->polygon[2][1], 0.3);
  EXPECT_EQ(cell.region->polygon[3][0], 0.0);
  EXPECT_TRUE(cell.region->islands.empty());

  expect_close(cell.spindle->min_speed, 2800.0 * pi / 30.0);
  expect_close(cell.spindle->max_speed, 3800.0 * pi / 30.0);
  expect_close(cell.spindle->acceleration, 2000.0 * pi / 30.0);
  expect_close(cell.spindle->jerk, 20000.0 * pi / 30.0);

  EXPECT_EQ(cell.dynamics->map, folder.path() / "map");
  EXPECT_EQ(cell.dynamics->interpolation, InterpolationKind::modal);
  EXPECT_EQ(cell.dynamics->power, 1.0);
  EXPECT_EQ(cell.dynamics->posture, "12");
}

TEST(Cell, ReadsCanLcmAndRuntimeOfTheExample) {
  const TempFolder folder;
  const auto file = write_example_cell(folder);
  const Cell cell = read_cell(file);
  EXPECT_EQ(cell.file, file);
  ASSERT_TRUE(cell.can);
  EXPECT_EQ(cell.can->bus, "socketcan:can0");
  EXPECT_EQ(cell.can->dbc, folder.path() / "cell.dbc");
  EXPECT_EQ(cell.can->line, line_of(kExampleCell, "[can]"));
  EXPECT_EQ(cell.can->spindle_speed, "Spindle.Speed");
  ASSERT_EQ(cell.can->accelerometers.size(), 1U);
  const AccelerometerSettings& sensor = cell.can->accelerometers.front();
  EXPECT_EQ(sensor.line, line_of(kExampleCell, "[[can.accelerometer]]"));
  EXPECT_EQ(sensor.sample_rate_hz, 25600.0);
  EXPECT_EQ(sensor.axis, (std::array<std::string, 3>{"Vibration.X{0..9}", "Vibration.Y{0..9}", "Vibration.Z{0..9}"}));
  EXPECT_EQ(sensor.counter, "Vibration.Counter");
  EXPECT_EQ(sensor.unit_m_per_s2, 1.0);
  EXPECT_EQ(sensor.rotation, (std::array<double, 3>{0.0, 0.0, 0.0}));
  EXPECT_EQ(cell.lcm_url, "udpm://239.255.76.67:7667?ttl=0");
  EXPECT_EQ(cell.mode, RuntimeMode::shadow);
}

TEST(Cell, LeavesWhatMonitorDoesNotSayToTheMonitor) {
  EXPECT_FALSE(read(kExampleCell).detection.limit.has_value());
  EXPECT_FALSE(read(kExampleCell).detection.release_ratio.has_value());
  const Cell limit_only = read("[monitor]\nlimit = 4\n");
  EXPECT_EQ(limit_only.detection.limit, 4.0);
  EXPECT_FALSE(limit_only.detection.release_ratio.has_value());
  const Cell both = read("[monitor]\nlimit = 23.5\nrelease_ratio = 0.9\n");
  EXPECT_EQ(both.detection.limit, 23.5);
  EXPECT_EQ(both.detection.release_ratio, 0.9);
}

TEST(Cell, ReadsEveryOptionalKeyInSiUnits) {
  const Cell cell = read(R"(
[tool]
shape = "ball"
diameter_mm = 10
teeth = 3
pitch_deg = [118, 121.5, 120.5]
helix_deg = 30
runout_mm = 0.02
runout_angle_deg = 90
axial_runout_mm = -0.01
[material]
name = "steel"
ktc_mpa = 2000
krc_mpa = 900
kac_mpa = 200
kte_n_per_mm = 20
kre_n_per_mm = 30
kae_n_per_mm = 4
process_damping_n_per_m = 5e5
[cut]
milling = "up"
radial_depth_mm = 10
axial_depth_mm = 1
feed_per_tooth_mm = 0.1
spindle_speed_rpm = 600
feed_direction_deg = -45
tilt_deg = 15
lead_deg = -30
redundancy_deg = 180
step_over_mm = 0.5
path = "zigzag"
[region]
polygon_mm = [[0, 0], [10, 0], [0, 10]]
islands_mm = [[[1, 1], [2, 1], [1, 2]], [[4, 4], [5, 4], [4, 5]]]
[dynamics]
map = "map"
interpolation = "frf"
power = 2
posture = [0, -90, 90.5, 0, 0, 15]
[can]
bus = "local:cell-1"
dbc = "cell.dbc"
[[can.accelerometer]]
sample_rate_hz = 6400.5
y = "A.Ay"
unit = "g"
rotation_deg = [0, 90, -180]
[[can.accelerometer]]
sample_rate_hz = 1000
x = "B.S{15..0}_x"
unit = "m/s^2"
[lcm]
url = "memq://"
[runtime]
mode = "active"
)");
  EXPECT_EQ(cell.tool->shape, ToolShape::ball);
  ASSERT_EQ(cell.tool->pitch.size(), 3U);
  expect_close(cell.tool->pitch[1], 121.5 / 180.0 * pi);
  expect_close(cell.tool->helix, pi / 6.0);
  expect_close(cell.tool->runout, 20e-6);
  expect_close(cell.tool->runout_angle, pi / 2.0);
  expect_close(cell.tool->axial_runout, -10e-6);
  expect_close(cell.material->kac, 200e6);
  expect_close(cell.material->kte, 20e3);
  expect_close(cell.material->kre, 30e3);
  expect_close(cell.material->kae, 4e3);
  EXPECT_EQ(cell.material->process_damping, 5e5);
  EXPECT_EQ(cell.cut->milling, Milling::up);
  EXPECT_EQ(cell.cut->radial_depth, cell.tool->diameter);
  expect_close(cell.cut->feed_direction, -pi / 4.0);
  expect_close(cell.cut->tilt, pi / 12.0);
  expect_close(cell.cut->lead, -pi / 6.0);
  expect_close(cell.cut->redundancy, pi);
  expect_close(cell.cut->step_over, 0.5e-3);
  EXPECT_EQ(cell.cut->path, PathKind::zigzag);
  ASSERT_EQ(cell.region->islands.size(), 2U);
  expect_close(cell.region->islands[1][2][1], 0.005);
  EXPECT_EQ(cell.dynamics->interpolation, InterpolationKind::frf);
  EXPECT_EQ(cell.dynamics->power, 2.0);
  EXPECT_EQ(cell.dynamics->posture, "0,-90,90.5,0,0,15");
  EXPECT_EQ(cell.can->bus, "local:cell-1");
  ASSERT_EQ(cell.can->accelerometers.size(), 2U);
  EXPECT_EQ(cell.can->accelerometers[0].axis, (std::array<std::string, 3>{"", "A.Ay", ""}));
  EXPECT_EQ(cell.can->accelerometers[0].unit_m_per_s2, 9.80665);
  EXPECT_EQ(cell.can->accelerometers[0].counter, "");
  expect_close(cell.can->accelerometers[0].rotation[1], pi / 2.0);
  expect_close(cell.can->accelerometers[0].rotation[2], -pi);
  EXPECT_EQ(cell.can->accelerometers[1].sample_rate_hz, 1000.0);
  EXPECT_EQ(cell.can->spindle_speed, "");
  EXPECT_EQ(cell.lcm_url, "memq://");
  EXPECT_EQ(cell.mode, RuntimeMode::active);
}

TEST(Cell, ReadsTheHammerAndTheEndsOfRanges) {
  EXPECT_FALSE(read(kExampleCell).can->hammer.has_value());
  const std::string text = replaced(kExampleCell, "[can.spindle]",
                                    "full_scale_m_per_s2 = 490\n[can.hammer]\nsample_rate_hz = 25600\n"
                                    "force_n = \"Hammer.Force{0..9}\"\ncounter = \"Hammer.Counter\"\n[can.spindle]");
  const Cell cell = read(text);
  ASSERT_TRUE(cell.can->hammer.has_value());
  EXPECT_EQ(cell.can->hammer->force, "Hammer.Force{0..9}");
  EXPECT_EQ(cell.can->hammer->counter, "Hammer.Counter");
  EXPECT_EQ(cell.can->hammer->sample_rate_hz, 25600.0);
  EXPECT_EQ(cell.can->hammer->full_scale_n, kInfinity);
  EXPECT_EQ(cell.can->hammer->line, line_of(text, "[can.hammer]"));
  EXPECT_EQ(cell.can->accelerometers[0].full_scale_m_per_s2, 490.0);
  const auto message = [&](const std::string& from, const std::string& to) {
    return message_of<InputError>([&] { (void)read(replaced(text, from, to)); });
  };
  EXPECT_THAT(message("force_n = \"Hammer.Force{0..9}\"", ""), testing::HasSubstr("can.hammer.force_n: is missing"));
  EXPECT_THAT(message("force_n = ", "full_scale_n = -1\nforce_n = "),
              testing::HasSubstr("can.hammer.full_scale_n: -1"));
  EXPECT_THAT(message("Hammer.Force{0..9}", "Force"), testing::HasSubstr("\"Force\" names no signal"));
}

// A cell that is measured has no map yet, and corrects nothing.
TEST(Cell, ThatMeasuresIsOffAndNeedsNoMap) {
  const TempFolder folder;
  const std::string text = replaced(kExampleCell, "\"map\"", "\"absent-map\"");
  const auto with_mode = [&](const std::string& mode) {
    return write_example_cell(folder, replaced(text, "mode = \"shadow\"", "mode = \"" + mode + "\""));
  };
  const Cell cell = read_cell(with_mode("measure"), {.dbc = false, .bus = false});
  EXPECT_TRUE(cell.measures);
  EXPECT_EQ(cell.mode, RuntimeMode::off);
  EXPECT_THROW(read_cell(with_mode("off"), {.dbc = false, .bus = false}), InputError);
  EXPECT_FALSE(read(kExampleCell).measures);
}

TEST(Cell, GivesEqualPitchWhereNoneIsNamed) {
  const Cell cell = read("[tool]\nshape = \"end\"\ndiameter_mm = 8\nteeth = 4\n");
  ASSERT_EQ(cell.tool->pitch.size(), 4U);
  for (const double pitch : cell.tool->pitch) expect_close(pitch, pi / 2.0);
}

TEST(Cell, LeavesAbsentSectionsEmptyAndStartsInShadow) {
  const Cell cell = read("# a cell without anything\n");
  EXPECT_FALSE(cell.tool || cell.material || cell.cut || cell.region || cell.spindle || cell.dynamics || cell.can);
  EXPECT_EQ(cell.mode, RuntimeMode::shadow);
  EXPECT_NE(message_of<InputError>([&] { require(cell, cell.tool, "tool"); }).find("[tool] is missing"),
            std::string::npos);
}

TEST(Cell, TurnsARelativeLogBusIntoAnAbsolutePath) {
  const TempFolder folder;
  (void)folder.write("logs/cut.log", "");
  const auto file = write_example_cell(folder, replaced(kExampleCell, "socketcan:can0", "log:logs/cut.log"));
  EXPECT_EQ(read_cell(file).can->bus, "log:" + (folder.path() / "logs/cut.log").string());
}

TEST(Cell, AcceptsMissingFilesThatTheCommandDoesNotNeed) {
  const TempFolder folder;
  std::string text = replaced(kExampleCell, "socketcan:can0", "log:absent.log");
  text = replaced(replaced(text, "\"map\"", "\"absent-map\""), "cell.dbc", "absent.dbc");
  const auto file = write_example_cell(folder, text);
  const Cell cell = read_cell(file, {.map = false, .dbc = false, .bus = false});
  EXPECT_EQ(cell.can->bus, "log:" + (folder.path() / "absent.log").string());
  EXPECT_THROW(read_cell(file, {.map = true, .dbc = false, .bus = false}), InputError);
  EXPECT_THROW(read_cell(file, {.map = false, .dbc = true, .bus = false}), InputError);
  EXPECT_THROW(read_cell(file, {.map = false, .dbc = false, .bus = true}), InputError);
}

TEST(Cell, NeedsNoBusWhereTheCommandNamesAnother) {
  const std::string text = replaced(kExampleCell, "bus = \"socketcan:can0\"", "");
  EXPECT_EQ(read(text, {.bus = false}).can->bus, "");
  EXPECT_NE(message_of<InputError>([&] { read(text); }).find("can.bus: is missing"), std::string::npos);
}

TEST(Cell, AcceptsWindowsLineEndsAndByteOrderMark) {
  std::string text = "\xEF\xBB\xBF";
  for (const char c : kExampleCell) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(read(text).can->accelerometers.front().axis[2], "Vibration.Z{0..9}");
}

}  // namespace
}  // namespace stillcut
