#include "dsp/slow_watch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace stillcut {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kGravity = 9.81;
constexpr double kDensity = 0.0095;  // of the noise: standard deviation over the root of the sample rate
constexpr double kSettled_s = 1.0;   // the noise is known
constexpr double kStep_s = 1.3;

// Evidence that a sudden start alone does not gather, though a window that fills shows a line that grows.
constexpr double kEnoughToCall = 1.0;

bool any_line(double) { return true; }

// Amplitude at which a line of one axis stands out of such noise.
double standing_out(double hz) { return 6.0 * kDensity * std::sqrt(hz); }

class Listener {
 public:
  Listener(int axes, double rate_hz, std::uint32_t seed = 1) : watch{axes, rate_hz}, axes_{axes}, rate_hz_{rate_hz} {
    random_.seed(seed);
  }

  // Hears signal(t, axis), noise and gravity on the last axis until `to_s`; each(t) after every step.
  template <typename Signal, typename Each>
  void hear(double to_s, Signal&& signal, Each&& each) {
    std::array<float, kMaxAxes> x{};
    for (; static_cast<double>(n_) < to_s * rate_hz_; ++n_) {
      const double t = static_cast<double>(n_) / rate_hz_;
      for (int a = 0; a < axes_; ++a) {
        const double noise = kDensity * std::sqrt(rate_hz_) * normal_(random_);
        x[a] = static_cast<float>(signal(t, a) + noise + (a == axes_ - 1 ? kGravity : 0.0));
      }
      if (watch.push({x.data(), static_cast<std::size_t>(axes_)})) each(t);
    }
  }

  template <typename Signal>
  double most_evidence(double to_s, Signal&& signal) {
    double most = 0.0;
    hear(to_s, signal, [&](double t) {
      if (t > kSettled_s) most = std::max(most, watch.best_line(any_line).evidence);
    });
    return most;
  }

  SlowWatch watch;

