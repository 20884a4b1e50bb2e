// What no mode may ever do.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "dsp/integrity.hpp"
#include "dsp/numbers.hpp"
#include "rt/compensator.hpp"
#include "tests/rt/compensator_bench.hpp"

namespace stillcut {
namespace {

// Whatever comes in - speeds that jump, frequencies that are no numbers, lobes that come and go, doubts that flicker,
// controllers that answer nonsense - nothing unsafe goes out.
TEST(Compensator, NothingUnsafeIsEverPublished) {
  const SpindleLimits spindle = spindle_6000_to_12000();
  const double min_rpm = rad_s_to_rpm(spindle.min_speed), max_rpm = rad_s_to_rpm(spindle.max_speed);
  std::int64_t asked = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    std::mt19937_64 random{seed};
    std::uniform_real_distribution<double> chance(0.0, 1.0);
    Bench bench{seed % 2 == 0 ? RuntimeMode::shadow : RuntimeMode::active};
    std::vector<double> limits_mm(61);
    MonitorView view = chattering(0);
    LobeDiagram diagram;
    std::int64_t sequence = 0;
    for (int i = 0; i < 1500; ++i) {
      if (chance(random) < 0.01) {
        for (double& limit : limits_mm) limit = chance(random) < 0.05 ? kNaN : 2.0 * chance(random);
        diagram = diagram_of(limits_mm, spindle);
        // Without predicted frequencies the lobes stay where they are, whatever is heard.
        for (LobePoint& point : diagram.points) point.chatter_frequency_hz = kNaN;
        bench.in.lobes = chance(random) < 0.3 ? nullptr : &diagram;
      }
      if (chance(random) < 0.01) {
        const double pick = chance(random);
        view.speed = pick < 0.1 ? kNaN : pick < 0.2 ? 0.0 : pick < 0.3 ? -100.0 : rpm_to_rad_s(20000 * chance(random));
      }
      if (chance(random) < 0.02) view.chatter = chance(random) < 0.7;
      if (chance(random) < 0.02) view.state = static_cast<State>(8 * chance(random));
      if (chance(random) < 0.02) view.kind = static_cast<ChatterKind>(3 * chance(random));
      if (chance(random) < 0.02) view.indicator = chance(random) < 0.1 ? kNaN : 4.0 * chance(random);
      if (chance(random) < 0.02) {
        view.chatter_frequency_hz = chance(random) < 0.1 ? kNaN : std::pow(10.0, 4.0 * chance(random));
      }
      view.doubts = chance(random) < 0.02 ? 1U << static_cast<int>(7 * chance(random)) : 0U;
      bench.in.axial_depth = chance(random) < 0.1 ? kNaN : 1e-3;
      bench.in.nominal_speed = chance(random) < 0.1 ? kNaN : rpm_to_rad_s(15000 * chance(random));
      bench.in.controller_alive = chance(random) < 0.99;

      const std::size_t before = bench.corrections.size();
      const std::size_t events_before = bench.events.size();
      bench.step(view);
      if (chance(random) < 0.5) bench.acknowledge(chance(random) < 0.99);
      // Every new target is announced by an event; only then is it chosen with what is known now.
      bool chosen_now = false;
      for (std::size_t e = events_before; e < bench.events.size(); ++e) {
        chosen_now = chosen_now || !std::isnan(bench.events[e].spindle_speed_rpm);
      }
      for (std::size_t c = before; c < bench.corrections.size(); ++c) {
        const Correction& said = bench.corrections[c];
        ASSERT_EQ(said.sequence, ++sequence);
        ASSERT_GT(said.valid_for_ms, 0);
        if (said.kind == CorrectionKind::release) {
          ASSERT_EQ(said.feed_override, 1.0);
          continue;
        }
        ++asked;
        // A stop once asked for is not taken back because the monitor goes deaf.
        ASSERT_TRUE(view.doubts == kNoDoubt || view.doubts == kSaturated || said.kind == CorrectionKind::stop_request);
        ASSERT_TRUE(seed % 2 == 0 || bench.in.controller_alive);
        ASSERT_GE(said.spindle_speed_rpm, min_rpm * (1.0 - 1e-12));
        ASSERT_LE(said.spindle_speed_rpm, max_rpm * (1.0 + 1e-12));
        ASSERT_GE(said.spindle_speed_target_rpm, min_rpm * (1.0 - 1e-12));
        ASSERT_LE(said.spindle_speed_target_rpm, max_rpm * (1.0 + 1e-12));
        if (said.kind == CorrectionKind::stop_request) {
          ASSERT_TRUE(said.feed_override >= 0.0 && said.feed_override <= 2.0) << said.feed_override;
        } else {
          ASSERT_TRUE(said.feed_override >= 0.5 && said.feed_override <= 2.0) << said.feed_override;
        }
        ASSERT_FALSE(said.predicted_margin_after < said.predicted_margin_before);
        if (chosen_now && said.kind == CorrectionKind::spindle_speed && bench.in.lobes != nullptr) {
          const double target = rpm_to_rad_s(said.spindle_speed_target_rpm);
          ASSERT_FALSE(margin_at(diagram, target, bench.in.axial_depth) <
                       margin_at(diagram, view.speed, bench.in.axial_depth));
        }
      }
    }
  }
  EXPECT_GT(asked, 1000);
}

}  // namespace
}  // namespace stillcut
