// Active mode and the controller's answers: silence, none, a refusal, an answer to something else.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "dsp/numbers.hpp"
#include "rt/compensator.hpp"
#include "tests/rt/compensator_bench.hpp"

namespace stillcut {
namespace {

TEST(Compensator, ActiveAsksNothingOfASilentController) {
  Bench bench{RuntimeMode::active};
  bench.run(1.0, chattering(0));
  ASSERT_EQ(bench.corrections.size(), 1U);
  EXPECT_EQ(bench.corrections[0].kind, CorrectionKind::release);
  bench.in.controller_alive = true;
  bench.run_acknowledged(0.3, chattering(0));
  EXPECT_TRUE(bench.compensator().correcting());
  bench.in.controller_alive = false;
  bench.run(0.3, chattering(0));
  EXPECT_FALSE(bench.compensator().correcting());
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::release);
}

TEST(Compensator, ActiveGivesUpAfterASecondWithoutAnAnswer) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  bench.run(3.0, chattering(0));
  EXPECT_FALSE(bench.compensator().correcting());
  EXPECT_EQ(bench.releases(), 1);  // and then nothing more in this episode
  EXPECT_LE(bench.corrections.back().stamp_ns - bench.corrections.front().stamp_ns, kSecond + 4 * kMillisecond);
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::release);
  const std::size_t before = bench.corrections.size();
  bench.run(2.1, quiet(0));
  bench.run(0.1, chattering(0));  // a new episode is a new question
  EXPECT_GT(bench.corrections.size(), before);
}

// A controller that takes only some kinds, and says why not the others; its spindle follows what it has taken.
void run_at_controller(Bench& bench, double seconds, const std::vector<CorrectionKind>& takes, bool chatter = true) {
  double speed_rpm = 9000.0;
  for (int i = 0; i < static_cast<int>(seconds / 0.002); ++i) {
    const std::size_t before = bench.corrections.size();
    bench.step(chatter ? chattering(0, 738.0, speed_rpm) : quiet(0, State::cut, speed_rpm));
    if (bench.corrections.size() == before) continue;
    const Correction& c = bench.corrections.back();
    const bool taken = std::find(takes.begin(), takes.end(), c.kind) != takes.end();
    bench.acknowledge(taken, taken ? "" : "carries no such thing");
    if (taken) speed_rpm = c.spindle_speed_rpm;
  }
}

TEST(Compensator, ARefusedSpeedIsLeftOutAndTheNextIsAskedFor) {
  using Kind = CorrectionKind;
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  run_at_controller(bench, 1.0, {Kind::feed_override, Kind::stop_request});
  EXPECT_EQ(asked_for(bench), (std::vector<Kind>{Kind::spindle_speed, Kind::speed_variation, Kind::feed_override}));
  EXPECT_EQ(bench.releases(), 0);
  // Nothing has moved: what comes next starts where the spindle is, not where it was to go.
  for (const Correction& c : bench.corrections) {
    if (c.kind == Kind::feed_override) {
      EXPECT_NEAR(c.spindle_speed_rpm, 9000.0, 1e-6);
    }
  }
  std::vector<std::string> refusals;
  for (const Event& event : bench.events)
    if (std::isnan(event.spindle_speed_rpm)) refusals.emplace_back(event.note.data());
  EXPECT_EQ(refusals, (std::vector<std::string>{"spindle speed refused: carries no such thing",
                                                "speed variation refused: carries no such thing"}));
}

TEST(Compensator, WhatAControllerCannotDoIsAskedAgainOnlyOfOneThatIsHeardAnew) {
  using Kind = CorrectionKind;
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  const auto next_cut = [&] {
    bench.run_acknowledged(1.5, quiet(0, State::air));
    bench.corrections.clear();
    run_at_controller(bench, 0.5, {Kind::feed_override, Kind::stop_request});
    return asked_for(bench);
  };
  run_at_controller(bench, 0.5, {Kind::feed_override, Kind::stop_request});
  EXPECT_EQ(next_cut(), (std::vector<Kind>{Kind::feed_override}));
  bench.in.controller_alive = false;
  bench.run(0.1, quiet(0));
  bench.in.controller_alive = true;
  EXPECT_EQ(next_cut().front(), Kind::spindle_speed);
}

