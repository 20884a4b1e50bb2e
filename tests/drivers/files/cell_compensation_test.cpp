// The section [compensation] of a cell file: what corrections may ask.
#include <gtest/gtest.h>

#include <cmath>

#include "drivers/files/cell.hpp"
#include "tests/drivers/files/example_cell.hpp"

namespace stillcut {
namespace {

const std::string kHead = kExampleCell + "[compensation]\n";

Cell cell_with(const std::string& keys) {
  const TempFolder folder;
  return read_cell(write_example_cell(folder, kHead + keys + "\n"));
}

void expect_near(double value, double expected) { EXPECT_NEAR(value, expected, 1e-12 * std::abs(expected)); }

TEST(CellCompensation, EveryKeyIsReadInSiUnits) {
  const CompensationSettings read = cell_with(R"(
spindle_time_constant_s = 0.25
avoid_rpm = [[3000, 3100], [3500, 3550]]
min_cutting_speed_m_per_min = 120
max_cutting_speed_m_per_min = 600
min_feed_per_tooth_mm = 0.03
max_feed_per_tooth_mm = 0.12
min_feed_override = 0.4
max_feed_override = 1.5
feed_override_per_s = 2.5
free_feed_turn_deg = 45
turn_rate_deg_per_s = 90
max_speed_variation = 0.15
max_speed_variation_hz = 3
stop_request = false)")
                                        .compensation;
  const CompensationLimits& limits = read.limits;
  EXPECT_EQ(limits.spindle_time_constant_s, 0.25);
  ASSERT_EQ(limits.avoided_count, 2U);
  expect_near(limits.avoided[0].low, rpm_to_rad_s(3000));
  expect_near(limits.avoided[0].high, rpm_to_rad_s(3100));
  expect_near(limits.avoided[1].low, rpm_to_rad_s(3500));
  expect_near(limits.avoided[1].high, rpm_to_rad_s(3550));
  expect_near(read.min_cutting_speed, 2.0);
  expect_near(read.max_cutting_speed, 10.0);
  expect_near(limits.min_feed_per_tooth, 0.03e-3);
  expect_near(limits.max_feed_per_tooth, 0.12e-3);
  EXPECT_EQ(limits.min_feed_override, 0.4);
  EXPECT_EQ(limits.max_feed_override, 1.5);
  EXPECT_EQ(limits.feed_override_rate, 2.5);
  expect_near(limits.free_turn, deg_to_rad(45));
  expect_near(limits.turn_rate, deg_to_rad(90));
  EXPECT_EQ(limits.max_variation, 0.15);
  EXPECT_EQ(limits.max_variation_hz, 3.0);
  EXPECT_FALSE(limits.may_stop);
}

TEST(CellCompensation, LeftOutItIsTheDefaultWithNoWindowAndNoFreedom) {
  const CompensationLimits fallback;
  const TempFolder folder;
  for (const Cell& cell : {cell_with(""), read_cell(write_example_cell(folder))}) {
    const CompensationLimits& limits = cell.compensation.limits;
    EXPECT_EQ(limits.spindle_time_constant_s, fallback.spindle_time_constant_s);
    EXPECT_EQ(limits.avoided_count, 0U);
    EXPECT_EQ(cell.compensation.min_cutting_speed, 0.0);
    EXPECT_TRUE(std::isinf(cell.compensation.max_cutting_speed));
    EXPECT_EQ(limits.min_feed_per_tooth, 0.0);
    EXPECT_TRUE(std::isinf(limits.max_feed_per_tooth));
    EXPECT_EQ(limits.min_feed_override, fallback.min_feed_override);
    EXPECT_EQ(limits.max_feed_override, fallback.max_feed_override);
    EXPECT_EQ(limits.feed_override_rate, fallback.feed_override_rate);
    EXPECT_EQ(limits.free_turn, 0.0);
    expect_near(limits.turn_rate, fallback.turn_rate);
    EXPECT_EQ(limits.max_variation, fallback.max_variation);
    EXPECT_EQ(limits.max_variation_hz, fallback.max_variation_hz);
    EXPECT_TRUE(limits.may_stop);
  }
}

TEST(CellCompensation, AWindowMayBeOpenToOneSideAndLimitsBelongToTheirRange) {
  EXPECT_TRUE(std::isinf(cell_with("min_cutting_speed_m_per_min = 60").compensation.max_cutting_speed));
  EXPECT_EQ(cell_with("max_feed_per_tooth_mm = 0.1").compensation.limits.min_feed_per_tooth, 0.0);
  EXPECT_EQ(cell_with("min_feed_override = 1").compensation.limits.min_feed_override, 1.0);
  EXPECT_EQ(cell_with("max_feed_override = 1").compensation.limits.max_feed_override, 1.0);
  EXPECT_EQ(cell_with("max_speed_variation = 0").compensation.limits.max_variation, 0.0);
  expect_near(cell_with("free_feed_turn_deg = 180").compensation.limits.free_turn, deg_to_rad(180));
  std::string bands;
  for (std::size_t i = 0; i < CompensationLimits::kMaxBands; ++i)
    bands += (i == 0 ? "" : ", ") + std::string("[3000, 3001]");
  EXPECT_EQ(cell_with("avoid_rpm = [" + bands + "]").compensation.limits.avoided_count, CompensationLimits::kMaxBands);
}

struct WrongKey {
  std::string line, key, words;
};

const std::vector<WrongKey> kWrongKeys{
    {"spindle_time_constant_s = 0", "spindle_time_constant_s", "0 is out of range; give a number above 0"},
    {"spindle_time_constant_s = 11", "spindle_time_constant_s", "11 is out of range"},
    {"spindle_time_constant_s = \"0.3\"", "spindle_time_constant_s", "is text; give a number"},
    {"avoid_rpm = 3000", "avoid_rpm", "give a list of pairs, [[a, b], [a, b]]"},
    {"avoid_rpm = []", "avoid_rpm", "give a list of pairs"},
    {"avoid_rpm = [3000, 3100]", "avoid_rpm", "an entry is not a pair of numbers"},
    {"avoid_rpm = [[3000, 3100, 3200]]", "avoid_rpm", "an entry is not a pair of numbers"},
    {"avoid_rpm = [[3100, 3000]]", "avoid_rpm", "a pair goes from 3100 to 3000; give the lower speed first"},
    {"avoid_rpm = [[3000, 3000]]", "avoid_rpm", "give the lower speed first"},
    {"avoid_rpm = [[0, 3000]]", "avoid_rpm", "0 is out of range"},
    {"avoid_rpm = [[3000, nan]]", "avoid_rpm", "nan is out of range"},
    {"avoid_rpm = [[3000, \"x\"]]", "avoid_rpm", "is text"},
    {"avoid_rpm = [[1,2],[1,2],[1,2],[1,2],[1,2],[1,2],[1,2],[1,2],[1,2]]", "avoid_rpm",
     "has more than 8 pairs; join those that lie close together"},
    {"min_cutting_speed_m_per_min = -1", "min_cutting_speed_m_per_min", "-1 is out of range"},
    {"max_cutting_speed_m_per_min = inf", "max_cutting_speed_m_per_min", "inf is out of range"},
    {"min_feed_per_tooth_mm = -0.1", "min_feed_per_tooth_mm", "-0.1 is out of range"},
    {"max_feed_per_tooth_mm = 101", "max_feed_per_tooth_mm", "101 is out of range"},
    {"min_feed_override = 0", "min_feed_override", "0 is out of range"},
    {"min_feed_override = 1.1", "min_feed_override", "1.1 is out of range"},
    {"max_feed_override = 0.9", "max_feed_override", "0.9 is out of range; give a number from 1"},
    {"max_feed_override = 11", "max_feed_override", "11 is out of range"},
    {"feed_override_per_s = 0", "feed_override_per_s", "0 is out of range"},
    {"free_feed_turn_deg = -1", "free_feed_turn_deg", "-1 is out of range; give a number from 0"},
    {"free_feed_turn_deg = 181", "free_feed_turn_deg", "181 is out of range"},
    {"feed_map = \"nowhere.csv\"", "feed_map", "no file"},
    {"feed_map = \"cell.dbc\"", "feed_map", "set free_feed_turn_deg above 0"},
    {"turn_rate_deg_per_s = 0", "turn_rate_deg_per_s", "0 is out of range"},
    {"max_speed_variation = 0.51", "max_speed_variation", "0.51 is out of range"},
    {"max_speed_variation_hz = 0", "max_speed_variation_hz", "0 is out of range"},
    {"max_speed_variation_hz = [1]", "max_speed_variation_hz", "is a list"},
    {"stop_request = 1", "stop_request", "is a whole number; give true or false"},
    {"stop_request = \"yes\"", "stop_request", "is text; give true or false"},
    {"avoid_rpms = [[3000, 3100]]", "avoid_rpms", "unknown key; did you mean avoid_rpm?"},
    {"gain = 1", "gain", "unknown key; remove it (known here: "},
};

TEST(CellCompensation, EveryMistakeIsOneLineOfFileLineAndKey) {
  for (const WrongKey& wrong : kWrongKeys) {
    SCOPED_TRACE(wrong.line);
    const TempFolder folder;
    const auto file = write_example_cell(folder, kHead + wrong.line + "\n");
    const std::string message = message_of<InputError>([&] { read_cell(file); });
    const std::string place = file.string() + ":" + std::to_string(line_of(kHead, "[compensation]") + 1);
    EXPECT_TRUE(message.starts_with(place + ": compensation." + wrong.key + ": ")) << message;
    EXPECT_NE(message.find(wrong.words), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST(CellCompensation, AWindowWithNothingInItIsToldAtItsUpperEnd) {
  for (const std::string quantity : {"cutting_speed_m_per_min", "feed_per_tooth_mm"}) {
    for (const std::string upper : {"0.1", "0.2"}) {
      const TempFolder folder;
      const auto file =
          write_example_cell(folder, kHead + "min_" + quantity + " = 0.2\nmax_" + quantity + " = " + upper + "\n");
      const std::string message = message_of<InputError>([&] { read_cell(file); });
      const std::string place = file.string() + ":" + std::to_string(line_of(kHead, "[compensation]") + 2);
      EXPECT_TRUE(message.starts_with(place + ": compensation.max_" + quantity + ": ")) << message;
      EXPECT_NE(message.find("give max_" + quantity + " above min_" + quantity), std::string::npos) << message;
    }
  }
}

}  // namespace
}  // namespace stillcut
