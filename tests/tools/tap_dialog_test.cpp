// The guided tap test with written answers.
#include "tools/tap_dialog.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <sstream>
#include <stdexcept>

#include "tests/models/tapped_structure.hpp"
#include "tests/tools/tapped_cell.hpp"

namespace stillcut {
namespace {

using testing::HasSubstr;

constexpr double kDialogRate = 5120.0;

HeardTap sound_tap(double peak_n) {
  const std::vector<HammerPulse> pulses{{0.02, peak_n, 0.004}};
  return {tapped(home_modes(), 1, 1.0, pulses, 1.1, kDialogRate), peak_n, ""};
}

// Hands out what it has, in turn; counts how often the operator was asked afresh.
struct Script {
  std::deque<HeardTap> taps;
  int forgotten = 0;

  TapSource source() {
    return {[this] {
              if (taps.empty()) throw std::runtime_error("no more taps");
              HeardTap next = taps.front();
              taps.pop_front();
              return next;
            },
            [this] { ++forgotten; }};
  }
};

std::optional<TappedDirection> ask(Script& script, const std::string& answers, std::string& told, int hits = 3) {
  std::istringstream in(answers);
  std::ostringstream out;
  auto tapped = ask_for_taps({"12", {1, 1.0}, hits}, {}, script.source(), in, out);
  told = out.str();
  return tapped;
}

TEST(TapDialog, AsksAgainForEveryRefusedHitUntilAllAreSound) {
  Script script{{sound_tap(500),
                 {{}, 700, "double hit: let the hammer rebound freely"},
                 sound_tap(510),
                 {{}, 0, "frames were lost on the bus: hit again"},
                 {{}, 2000, "force overload: hit more softly"},
                 sound_tap(520)}};
  std::string told;
  const auto tapped = ask(script, "a\n", told);
  ASSERT_TRUE(tapped);
  EXPECT_EQ(tapped->recordings.size(), 3U);
  EXPECT_EQ(tapped->estimate.hits_used, 3U);
  EXPECT_EQ(script.forgotten, 1);
  EXPECT_FALSE(tapped->estimate.h1.receptance[0][1].empty());
  EXPECT_TRUE(tapped->estimate.h1.receptance[1][0].empty());
  EXPECT_THAT(told, HasSubstr("posture 12, hammer towards y: hit 3 times"));
  EXPECT_THAT(told, HasSubstr("hit 1 of 3: 500 N, sound\n  hit 2 of 3: 700 N, refused, double hit"));
  EXPECT_THAT(told, HasSubstr("hit 3 of 3: refused, frames were lost"));
  EXPECT_THAT(told, HasSubstr("hit 3 of 3: 2000 N, refused, force overload"));
  EXPECT_THAT(told, HasSubstr("coherence up to there: x 1.000"));
}

TEST(TapDialog, BeginsAnewWhereTheOperatorWantsToRepeat) {
  Script script{{sound_tap(500), sound_tap(510), sound_tap(600), sound_tap(610)}};
  std::string told;
  const auto tapped = ask(script, "what\nr\naccept\n", told, 2);
  ASSERT_TRUE(tapped);
  EXPECT_EQ(script.forgotten, 2);
  ASSERT_EQ(tapped->recordings.size(), 2U);
  EXPECT_EQ(tapped->estimate.hits.front().peak_n, std::ranges::max(sound_tap(600).recording.force));
}

TEST(TapDialog, GivesNothingWhereTheOperatorQuitsOrTheAnswersEnd) {
  for (const char* answers : {"q\n", "", "perhaps\n"}) {
    Script script{{sound_tap(500), sound_tap(510)}};
    std::string told;
    EXPECT_FALSE(ask(script, answers, told, 2)) << answers;
    EXPECT_TRUE(script.taps.empty());
  }
}

TEST(TapDialog, SaysThatOneHitHasNoCoherence) {
  Script script{{sound_tap(500)}};
  std::string told;
  ASSERT_TRUE(ask(script, "a\n", told, 1));
  EXPECT_THAT(told, HasSubstr("coherence is not known from one hit"));
}

}  // namespace
}  // namespace stillcut