// On the way back to the program less feed is still a feed, which is all that this controller takes.
TEST(Compensator, LessFeedGoesBackAsAFeed) {
  using Kind = CorrectionKind;
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  const LobeDiagram lobes = diagram_of(std::vector<double>(61, 0.9), spindle_6000_to_12000());
  bench.in.lobes = &lobes;
  run_at_controller(bench, 1.0, {Kind::feed_override, Kind::stop_request});
  ASSERT_EQ(bench.corrections.back().kind, Kind::feed_override);
  bench.in.axial_depth = 0.5e-3;
  run_at_controller(bench, 15.0, {Kind::feed_override, Kind::stop_request}, false);
  EXPECT_STREQ(bench.corrections.back().reason.data(), "back at the program");
  EXPECT_EQ(bench.releases(), 1);
}

// It is locked rather than unable.
TEST(Compensator, AControllerThatRefusesEverythingIsLeftAloneUntilTheNextCut) {
  using Kind = CorrectionKind;
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  run_at_controller(bench, 5.0, {});
  EXPECT_EQ(asked_for(bench), (std::vector<Kind>{Kind::spindle_speed, Kind::speed_variation, Kind::feed_override,
                                                 Kind::stop_request, Kind::release}));
  EXPECT_STREQ(bench.corrections.back().reason.data(), "the controller does not stop: carries no such thing");
  run_at_controller(bench, 1.0, {}, false);
  bench.run(1.5, quiet(0, State::air));
  bench.corrections.clear();
  bench.run_acknowledged(0.1, chattering(0));
  EXPECT_EQ(bench.corrections.back().kind, Kind::spindle_speed);
}

TEST(Compensator, WhatIsRefusedLaterIsReleasedWhereNothingIsHeard) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  bench.run_acknowledged(0.5, chattering(0));
  bench.run_acknowledged(1.0, quiet(0));
  ASSERT_TRUE(bench.compensator().correcting());
  bench.acknowledge(false, "the operator has the override");
  bench.run(0.1, quiet(0));
  EXPECT_FALSE(bench.compensator().correcting());
  EXPECT_STREQ(bench.corrections.back().reason.data(), "the controller refuses: the operator has the override");
}

TEST(Compensator, AnswersToOtherMessagesCountForNothing) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  bench.run_acknowledged(0.2, chattering(0));
  bench.run_acknowledged(1.1, quiet(0, State::air));
  bench.run_acknowledged(0.1, chattering(0));
  ASSERT_TRUE(bench.compensator().correcting());
  const std::int64_t newest = bench.corrections.back().sequence;
  for (const std::int64_t sequence : {std::int64_t{-1}, std::int64_t{0}, std::int64_t{1}, newest + 1}) {
    bench.compensator().acknowledge({bench.now_ns, sequence, false, 0.0, 1.0});
  }
  bench.run_acknowledged(0.1, chattering(0));
  EXPECT_TRUE(bench.compensator().correcting());
  for (int i = 0; i < 1000; ++i) {  // accepting what was asked before the last release is no answer either
    bench.step(chattering(0));
    bench.compensator().acknowledge({bench.now_ns, 1, true, 0.0, 1.0});
  }
  EXPECT_FALSE(bench.compensator().correcting());
}

TEST(Compensator, WhatTheControllerCannotDoIsSkipped) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  double speed_rpm = 9000.0;
  for (int i = 0; i < 10000; ++i) {
    bench.step(chattering(0, 738.0, speed_rpm));
    if (bench.corrections.empty()) continue;
    const Correction& c = bench.corrections.back();
    bench.acknowledge(c.kind == CorrectionKind::spindle_speed || c.kind == CorrectionKind::stop_request);
    if (c.kind == CorrectionKind::spindle_speed) speed_rpm = c.spindle_speed_rpm;
  }
  using Kind = CorrectionKind;
  EXPECT_EQ(asked_for(bench), (std::vector<Kind>{Kind::spindle_speed, Kind::spindle_speed, Kind::speed_variation,
                                                 Kind::feed_override, Kind::stop_request}));
  EXPECT_EQ(bench.releases(), 0);
}

}  // namespace
}  // namespace stillcut
