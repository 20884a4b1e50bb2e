#include "rt/direction_choice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "dsp/numbers.hpp"
#include "tests/rt/choice_cases.hpp"
#include "tests/rt/monitor_script.hpp"

namespace stillcut {
namespace {

constexpr double kDirectionStep = 5.0;  // degrees, in which directions are looked at

LobeDiagram diagram_over_directions(const std::vector<double>& limits_mm, double speed) {
  LobeDiagram d;
  d.valid = true;
  d.direction_count = static_cast<int>(limits_mm.size());
  d.direction_speed = speed;
  for (std::size_t i = 0; i < limits_mm.size(); ++i) {
    d.directions[i] = {std::numbers::pi * static_cast<double>(i) / static_cast<double>(limits_mm.size()),
                       limits_mm[i] * 1e-3};
  }
  return d;
}

TEST(DepthLimitTowards, IsTheSmallerOfTheTwoBesideItAndTheSameTheOtherWayRound) {
  ChoiceCases cases{11};
  for (int i = 0; i < 5000; ++i) {
    std::vector<double> limits(static_cast<std::size_t>(cases.whole(1, LobeDiagram::kMaxDirections)));
    for (double& limit : limits) limit = cases.between(0.1, 5.0);
    const LobeDiagram d = diagram_over_directions(limits, 1000.0);
    const auto below = static_cast<std::size_t>(cases.whole(0, d.direction_count - 1));
    const double spacing = std::numbers::pi / d.direction_count, share = cases.between(0.01, 0.99);
    const double direction = spacing * (static_cast<double>(below) + share);
    const double wanted = std::min(limits[below], limits[(below + 1) % limits.size()]) * 1e-3;
    for (int half_turns = -5; half_turns <= 5; ++half_turns)
      EXPECT_EQ(depth_limit_towards(d, direction + std::numbers::pi * half_turns), wanted);
  }
}

TEST(DepthLimitTowards, AtADirectionThatIsKnownItsOwnLimitHoldsAlsoWithRounding) {
  std::vector<double> limits;
  for (int i = 0; i < 24; ++i) limits.push_back(1.0 + i % 2);
  for (const double first : {0.0, 0.1, -1.0}) {
    LobeDiagram d = diagram_over_directions(limits, 1000.0);
    for (DirectionLimit& limit : d.directions) limit.direction += first;
    for (int half_turns = -5; half_turns <= 5; ++half_turns)
      for (std::size_t i = 0; i < 24; ++i) {
        const double direction = d.directions[i].direction + std::numbers::pi * half_turns;
        EXPECT_EQ(depth_limit_towards(d, direction), limits[i] * 1e-3) << i << ' ' << half_turns;
      }
  }
}

TEST(DepthLimitTowards, UnknownIsNaNAndUnstableAtEveryDepthIsNone) {
  LobeDiagram d = diagram_over_directions({1, 2, 3}, 1000.0);
  for (const double bad : {kNaN, kInfinity, -kInfinity}) EXPECT_TRUE(std::isnan(depth_limit_towards(d, bad)));
  d.directions[1].depth_limit = kNaN;
  EXPECT_EQ(depth_limit_towards(d, d.directions[1].direction), 0.0);
  EXPECT_EQ(depth_limit_towards(d, 0.1), 0.0);
  for (const int count : {0, -1, LobeDiagram::kMaxDirections + 1}) {
    d.direction_count = count;
    EXPECT_TRUE(std::isnan(depth_limit_towards(d, 0.1)));
  }
  EXPECT_TRUE(std::isnan(depth_limit_towards({}, 0.1)));
}

struct TurnCase {
  LobeDiagram lobes;
  CompensationLimits limits;
  DirectionQuestion question;
};

TurnCase random_turn(ChoiceCases& cases) {
  TurnCase c;
  c.limits = cases.limits();
  c.limits.free_turn = cases.between(0.0, 2.0);
  c.lobes = cases.diagram(c.limits.spindle);
  c.question.speed = c.lobes.direction_speed * (cases.chance(0.8) ? 1.0 : cases.between(0.95, 1.05));
  c.question.axial_depth = cases.chance(0.1) ? kNaN : 1e-3;
  c.question.programmed_direction = cases.between(-4.0, 4.0);
  c.question.direction = c.question.programmed_direction;
  if (cases.chance(0.3)) c.question.direction += cases.between(-c.limits.free_turn, c.limits.free_turn);
  return c;
}

// Every direction that may be asked for, by the header's words.
std::vector<double> directions_in_reach(const TurnCase& c) {
  std::vector<double> list;
  for (int i = -100; i <= 100; ++i) {
    const double off = deg_to_rad(kDirectionStep * i);
    if (std::abs(off) <= c.limits.free_turn) list.push_back(c.question.programmed_direction + off);
  }
  return list;
}

TEST(DirectionChoice, IsTheNearestStableElseTheBestWithinTheFreedom) {
  ChoiceCases cases{12};
  int stable_chosen = 0, best_of_bad = 0, none = 0;
  for (int i = 0; i < 8000; ++i) {
    TurnCase c = random_turn(cases);
    c.question.lobes = &c.lobes;
    const DirectionQuestion& q = c.question;
    const auto margin = [&](double direction) { return depth_limit_towards(c.lobes, direction) / q.axial_depth - 1.0; };
    const double before = margin(q.direction);
    std::vector<double> better, stable;
    const bool for_this_speed = std::abs(q.speed / c.lobes.direction_speed - 1.0) < 0.0196;
    const bool for_another = std::abs(q.speed / c.lobes.direction_speed - 1.0) > 0.0204;
    if (!for_this_speed && !for_another) continue;
    if (for_this_speed)
      for (const double direction : directions_in_reach(c)) {
        if (std::abs(direction - q.direction) < 0.05 || !(margin(direction) > before + 0.1)) continue;
        better.push_back(direction);
        if ((margin(direction) + 1.0) * (1.0 - c.lobes.depth_scatter) > 1.0) stable.push_back(direction);
      }
    const DirectionChoice choice = choose_direction(q, c.limits);
    ASSERT_EQ(choice.found, !better.empty());
    if (!choice.found) {
      ++none;
      continue;
    }
    EXPECT_LE(std::abs(choice.direction - q.programmed_direction), c.limits.free_turn + 1e-9);
    EXPECT_EQ(choice.margin_before, before);
    EXPECT_EQ(choice.margin_after, margin(choice.direction));
    EXPECT_GT(choice.margin_after, before);
    EXPECT_EQ(choice.stable, !stable.empty());
    ++(choice.stable ? stable_chosen : best_of_bad);
    for (const double other : choice.stable ? stable : better) {
      if (choice.stable) {
        EXPECT_LE(std::abs(choice.direction - q.direction), std::abs(other - q.direction) + 1e-12);
      } else {
        EXPECT_GE(choice.margin_after, margin(other));
      }
    }
  }
  EXPECT_GT(stable_chosen, 500);
  EXPECT_GT(best_of_bad, 100);
  EXPECT_GT(none, 500);
}

TEST(DirectionChoice, TheEndOfTheFreedomBelongsToIt) {
  const double speed = rpm_to_rad_s(9000);
  for (std::size_t end = 1; end < 18; ++end) {  // only this one is stable
    std::vector<double> limits(18, 0.5);
    limits[end] = 2.0;
    const LobeDiagram d = diagram_over_directions(limits, speed);
    CompensationLimits free;
    free.free_turn = deg_to_rad(10.0 * static_cast<double>(end <= 9 ? end : 18 - end));
    const DirectionChoice choice = choose_direction({0.0, 0.0, speed, 1e-3, &d}, free);
    ASSERT_TRUE(choice.found) << end;
    EXPECT_TRUE(choice.stable);
    EXPECT_NEAR(std::abs(choice.direction), free.free_turn, 1e-9);
  }
}

// What the feed map plans is taken before a nearer direction, in the sense that the program has, where it is stable and
// free; otherwise it is as if there were no map.
TEST(DirectionChoice, ThePlannedDirectionGoesFirstWhereItIsStableAndFree) {
  const double speed = rpm_to_rad_s(9000);
  std::vector<double> limits(18, 2.0);
  limits[0] = 0.5;  // along X it chatters
  limits[7] = 0.6;
  LobeDiagram d = diagram_over_directions(limits, speed);
  CompensationLimits free;
  free.free_turn = deg_to_rad(80.0);
  const double program = deg_to_rad(180.0);
  const auto chosen = [&](double planned_deg) {
    d.planned_direction = deg_to_rad(planned_deg);
    return choose_direction({program, program, speed, 1e-3, &d}, free);
  };
  const DirectionChoice without = choose_direction({program, program, speed, 1e-3, &d}, free);
  for (const double planned : {40.0, 220.0, -140.0, 400.0}) {
    const DirectionChoice choice = chosen(planned);
    ASSERT_TRUE(choice.found && choice.stable) << planned;
    EXPECT_NEAR(rad_to_deg(choice.direction), 220.0, 1e-9) << planned;
    EXPECT_NEAR(choice.margin_after, 1.0, 1e-12);
  }
  for (const double unusable :
       {70.0, 90.0, 0.0, 2.0, static_cast<double>(kNaN)}) {  // unstable, not free, no turn, none
    EXPECT_EQ(chosen(unusable).direction, without.direction) << unusable;
  }
}

TEST(DirectionChoice, WithoutFreedomDepthOrLimitsThereIsNone) {
  const double speed = rpm_to_rad_s(9000);
  const LobeDiagram d = diagram_over_directions({0.5, 2, 2, 2, 2, 2}, speed), none = diagram_over_directions({}, speed);
  const LobeDiagram invalid;
  CompensationLimits free;
  free.free_turn = 1.0;
  const DirectionQuestion good{0.0, 0.0, speed, 1e-3, &d};
  ASSERT_TRUE(choose_direction(good, free).found);
  std::vector<DirectionQuestion> bad(9, good);
  bad[0].lobes = nullptr;
  bad[1].lobes = &none;
  bad[2].lobes = &invalid;
  bad[3].axial_depth = kNaN;
  bad[4].axial_depth = 0.0;
  bad[5].speed = kNaN;
  bad[6].speed = 1.03 * speed;
  bad[7].direction = kNaN;
  bad[8].programmed_direction = kNaN;
  for (std::size_t i = 0; i < bad.size(); ++i) EXPECT_FALSE(choose_direction(bad[i], free).found) << i;
  for (const double freedom : {0.0, -1.0, kNaN, 0.03}) {
    free.free_turn = freedom;
    EXPECT_FALSE(choose_direction(good, free).found) << freedom;
  }
}

}  // namespace
}  // namespace stillcut
