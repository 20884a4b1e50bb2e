// Cuts without chatter: whatever happens in them, the monitor must not call it chatter.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/dsp/synthetic_cut.hpp"

namespace stillcut {
namespace {

struct Sensor {
  double rate_hz;
  int axes;
};

class QuietCut : public testing::TestWithParam<Sensor> {
 protected:
  static constexpr unsigned kSeeds = 3;

  void SetUp() override {
    cut_.rate_hz = GetParam().rate_hz;
    cut_.axes = GetParam().axes;
  }

  // Plays the cut for every seed; expects no chatter, no fault, and so many entries and exits.
  void expect_quiet(std::size_t entries = 1, std::size_t exits = 0) {
    for (cut_.seed = 1; cut_.seed <= kSeeds; ++cut_.seed) {
      const auto events = play(cut_);
      for (const Event& event : only(events, EventType::chatter_onset)) {
        ADD_FAILURE() << "seed " << cut_.seed << ": chatter at " << seconds(event) << " s, " << event.frequency_hz
                      << " Hz";
      }
      EXPECT_EQ(only(events, EventType::fault).size(), 0U);
      EXPECT_EQ(only(events, EventType::cut_entry).size(), entries);
      EXPECT_EQ(only(events, EventType::cut_exit).size(), exits);
    }
  }

  SyntheticCut cut_;
};

TEST_P(QuietCut, Steady) { expect_quiet(); }

TEST_P(QuietCut, SteadyAtOtherSpeedsAndTeeth) {
  cut_.teeth = 3;
  cut_.speed_rpm = [](double) { return 3330.0; };
  expect_quiet();
  cut_.teeth = 4;
  cut_.speed_rpm = [](double) { return 18000.0; };
  expect_quiet();
}

TEST_P(QuietCut, StrongRunoutAndLittleNoise) {
  cut_.runout = 1.0;
  cut_.noise = 0.05;
  expect_quiet();
}

TEST_P(QuietCut, EntriesAndExits) {
  cut_.duration_s = 4.0;
  cut_.depth = [](double t) { return (t > 0.6 && t < 1.6) || (t > 2.2 && t < 3.4) ? 1.0 : 0.0; };
  expect_quiet(2, 2);
}

TEST_P(QuietCut, SlowEntryAndExit) {
  cut_.depth = [](double t) { return std::clamp(std::min((t - 0.5) / 0.15, (2.55 - t) / 0.15), 0.0, 1.0); };
  expect_quiet(1, 1);
}

TEST_P(QuietCut, Knocks) {
  cut_.knocks_s = {1.0, 1.31, 1.7, 1.75, 2.3};
  for (const double knock : {5.0, 20.0}) {
    cut_.knock = knock;
    expect_quiet();
  }
}

TEST_P(QuietCut, DepthSteps) {
  cut_.duration_s = 4.0;
  cut_.depth = [](double t) { return t < 0.5 ? 0.0 : t < 1.5 ? 1.0 : t < 2.2 ? 1.5 : t < 3.0 ? 0.75 : 1.0; };
  expect_quiet();
}

TEST_P(QuietCut, SpeedRampsWithJitteredSpeedMessages) {
  cut_.duration_s = 4.0;
  cut_.speed_rpm = [](double t) {
    return t < 1.0 ? 5000.0 : t < 2.5 ? 4000.0 + 1000.0 * t : t < 3.5 ? 9000.0 - 1000.0 * t : 5500.0;
  };
  expect_quiet();
  cut_.speed_jitter_s = 0.005;
  expect_quiet();
  cut_.speed_period_s = 0.05;
  expect_quiet();
}

TEST_P(QuietCut, GapsBetweenSpeedMessages) {
  cut_.speed_jitter_s = 0.005;
  cut_.speed_is_sent = [](double t) { return std::fmod(t, 0.4) > 0.05; };
  expect_quiet();
}

TEST_P(QuietCut, SpeedStepsOfAFifth) {
  cut_.duration_s = 2.5;
  for (const double lag_s : {0.05, 0.2}) {
    for (const double step : {-1200.0, 1200.0}) {
      cut_.speed_rpm = [=](double t) {
        return t < 1.2 ? 6000.0 : 6000.0 + step * (1.0 - std::exp(-(t - 1.2) / lag_s));
      };
      expect_quiet();
    }
  }
}

TEST_P(QuietCut, SpeedThatWandersOrIsToldATenthOfAPercentWrong) {
  cut_.speed_rpm = [](double t) { return 6000.0 + 20.0 * std::sin(8.2 * t); };
  expect_quiet();
  cut_.speed_rpm = [](double) { return 6000.0; };
  cut_.speed_told = [](double, double speed) { return 1.001 * speed; };
  expect_quiet();
}

TEST_P(QuietCut, ASpindleThatRunsUp) {
  cut_.speed_rpm = [](double t) { return std::min(6000.0, 12000.0 * t); };
  cut_.depth = [](double t) { return t > 1.2 ? 1.0 : 0.0; };
  expect_quiet();
}

INSTANTIATE_TEST_SUITE_P(Sensors, QuietCut, testing::Values(Sensor{10000.0, 1}, Sensor{25600.0, 3}, Sensor{50000.0, 1}),
                         [](const auto& info) {
                           return std::to_string(static_cast<int>(info.param.rate_hz)) + "Hz" +
                                  std::to_string(info.param.axes);
                         });

}  // namespace
}  // namespace stillcut
