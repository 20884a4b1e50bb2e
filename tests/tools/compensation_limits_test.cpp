// What a correction may ask, put together from the sections of a cell.
#include <gtest/gtest.h>

#include <string>

#include "drivers/files/input_error.hpp"
#include "tests/simulated_cut.hpp"
#include "tools/pipeline.hpp"

namespace stillcut {
namespace {

TEST(CompensationLimits, WithoutAWindowOfCuttingSpeedTheSpindlesRangeHolds) {
  const Cell cell = demo_cell();
  const CompensationLimits limits = compensation_limits(cell);
  EXPECT_EQ(limits.spindle.min_speed, cell.spindle->min_speed);
  EXPECT_EQ(limits.spindle.max_speed, cell.spindle->max_speed);
  EXPECT_EQ(limits.spindle.acceleration, cell.spindle->acceleration);
  EXPECT_EQ(limits.feed_per_tooth, cell.cut->feed_per_tooth);
}

TEST(CompensationLimits, TheToolsWindowOfCuttingSpeedNarrowsTheSpindlesRangeAndNeverWidensIt) {
  Cell cell = demo_cell();
  const double radius = 0.5 * cell.tool->diameter;
  const double low = cell.spindle->min_speed, high = cell.spindle->max_speed;
  cell.compensation.min_cutting_speed = radius * (low + 0.2 * (high - low));
  cell.compensation.max_cutting_speed = radius * (low + 0.7 * (high - low));
  const CompensationLimits narrow = compensation_limits(cell);
  EXPECT_NEAR(narrow.spindle.min_speed, low + 0.2 * (high - low), 1e-9);
  EXPECT_NEAR(narrow.spindle.max_speed, low + 0.7 * (high - low), 1e-9);
  cell.compensation.min_cutting_speed = 0.1 * radius * low;
  cell.compensation.max_cutting_speed = 10.0 * radius * high;
  const CompensationLimits wide = compensation_limits(cell);
  EXPECT_EQ(wide.spindle.min_speed, low);
  EXPECT_EQ(wide.spindle.max_speed, high);
}

TEST(CompensationLimits, AWindowThatLeavesTheSpindleNoSpeedIsToldInOneLine) {
  Cell cell = demo_cell();
  cell.compensation.min_cutting_speed = 0.5 * cell.tool->diameter * cell.spindle->max_speed * 1.01;
  try {
    (void)compensation_limits(cell);
    FAIL() << "was accepted";
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("compensation: the window of cutting speed leaves no speed"), std::string::npos) << message;
    EXPECT_NE(message.find("min_cutting_speed_m_per_min"), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace stillcut
