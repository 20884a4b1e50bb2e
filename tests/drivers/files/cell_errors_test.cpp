// Every kind of mistake in a cell file gives one line that names file, line and key, and says what to do.
#include <gtest/gtest.h>

#include <random>

#include "drivers/files/cell.hpp"
#include "tests/drivers/files/example_cell.hpp"

namespace stillcut {
namespace {

std::string error_of(const std::string& text) {
  const TempFolder folder;
  const auto file = write_example_cell(folder, text);
  std::string message = message_of<InputError>([&] { read_cell(file); });
  // The folder's name is random: leave the file's own name.
  const std::string prefix = folder.path().string() + "/";
  if (message.starts_with(prefix)) message.erase(0, prefix.size());
  return message;
}

// `from` in the example becomes `to`; the error must stand at the line where `at` then is, begin with `key` and hold
// `words`.
struct Mistake {
  std::string from, to, at, key, words;
};

const std::string kModeLine = "mode = \"shadow\"            # * off | shadow | active\n";
std::string with_monitor(const std::string& key) { return kModeLine + "[monitor]\n" + key + "\n"; }

const std::vector<Mistake> kMistakes{
    // Unknown keys and tables.
    {"diameter_mm", "diamter_mm", "diamter_mm", "tool.diamter_mm", "did you mean diameter_mm?"},
    {"teeth", "Teeth", "Teeth", "tool.Teeth", "did you mean teeth?"},
    {"path =", "colour =", "colour", "cut.colour", "unknown key; remove it (known here: milling"},
    {"[spindle]", "[spindel]", "[spindel]", "spindel", "unknown table; did you mean spindle?"},
    {"[can.spindle]", "[can.spindl]", "[can.spindl]", "can.spindl", "did you mean spindle?"},
    {"counter =", "countr =", "countr", "can.accelerometer.countr", "did you mean counter?"},
    {"speed_rpm = \"Sp", "speed = \"Sp", "speed = \"Sp", "can.spindle.speed", "unknown key"},
    {"[tool]", "stray = 1\n[tool]", "stray", "stray", "unknown key"},
    {"url =", "uri =", "uri =", "lcm.uri", "did you mean url?"},
    {"mode = ", "modus = ", "modus", "runtime.modus", "unknown key"},
    // Missing keys, at their table.
    {"shape = \"end\"", "", "[tool]", "tool.shape", "is missing; add it to [tool]"},
    {"diameter_mm = 25.0", "", "[tool]", "tool.diameter_mm", "is missing"},
    {"ktc_mpa = 800.0", "", "[material]", "material.ktc_mpa", "is missing"},
    {"feed_direction_deg = 0.0", "", "[cut]", "cut.feed_direction_deg", "is missing"},
    {"max_rpm = 3800", "", "[spindle]", "spindle.max_rpm", "is missing"},
    {"map = \"map\"", "", "[dynamics]", "dynamics.map", "is missing"},
    {"dbc = \"cell.dbc\"", "", "[can]", "can.dbc", "is missing"},
    {"sample_rate_hz = 25600", "", "[[can.acc", "can.accelerometer.sample_rate_hz", "is missing"},
    {"speed_rpm = \"Spindle.Speed\"", "", "[can.spindle]", "can.spindle.speed_rpm", "is missing"},
    {"polygon_mm = [[0, 0], [300, 0], [300, 300], [0, 300]]", "", "[region]", "region.polygon_mm", "is missing"},
    // Wrong types.
    {"25.0", "\"25\"", "diameter_mm", "tool.diameter_mm", "is text; give a number above 0"},
    {"teeth = 2", "teeth = 2.0", "teeth", "tool.teeth", "decimal point; give a whole number from 1"},
    {"shape = \"end\"", "shape = 1", "shape", "tool.shape", "is a whole number; give one of"},
    {"name = \"AL7075-T6\"", "name = true", "name =", "material.name", "is true or false; give text in quotes"},
    {"krc_mpa = 300.0", "krc_mpa = 2020-01-01", "krc_mpa", "material.krc_mpa", "is a date or time"},
    {"pitch_deg = [180.0, 180.0]", "pitch_deg = 180", "pitch_deg", "tool.pitch_deg", "give a list of numbers"},
    {"pitch_deg = [180.0, 180.0]", "pitch_deg = [180, \"x\"]", "pitch_deg", "tool.pitch_deg", "is text"},
    {"[tool]", "[[tool]]", "[[tool]]", "tool", "is a list; give a table, [tool]"},
    {"[[can.accelerometer]]", "[can.accelerometer]", "[can.acc", "can.accelerometer", "each headed [[can.acc"},
    {"[[can.accelerometer]]", "accelerometer = [1]\n[can.x]", "accelerometer = [1]", "can.accelerometer",
     "each headed [[can.acc"},
    {"posture = \"12\"", "posture = 12", "posture = ", "dynamics.posture", "text in quotes"},
    {"posture = \"12\"", "posture = [1, 2]", "posture = ", "dynamics.posture", "list of 2 numbers"},
    {"bus = \"socketcan:can0\"", "bus = [\"socketcan:can0\"]", "bus", "can.bus", "text in quotes"},
    {"polygon_mm = [[0, 0],", "polygon_mm = [[0, 0, 0],", "polygon_mm", "region.polygon_mm", "pair of numbers"},
    {"islands_mm = []", "islands_mm = 3", "islands_mm", "region.islands_mm", "list of polygons"},
    {"islands_mm = []", "islands_mm = [[0, 1]]", "islands_mm", "region.islands_mm", "pair of numbers"},
    // Values out of range.
    {"25.0", "0", "diameter_mm", "tool.diameter_mm", "0 is out of range; give a number above 0 and up to 1000"},
    {"25.0", "-25.0", "diameter_mm", "tool.diameter_mm", "-25 is out of range"},
    {"25.0", "nan", "diameter_mm", "tool.diameter_mm", "nan is out of range"},
    {"800.0", "inf", "ktc_mpa", "material.ktc_mpa", "inf is out of range"},
    {"300.0\nkac", "-inf\nkac", "krc_mpa", "material.krc_mpa", "-inf is out of range"},
    {"shape = \"end\"", "shape = \"flat\"", "shape", "tool.shape", "\"flat\" is not known; give one of \"end, ball\""},
    {"teeth = 2", "teeth = 0", "teeth", "tool.teeth", "0 is out of range; give a whole number from 1"},
    {"teeth = 2", "teeth = -9000000000", "teeth", "tool.teeth", "out of range"},
    {"[180.0, 180.0]", "[120.0, 120.0, 120.0]", "pitch_deg", "tool.pitch_deg", "3 angles for 2 teeth"},
    {"[180.0, 180.0]", "[]", "pitch_deg", "tool.pitch_deg", "0 angles for 2 teeth"},
    {"[180.0, 180.0]", "[180.0, 180.02]", "pitch_deg", "tool.pitch_deg", "360.02 degrees"},
    {"[180.0, 180.0]", "[-10, 370]", "pitch_deg", "tool.pitch_deg", "-10 is out of range"},
    {"radial_depth_mm = 12.5", "radial_depth_mm = 25.001", "radial_depth_mm", "cut.radial_depth_mm",
     "the tool's diameter"},
    {"radial_depth_mm = 12.5", "radial_depth_mm = 0", "radial_depth_mm", "cut.radial_depth_mm", "above 0"},
    {"axial_depth_mm = 0.15", "axial_depth_mm = 0.0", "axial_depth_mm", "cut.axial_depth_mm", "above 0"},
    {"feed_per_tooth_mm = 0.05", "feed_per_tooth_mm = -1", "feed_per_tooth_mm", "cut.feed_per_tooth_mm", "above 0"},
    {"spindle_speed_rpm = 3330", "spindle_speed_rpm = 0", "spindle_speed_rpm", "cut.spindle_speed_rpm", "above 0"},
    {"milling = \"down\"", "milling = \"Down\"", "milling", "cut.milling", "give one of \"down, up, slot\""},
    {"path = \"unidirectional\"", "path = \"zig-zag\"", "path =", "cut.path", "unidirectional, zigzag"},
    {"tilt_deg = 0.0", "tilt_deg = 91", "tilt_deg", "cut.tilt_deg", "from -90 to 90"},
    {"[300, 300], [0, 300]]", "]", "polygon_mm", "region.polygon_mm", "has 2 points"},
    {"[300, 300], [0, 300]]", "[150, 0]]", "polygon_mm", "region.polygon_mm", "encloses no area"},
    {"[0, 300]]", "[0, 100], [300, 100]]", "polygon_mm", "region.polygon_mm",
     "touches itself at (300, 100) mm; correct"},
    {"[0, 300]]", "[0, 30000]]", "polygon_mm", "region.polygon_mm", "at (0, 30000) mm, more than 10 m"},
    {"islands_mm = []", "islands_mm = [[[9, 9], [20, 9], [9, 20]], [[12, 5], [18, 5], [15, 9]]]", "islands_mm",
     "region.islands_mm", "island 1 meets island 2 at (15, 9) mm; make one island of the two"},
    {"islands_mm = []", "islands_mm = [[[301, 9], [320, 9], [301, 20]]]", "islands_mm", "region.islands_mm",
     "island 1 lies outside the polygon, at (301, 9) mm; move it inside"},
    {"max_rpm = 3800", "max_rpm = 2800", "max_rpm", "spindle.max_rpm", "above min_rpm, 2800"},
    {"min_rpm = 2800", "min_rpm = -5", "min_rpm", "spindle.min_rpm", "above 0"},
    {"acceleration_rpm_per_s = 2000", "acceleration_rpm_per_s = 0", "accel", "spindle.acceleration_rpm_per_s",
     "above 0"},
    {"jerk_rpm_per_s2 = 20000", "jerk_rpm_per_s2 = -1", "jerk", "spindle.jerk_rpm_per_s2", "above 0"},
    {"interpolation = \"modal\"", "interpolation = \"linear\"", "interpol", "dynamics.interpolation",
     "modal, frf, trend"},
    {"power = 1.0", "power = 0", "power", "dynamics.power", "above 0"},
    {"sample_rate_hz = 25600", "sample_rate_hz = 0", "sample_rate", "can.accelerometer.sample_rate_hz", "above 0"},
    {"unit = \"m/s^2\"", "unit = \"mm/s^2\"", "unit", "can.accelerometer.unit", "give one of \"m/s^2, g\""},
    {"rotation_deg = [0, 0, 0]", "rotation_deg = [0, 0]", "rotation", "can.accelerometer.rotation_deg", "three angles"},
    {"\"Vibration.X{0..9}\"", "\"X\"", "x = ", "can.accelerometer.x", "names no signal; give \"Message.Signal\""},
    {"\"Vibration.X{0..9}\"", "\"Vibration.X{0-9}\"", "x = ", "can.accelerometer.x", "names no signal"},
    {"\"Vibration.X{0..9}\"", "\"Vibration.{0..9}\"", "x = ", "can.accelerometer.x", "names no signal"},
    {"\"Vibration.X{0..9}\"", "\"Vibration.X{0..9}{0..9}\"", "x = ", "can.accelerometer.x", "names no signal"},
    {"\"Vibration.X{0..9}\"", "\"1.X\"", "x = ", "can.accelerometer.x", "names no signal"},
    {"\"Vibration.X{0..9}\"", "\"\"", "x = ", "can.accelerometer.x", "names no signal"},
    {"\"Vibration.Counter\"", "\"Vibration.C{0..1}\"", "counter = ", "can.accelerometer.counter", "names no signal"},
    {"\"Spindle.Speed\"", "\"Spindle Speed\"", "speed_rpm = \"Sp", "can.spindle.speed_rpm", "names no signal"},
    {"socketcan:can0", "can0", "bus", "can.bus", "\"can0\" is no bus; give socketcan:IFACE"},
    {"socketcan:can0", "socketcan:", "bus", "can.bus", "is no bus"},
    {"socketcan:can0", "socketcan:a-name-with-16-ch", "bus", "can.bus", "at most 15 letters"},
    {"socketcan:can0", "local:a/b", "bus", "can.bus", "is no bus"},
    {"udpm://239", "udp://239", "url", "lcm.url", "is no LCM address"},
    {"mode = \"shadow\"", "mode = \"on\"", "mode = ", "runtime.mode", "give one of \"off, measure, shadow, active\""},
    {kModeLine, with_monitor("limit = 3.9"), "limit", "monitor.limit",
     "3.9 is out of range; give a number from 4 to 400"},
    {kModeLine, with_monitor("limit = 401"), "limit", "monitor.limit", "401 is out of range"},
    {kModeLine, with_monitor("limit = nan"), "limit", "monitor.limit", "nan is out of range"},
    {kModeLine, with_monitor("limit = \"16\""), "limit", "monitor.limit", "is text; give a number"},
    {kModeLine, with_monitor("release_ratio = 0.04"), "release", "monitor.release_ratio",
     "give a number from 0.05 to 0.9"},
    {kModeLine, with_monitor("release_ratio = 0.91"), "release", "monitor.release_ratio", "0.91 is out of range"},
    {kModeLine, with_monitor("release_ratio = [0.2]"), "release", "monitor.release_ratio", "is a list"},
    {kModeLine, with_monitor("limits = 16"), "limits", "monitor.limits", "unknown key; did you mean limit?"},
    {kModeLine, with_monitor("threshold = 16"), "threshold", "monitor.threshold", "known here: limit, release_ratio"},
    // Missing files.
    {"\"map\"", "\"no-such-map\"", "map = ", "dynamics.map", "no folder /"},
    {"\"map\"", "\"cell.dbc\"", "map = ", "dynamics.map", "cell.dbc is no folder"},
    {"\"map\"", "\"\"", "map = ", "dynamics.map", "is empty"},
    {"cell.dbc", "absent.dbc", "dbc = ", "can.dbc", "no file /"},
    {"cell.dbc", "map", "dbc = ", "can.dbc", "map is a folder"},
    {"socketcan:can0", "log:absent.log", "bus", "can.bus", "no file /"},
    // TOML itself.
    {"teeth = 2", "teeth = 2\nteeth = 2", "", "teeth", "cannot redefine existing integer 'teeth'"},
    {"[material]", "[tool]", "", "tool", "cannot redefine existing table 'tool'"},
    {"25.0", "25,0", "diameter_mm", "diameter_mm", "saw ','; mend this line"},
    {"25.0", "25 mm", "diameter_mm", "diameter_mm", "mend this line"},
    {"teeth = 2", "teeth =", "teeth", "teeth", "expected value"},
    {"teeth = 2", "teeth = 007", "teeth", "teeth", "leading zeroes"},
    {"\"AL7075-T6\"", "\"AL7075-T6", "name", "name", "mend this line"},
    {"\"AL7075-T6\"", "\"\xFF\xFE\"", "name", "name", "utf-8"},
    {"800.0", "1e999", "ktc_mpa", "ktc_mpa", "could not be interpreted"},
};

TEST(CellErrors, NameFileLineAndKey) {
  for (const Mistake& mistake : kMistakes) {
    SCOPED_TRACE(mistake.from + " -> " + mistake.to);
    const std::string text = replaced(kExampleCell, mistake.from, mistake.to);
    const std::string message = error_of(text);
    ASSERT_FALSE(message.empty()) << "was accepted";
    const std::string place =
        mistake.at.empty() ? "cell.toml:" : "cell.toml:" + std::to_string(line_of(text, mistake.at));
    EXPECT_TRUE(message.starts_with(mistake.at.empty() ? place : place + ": " + mistake.key)) << message;
    EXPECT_NE(message.find(mistake.key + ": "), std::string::npos) << message;
    EXPECT_NE(message.find(mistake.words), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST(CellErrors, GiveTheLineOfTheSecondOfTwoEqualKeys) {
  EXPECT_TRUE(error_of("[tool]\nteeth = 2\nteeth = 3\n").starts_with("cell.toml:3: teeth: "));
  EXPECT_TRUE(error_of("[tool]\n\n\n[tool]\n").starts_with("cell.toml:4: tool: "));
}

TEST(CellErrors, RefuseAnAccelerometerWithoutAxes) {
  const std::string message = error_of(
      "[can]\nbus = \"local:a\"\ndbc = \"cell.dbc\"\n[[can.accelerometer]]\n"
      "sample_rate_hz = 1000\nunit = \"g\"\n");
  EXPECT_TRUE(message.starts_with("cell.toml:4: can.accelerometer.x: is missing")) << message;
}

TEST(CellErrors, RefuseMoreAccelerometersThanTheCoreHolds) {
  std::string text = "[can]\nbus = \"local:a\"\ndbc = \"cell.dbc\"\n";
  const std::string sensor = "[[can.accelerometer]]\nsample_rate_hz = 1000\nx = \"M.S\"\nunit = \"g\"\n";
  for (int i = 0; i < kMaxSensors; ++i) text += sensor;
  EXPECT_EQ(error_of(text), "");
  const std::string message = error_of(text + sensor);
  EXPECT_NE(message.find("can.accelerometer: there are 5"), std::string::npos) << message;
}

TEST(CellErrors, KeepOneLineWhereTheUsersTextHoldsALineBreak) {
  const std::string message = error_of("[tool]\nshape = \"e\\nd\"\n");
  EXPECT_TRUE(message.starts_with("cell.toml:2: tool.shape: \"e?d\" is not known")) << message;
}

TEST(CellErrors, NameAFileThatIsMissingOrAFolder) {
  const TempFolder folder;
  const auto absent = folder.path() / "absent.toml";
  EXPECT_EQ(message_of<InputError>([&] { read_cell(absent); }), absent.string() + ": no such file; check the path");
  EXPECT_EQ(message_of<InputError>([&] { read_cell(folder.path()); }),
            folder.path().string() + ": is a folder; name a file in it");
}

TEST(CellErrors, RefuseBinaryFiles) {
  EXPECT_TRUE(error_of(std::string("\x7F"
                                   "ELF\x02\x01\0\0",
                                   8))
                  .starts_with("cell.toml:1: "));
  EXPECT_TRUE(error_of(std::string("[tool]\n\0", 8)).starts_with("cell.toml:2: "));
}

// Any damage to the example is an InputError or a cell, never another exception or a crash.
TEST(CellErrors, AreTheOnlyAnswerToDamagedFiles) {
  std::mt19937 random(20240607);
  int refused = 0;
  for (int i = 0; i < 500; ++i) {
    std::string text = kExampleCell;
    const std::size_t changes = 1 + random() % 4;
    for (std::size_t change = 0; change < changes; ++change) {
      const std::size_t at = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[at] = static_cast<char>(random() % 256);
          break;
        case 1:
          text.erase(at, 1 + random() % 20);
          break;
        default:
          text.insert(at, text.substr(random() % text.size(), random() % 20));
          break;
      }
    }
    const std::string message = error_of(text);
    refused += message.empty() ? 0 : 1;
    ASSERT_EQ(message.find('\n'), std::string::npos);
  }
  EXPECT_GT(refused, 250);
}

}  // namespace
}  // namespace stillcut
