// Compensator and EGM adapter in closed loop: what the one asks for and the other cannot do.
#include <gtest/gtest.h>

#include <vector>

#include "adapters/egm_packets.hpp"
#include "tests/adapters/follower_cell.hpp"
#include "tests/rt/compensator_bench.hpp"

namespace stillcut {
namespace {

// With path correction there are no speeds, no feed and no stop, but a direction.
TEST(EgmCompensated, PathCorrectionIsAskedForADirectionOnceItHasRefusedTheSpeeds) {
  FollowerSettings egm = any_controller();
  egm.refusals = egm_refusals(EgmAnswer::path);
  FollowerCell cell{egm};
  LobeDiagram lobes = diagram_of(std::vector<double>(61, 0.5), spindle_6000_to_12000());
  for (std::size_t i = 48; i < 56; ++i) lobes.points[i].depth_limit = 4e-3;  // about 11070 rpm
  lobes.direction_count = 24;
  lobes.direction_speed = rpm_to_rad_s(9000);
  for (std::size_t i = 0; i < 24; ++i)
    lobes.directions[i] = {deg_to_rad(7.5 * static_cast<double>(i)), i == 0 ? 0.5e-3 : 4e-3};
  CompensationLimits limits{.spindle = spindle_6000_to_12000(), .spindle_time_constant_s = 0.05};
  limits.free_turn = deg_to_rad(10);
  Bench bench{{RuntimeMode::active, 2, limits}};
  bench.in.controller_alive = true;
  bench.in.lobes = &lobes;
  std::vector<bool> accepted;
  for (int i = 0; i < 150; ++i) {
    const std::size_t before = bench.corrections.size();
    bench.step(chattering(0));
    if (i % 2 == 0) cell.run(1);
    if (bench.corrections.size() == before) continue;
    Correction c = bench.corrections.back();
    c.stamp_ns = cell.now_ns;
    const auto answer = cell.say(c);
    ASSERT_TRUE(answer);
    accepted.push_back(answer->ack.accepted);
    bench.acknowledge(answer->ack.accepted, answer->reason.data());
  }
  EXPECT_EQ(accepted.front(), false);
  EXPECT_EQ(accepted.back(), true);
  EXPECT_EQ(bench.releases(), 0);
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::feed_direction);
  EXPECT_NE(cell.setpoint.path_offset, 0.0);
  EXPECT_EQ(cell.setpoint.spindle_change_rpm, 0.0);
}

}  // namespace
}  // namespace stillcut