 private:
  int axes_;
  double rate_hz_;
  long n_ = 0;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

// A line on all axes that passes what stands out of the noise at `out_s`.
auto growing(double hz, double a_cycle, double out_s) {
  return [=](double t, int axis) {
    const double amplitude = std::min(30.0, standing_out(hz) * std::pow(a_cycle, hz * (t - out_s)));
    return amplitude * (axis == 0 ? 1.0 : 0.6) * std::sin(kTurn * hz * t + axis);
  };
}

struct Found {
  double cycles = 1e9;                // since the line stood out
  double hz = 0.0, settled_hz = 0.0;  // at once, and three cycles later
};

Found find(Listener& listener, double hz, double a_cycle, double out_s) {
  Found found;
  double at_s = 1e9;
  listener.hear(out_s + 30.0 / hz, growing(hz, a_cycle, out_s), [&](double t) {
    const SlowLine line = listener.watch.best_line(any_line);
    if (at_s > t && t > kSettled_s && line.evidence >= 1.0) {
      at_s = t;
      found = {(t - out_s) * hz, line.frequency_hz, 0.0};
    }
    if (t < at_s + 3.0 / hz) found.settled_hz = line.frequency_hz;
  });
  return found;
}

TEST(SlowWatch, HearsALineThatGrowsWithinAFewOfItsCycles) {
  for (const int axes : {1, 3}) {
    for (const double hz : {5.0, 8.0, 10.0, 13.0, 17.0, 20.0, 27.0, 40.0, 60.0}) {
      for (const double a_cycle : {1.1, 1.2, 1.4, 1.6}) {
        if (hz * std::log(a_cycle) < 1.1) continue;  // so slow a growth is a floor that rises
        Listener listener{axes, 1000.0};
        const Found found = find(listener, hz, a_cycle, 2.0);
        // Until it is thrice as large, eight times where many cycles must grow in a row, noise may hide that it grows.
        const double late = (hz > 20.0 ? 0.15 * hz : 2.5) + std::log(hz > 20.0 ? 8.0 : 3.0) / std::log(a_cycle);
        EXPECT_LT(found.cycles, late) << hz << " Hz, " << a_cycle << ", axes " << axes;
        EXPECT_GT(found.cycles, -std::log(8.0) / std::log(a_cycle)) << hz << " Hz, " << a_cycle << ", axes " << axes;
      }
    }
  }
}

TEST(SlowWatch, HearsALineThatTakesSecondsToGrow) {
  for (const double hz : {8.0, 16.0, 20.0}) {
    Listener listener{3, 1000.0};
    const double a_cycle = std::exp(0.5 / hz), out_s = 6.0;  // by e in 2 s
    double at_s = 0.0;
    listener.hear(out_s + 6.0, growing(hz, a_cycle, out_s), [&](double t) {
      const SlowLine line = listener.watch.best_line(any_line);
      if (at_s == 0.0 && t > kSettled_s && line.evidence >= kEnoughToCall) at_s = t;
    });
    EXPECT_GT(at_s, out_s - 2.0) << hz;
  }
}

TEST(SlowWatch, TellsTheFrequencyWithinAHertz) {
  int lines = 0, at_once = 0;
  for (const double hz : {8.0, 10.3, 13.0, 16.1, 20.0}) {
    for (std::uint32_t seed = 1; seed <= 8; ++seed) {
      Listener listener{3, 1000.0, seed};
      const double a_cycle = 1.15 + 0.05 * (seed % 10);
      const Found found = find(listener, hz, a_cycle, 1.8 + 0.013 * seed);
      ++lines;
      at_once += std::abs(found.hz - hz) < 1.0 ? 1 : 0;
      EXPECT_NEAR(found.hz, hz, 0.1 * hz) << "seed " << seed;
      EXPECT_NEAR(found.settled_hz, hz, 1.0) << "seed " << seed;
    }
  }
  EXPECT_GE(at_once, lines * 9 / 10);
}

TEST(SlowWatch, HearsTheSameAtEverySampleRate) {
  for (const double rate_hz : {500.0, 10000.0, 25600.0, 50000.0}) {
    Listener listener{1, rate_hz};
    const Found found = find(listener, 12.0, 1.3, 2.0);
    EXPECT_LT(found.cycles, 5.0) << rate_hz;
    EXPECT_NEAR(found.settled_hz, 12.0, 0.5) << rate_hz;
  }
}

TEST(SlowWatch, LeavesAModeThatRingsDownAlone) {
  for (const int axes : {1, 3}) {
    for (const double hz : {5.0, 8.0, 10.0, 13.0, 17.0, 20.0, 27.0, 40.0, 60.0}) {
      for (const double a_cycle : {0.6, 0.75, 0.85, 0.93, 0.97}) {
        for (const double phase : {0.0, 1.6}) {
          Listener listener{axes, 1000.0};
          const auto step = [&](double t, int axis) {
            const double since = t - kStep_s;
            if (since < 0.0) return 0.0;
            const double ringing = 5.0 * std::pow(a_cycle, hz * since) * std::sin(kTurn * hz * since + phase);
            return 0.3 + (axis == 0 ? 1.0 : 0.6) * ringing;
          };
          EXPECT_LT(listener.most_evidence(kStep_s + 8.0 / hz, step), kEnoughToCall)
              << hz << " Hz, " << a_cycle << ", axes " << axes;
        }
      }
    }
  }
}

// Each mode moves the robot in a direction of its own, neither that of an axis.
TEST(SlowWatch, LeavesTwoModesThatBeatWhileTheyRingDownAlone) {
  for (const double hz : {8.0, 10.0, 13.0, 17.0}) {
    for (const double apart : {1.05, 1.1, 1.2, 1.3}) {
      for (const double a_cycle : {0.7, 0.85, 0.93, 0.97}) {
        const auto ringing = [&](double t, double at_hz) {
          const double cycles = at_hz * (t - kStep_s);
          return cycles < 0.0 ? 0.0 : 5.0 * std::pow(a_cycle, cycles) * std::sin(kTurn * cycles);
        };
        const auto both = [&](double t, int axis) {
          const double one = ringing(t, hz), other = ringing(t, apart * hz);
          return std::numbers::sqrt2 / 2.0 * (axis == 0 ? one - other : one + other);
        };
        Listener listener{2, 1000.0};
        EXPECT_LT(listener.most_evidence(kStep_s + 1.5, both), kEnoughToCall)
            << hz << " Hz and " << apart << " times that, " << a_cycle;
      }
    }
  }
}

TEST(SlowWatch, TakesNoiseForNothing) {
  for (const int axes : {1, 2, 3}) {
    Listener listener{axes, 500.0};
    EXPECT_LT(listener.most_evidence(120.0, [](double, int) { return 0.0; }), 1.0) << axes;
  }
}

TEST(SlowWatch, HearsNothingSlowInATonePastTheThinnedRate) {
  for (const double rate_hz : {10000.0, 25600.0, 50000.0}) {
    const double thinned_hz = rate_hz / std::lround(rate_hz / 500.0);
    for (const int multiple : {1, 2, 3}) {
      for (const double off_hz : {12.0, -12.0}) {
        Listener listener{1, rate_hz};
        double largest = 0.0, evidence = 0.0;
        const auto tone = [&](double t, int) {
          const double amplitude = std::min(100.0, std::exp(9.0 * (t - 1.0)));
          return amplitude * std::sin(kTurn * (multiple * thinned_hz + off_hz) * t);
        };
        listener.hear(2.0, tone, [&](double t) {
          if (t > kSettled_s) evidence = std::max(evidence, listener.watch.best_line(any_line).evidence);
          if (t > 1.8) largest = std::max(largest, listener.watch.line_at(12.0).amplitude);
        });
        EXPECT_LT(largest, 100.0 * 1e-3) << rate_hz << " Hz, " << multiple;
        EXPECT_LT(evidence, 1.0) << rate_hz << " Hz, " << multiple;
      }
    }
  }
}

TEST(SlowWatch, ForgetsWhatItHeardAtAGapAndHearsItAgain) {
  Listener listener{3, 1000.0};
  EXPECT_LT(find(listener, 12.0, 1.3, 2.0).cycles, 10.0);
  EXPECT_GE(listener.watch.line_at(12.0).amplitude, 10.0);
  listener.watch.clear();
  EXPECT_EQ(listener.watch.best_line(any_line).evidence, 0.0);
  // Until its window is full again of what came after the gap a frequency is silent.
  const double gap_s = 2.0 + 30.0 / 12.0;
  listener.hear(
      gap_s + 0.14, [](double, int) { return 0.0; },
      [&](double) { EXPECT_EQ(listener.watch.line_at(12.0).amplitude, 0.0); });
  double most = 0.0;
  listener.hear(
      gap_s + 2.5, [](double, int) { return 0.0; },
      [&](double t) {
        if (t > gap_s + 0.5) most = std::max(most, listener.watch.best_line(any_line).evidence);
      });
  EXPECT_LT(most, 1.0);
  EXPECT_LT(find(listener, 12.0, 1.3, gap_s + 4.0).cycles, 10.0);
}

TEST(SlowWatch, ForgetsEvidenceWhenToldTo) {
  Listener listener{3, 1000.0};
  find(listener, 12.0, 1.3, 2.0);
  listener.watch.forget_evidence();
  EXPECT_EQ(listener.watch.best_line(any_line).evidence, 0.0);
}

TEST(SlowWatch, GivesOnlyLinesThatAreAllowed) {
  Listener listener{3, 1000.0};
  double most = 0.0;
  listener.hear(4.0, growing(12.0, 1.3, 2.5), [&](double t) {
    if (t > kSettled_s) most = std::max(most, listener.watch.best_line([](double hz) { return hz > 30.0; }).evidence);
  });
  EXPECT_LT(most, 1.0);
}

}  // namespace
}  // namespace stillcut
