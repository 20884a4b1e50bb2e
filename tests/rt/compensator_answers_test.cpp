// Active mode and the controller's answers: silence, none, a refusal, an answer to something else.
#include <gtest/gtest.h>

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

TEST(Compensator, ActiveRefusedStaysQuietUntilTheEpisodeEnds) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  bench.run_acknowledged(0.1, chattering(0));
  bench.acknowledge(false);
  bench.run(5.0, chattering(0));
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::release);
  EXPECT_EQ(bench.releases(), 1);
  bench.run(2.1, quiet(0));
  bench.run_acknowledged(0.1, chattering(0));
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::spindle_speed);
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
