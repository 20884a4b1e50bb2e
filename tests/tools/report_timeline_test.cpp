#include "tools/report_timeline.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace stillcut {
namespace {

// However long the recording, every stretch tells the worst of exactly its own moments.
TEST(Timeline, TellsTheWorstOfEveryStretchInBoundedLength) {
  std::mt19937 random{2};
  for (const double length_s : {0.3, 60.0, 1000.0, 30'000.0}) {
    Timeline timeline;
    std::vector<TimelinePoint> seen;
    std::uniform_real_distribution<double> value{0.0, 5.0};
    for (int i = 0; i < 20'000; ++i) {
      TimelinePoint point;
      point.begin_s = length_s * i / 20'000.0;
      point.state = static_cast<State>(random() % kStates);
      point.indicator = random() % 4 == 0 ? kNaN : value(random);
      point.low_rpm = point.high_rpm = 1000.0 * value(random);
      seen.push_back(point);
      timeline.add(point);
    }
    ASSERT_LE(timeline.points().size(), Timeline::kMost);
    EXPECT_GE(timeline.step_s() * static_cast<double>(timeline.points().size()), seen.back().begin_s);
    std::vector<TimelinePoint> expected(timeline.points().size());
    for (const TimelinePoint& point : seen) {
      TimelinePoint& into = expected.at(static_cast<std::size_t>(point.begin_s / timeline.step_s()));
      into.state = graver(into.state, point.state);
      into.indicator = std::fmax(into.indicator, point.indicator);
      into.low_rpm = std::fmin(into.low_rpm, point.low_rpm);
      into.high_rpm = std::fmax(into.high_rpm, point.high_rpm);
    }
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const TimelinePoint& point = timeline.points()[i];
      ASSERT_DOUBLE_EQ(point.begin_s, static_cast<double>(i) * timeline.step_s());
      ASSERT_EQ(point.state, expected[i].state) << i;
      ASSERT_TRUE(point.indicator == expected[i].indicator ||
                  (std::isnan(point.indicator) && std::isnan(expected[i].indicator)));
      ASSERT_TRUE(point.low_rpm == expected[i].low_rpm || std::isnan(expected[i].low_rpm));
      ASSERT_TRUE(point.high_rpm == expected[i].high_rpm || std::isnan(expected[i].high_rpm));
    }
  }
}

TEST(Timeline, NothingIsGraverThanChatter) {
  for (int i = 0; i < kStates; ++i) {
    EXPECT_EQ(graver(State::chatter, static_cast<State>(i)), State::chatter);
    EXPECT_EQ(graver(static_cast<State>(i), State::chatter), State::chatter);
    EXPECT_EQ(graver(State::idle, static_cast<State>(i)), static_cast<State>(i));
  }
}

}  // namespace
}  // namespace stillcut
