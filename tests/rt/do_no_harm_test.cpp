// Do no harm: whatever sensors, bus, robot, controller, lobes and clocks do, what is published stays inside its limits,
// moves to nothing predicted worse, carries its expiry, and ends in a release when its conditions fail. Random cuts
// through the whole core, with a controller that follows, answers, is deaf, refuses, or takes some kinds only.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "dsp/integrity.hpp"
#include "rt/core.hpp"
#include "tests/rt/core_script.hpp"
#include "tests/sanitized.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kControllerSilent_ns = 500 * kMillisecond, kUnanswered_ns = kSecond;
constexpr double kRounding = 1e-9;

CompensationLimits limits_for(std::mt19937_64& random) {
  std::uniform_real_distribution<double> chance{0.0, 1.0};
  CompensationLimits limits{.spindle = spindle_6000_to_12000(), .spindle_time_constant_s = 0.05 + 0.3 * chance(random)};
  if (chance(random) < 0.5) limits.avoided[limits.avoided_count++] = {rpm_to_rad_s(7000), rpm_to_rad_s(7300)};
  if (chance(random) < 0.5) limits.free_turn = 1.5 * chance(random);
  limits.feed_per_tooth = 5e-5;
  if (chance(random) < 0.3) limits.min_feed_per_tooth = 3e-5;
  if (chance(random) < 0.3) limits.max_feed_override = 1.0 + 0.3 * chance(random);
  if (chance(random) < 0.3) limits.max_variation = 0.3 * chance(random);
  limits.may_stop = chance(random) < 0.8;
  return limits;
}

LobeDiagram random_lobes(std::mt19937_64& random, std::int64_t now_ns) {
  std::uniform_real_distribution<double> chance{0.0, 1.0};
  std::vector<double> limits_mm(61);
  double held = 1.0;
  for (double& limit : limits_mm) {
    if (chance(random) < 0.2) held = 0.2 + 2.5 * chance(random);
    limit = chance(random) < 0.02 ? kNaN : chance(random) < 0.02 ? std::numeric_limits<double>::infinity() : held;
  }
  LobeDiagram diagram = diagram_of(limits_mm, spindle_6000_to_12000());
  for (LobePoint& point : diagram.points) point.chatter_frequency_hz = kNaN;  // so that the lobes stay where they are
  diagram.depth_scatter = 0.3 * chance(random);
  diagram.speed_scatter = 0.03 * chance(random);
  diagram.direction_count = 12;
  diagram.direction_speed = rpm_to_rad_s(9000);
  for (int i = 0; i < 12; ++i)
    diagram.directions[static_cast<std::size_t>(i)] = {std::numbers::pi * i / 12, 2e-3 * chance(random)};
  diagram.usable_from_ns = now_ns + static_cast<std::int64_t>(0.3e9 * chance(random));
  diagram.posture_stamp_ns = now_ns - static_cast<std::int64_t>(2e9 * chance(random) * chance(random));  // old at times
  diagram.ahead = chance(random) < 0.2;
  diagram.usable_until_ns = now_ns + static_cast<std::int64_t>(2e9 * chance(random));
  diagram.valid = chance(random) < 0.9;
  return diagram;
}

SyntheticCut random_cut(std::mt19937_64& random, bool faults) {
  std::uniform_real_distribution<double> chance{0.0, 1.0};
  SyntheticCut cut = chattering_cut();
  cut.seed = static_cast<std::uint32_t>(random());
  cut.chatter.frequency_hz = 300.0 + 1200.0 * chance(random);
  cut.chatter.start_s = 0.6 + 0.5 * chance(random);
  cut.chatter.stop_s = chance(random) < 0.5 ? 1.9 : 1e9;
  cut.duration_s = 4.0;
  cut.depth = [](double t) { return t > 0.4 && t < 3.5 ? 1.0 : 0.0; };
  if (!faults) return cut;
  const double from = 1.0 + 2.0 * chance(random), to = from + 0.5 * chance(random), kind = chance(random);
  const auto during = [from, to](double t) { return t > from && t < to; };
  if (kind < 0.2) {
    cut.spoil = [during](SampleBlock& block, double t) {
      if (during(t)) block.acceleration[0][3] = std::numeric_limits<float>::quiet_NaN();
    };
  } else if (kind < 0.35) {
    cut.spoil = [during](SampleBlock& block, double t) {
      if (during(t)) block.full_scale[0] = 0x3FF;
    };
  } else if (kind < 0.5) {
    cut.frame_is_sent = [during](double t) { return !during(t); };
  } else if (kind < 0.7) {  // the drive tells nonsense
    const double told = chance(random) < 0.3 ? kNaN : chance(random) < 0.5 ? -50.0 : 3000.0 * chance(random);
    cut.speed_told = [during, told](double t, double speed) { return during(t) ? told : speed; };
  } else if (kind < 0.8) {
    cut.speed_is_sent = [during](double t) { return !during(t); };
  } else if (kind < 0.9) {  // the speed jumps, and is told right
    const double other = 6000.0 + 6000.0 * chance(random);
    cut.speed_rpm = [during, other](double t) { return during(t) ? other : 9000.0; };
  }
  return cut;
}

// What holds of every message, alone and after the one before it.
class Judge {
 public:
  explicit Judge(const CompensationLimits& limits) : limits_{limits} {}

  void see(const Correction& c) {
    ASSERT_EQ(c.sequence, ++sequence_);
    ASSERT_GE(c.stamp_ns, before_.stamp_ns);
    ASSERT_GT(c.valid_for_ms, 0);
    ASSERT_LE(c.valid_for_ms, 1000);
    ASSERT_NE(c.reason[0], 0);
    if (c.kind == CorrectionKind::release) {
      ASSERT_EQ(c.feed_override, 1.0);
    } else {
      see_setting(c);
      if (before_.kind == c.kind) see_step(c);
    }
    before_ = c;
    in_force_ = c.kind != CorrectionKind::release;
  }
  [[nodiscard]] bool in_force() const { return in_force_; }
  [[nodiscard]] const Correction& last() const { return before_; }
  int asked = 0;

 private:
  void see_setting(const Correction& c) {
    ++asked;
    const double speed = rpm_to_rad_s(c.spindle_speed_rpm), target = rpm_to_rad_s(c.spindle_speed_target_rpm);
    const SpindleLimits& spindle = limits_.spindle;
    for (const double each : {speed * (1.0 - c.speed_variation_ratio), speed * (1.0 + c.speed_variation_ratio), target})
      ASSERT_TRUE(each >= spindle.min_speed * (1.0 - kRounding) && each <= spindle.max_speed * (1.0 + kRounding));
    const double least = c.kind == CorrectionKind::stop_request ? 0.0 : limits_.min_feed_override;
    ASSERT_TRUE(c.feed_override >= least && c.feed_override <= limits_.max_feed_override);
    ASSERT_LE(std::abs(c.feed_direction), limits_.free_turn + kRounding);
    ASSERT_TRUE(c.speed_variation_ratio >= 0.0 && c.speed_variation_ratio <= limits_.max_variation);
    const double swing = kTwoPi * c.speed_variation_hz;
    ASSERT_LE(speed * c.speed_variation_ratio * swing, spindle.acceleration * (1.0 + kRounding));
    ASSERT_FALSE(c.predicted_margin_after < c.predicted_margin_before);
    if (c.kind == CorrectionKind::spindle_speed) {
      ASSERT_TRUE(may_stay_at(limits_, target) || target == rpm_to_rad_s(9000));
    }
    ASSERT_TRUE(limits_.may_stop || c.kind != CorrectionKind::stop_request);
    ASSERT_TRUE(c.confidence_percent >= 0 && c.confidence_percent <= 100);
  }
  // Nothing jumps: from message to message no faster than the limits.
  void see_step(const Correction& c) {
    const double step_s = static_cast<double>(c.stamp_ns - before_.stamp_ns) * 1e-9;
    const double change = rpm_to_rad_s(std::abs(c.spindle_speed_rpm - before_.spindle_speed_rpm));
    ASSERT_LE(change, limits_.spindle.acceleration * step_s * (1.0 + kRounding) + 1e-6);
    ASSERT_LE(std::abs(c.feed_direction - before_.feed_direction), limits_.turn_rate * step_s + kRounding);
  }

  CompensationLimits limits_;
  Correction before_;
  std::int64_t sequence_ = 0;
  bool in_force_ = false;
};

enum class Controller { answers, deaf, refuses, wrong_answers, sometimes, picks };

struct Outcome {
  int asked = 0, releases = 0;
};

void run_one(std::uint64_t seed, Outcome& outcome) {
  std::mt19937_64 random{seed};
  std::uniform_real_distribution<double> chance{0.0, 1.0};
  const bool faults = chance(random) < 0.8;
  const SyntheticCut cut = random_cut(random, faults);
  const SyntheticLog log = record(cut);
  CoreSettings settings = settings_of(cut, chance(random) < 0.75 ? RuntimeMode::active : RuntimeMode::shadow);
  settings.compensator.limits = limits_for(random);
  const bool active = settings.compensator.mode == RuntimeMode::active;
  const auto controller = static_cast<Controller>(static_cast<int>(6 * chance(random)));
  Core core{settings};
  Judge judge{settings.compensator.limits};
  if (chance(random) < 0.7) core.add_lobes(random_lobes(random, 0));

  std::int64_t shift_ns = 0, robot_ns = 0, next_state_ns = kStart, answered_ns = 0, speaks_from_ns = 0;
  std::int64_t first_asked_ns = 0;
  std::size_t next_speed = 0;
  const unsigned kinds_taken = controller == Controller::refuses ? 0U
                               : controller == Controller::picks ? static_cast<unsigned>(random())
                                                                 : ~0U;
  const auto takes = [kinds_taken](CorrectionKind kind) {
    return (kinds_taken >> static_cast<unsigned>(kind) & 1U) != 0;
  };
  const bool tells_motion = chance(random) < 0.5;
  const double turns_at = 0.3 + chance(random);  // rad/s, by the controller
  double feed_direction = 0.0;
  for (const SampleBlock& recorded : log.blocks) {
    SampleBlock block = recorded;
    if (faults && chance(random) < 0.001)  // the clock is set
      shift_ns += static_cast<std::int64_t>((chance(random) - 0.5) * (chance(random) < 0.5 ? 2e9 : 2e7));
    block.stamp_ns += shift_ns;
    for (; next_speed < log.speeds.size() && log.speeds[next_speed].stamp_ns <= recorded.stamp_ns; ++next_speed) {
      SpindleReading reading = log.speeds[next_speed];
      reading.stamp_ns += shift_ns;
      if (core.accept_frame(reading.stamp_ns)) core.add_speed(reading);
    }
    if (faults && chance(random) < 0.002) core.add_lobes(random_lobes(random, block.stamp_ns));
    if (faults && chance(random) < 0.001)  // the robot falls silent
      speaks_from_ns = recorded.stamp_ns + static_cast<std::int64_t>(1.5e9 * chance(random));
    if (recorded.stamp_ns >= next_state_ns) {
      next_state_ns = recorded.stamp_ns + 8 * kMillisecond;
      if (recorded.stamp_ns >= speaks_from_ns) {
        RobotState state = state_at(block.stamp_ns);
        state.spindle_speed_rpm = 9000.0;
        state.axial_depth = chance(random) < 0.05 ? kNaN : 1e-3;
        const bool turned = judge.in_force() && active && judge.last().kind == CorrectionKind::feed_direction &&
                            takes(CorrectionKind::feed_direction) && controller != Controller::deaf;
        feed_direction += std::clamp((turned ? judge.last().feed_direction : 0.0) - feed_direction, -0.008 * turns_at,
                                     0.008 * turns_at);
        state.feed_direction = tells_motion ? feed_direction : 0.0;
        core.add_robot_state(state);
        robot_ns = block.stamp_ns;
      }
    }
    const std::int64_t before_ns = core.view().stamp_ns;
    if (core.accept_frame(block.stamp_ns)) core.add_samples(block);
    const bool was_in_force = judge.in_force();
    for (const Output& output : core.outputs()) {
      if (output.type != Output::Type::correction) continue;
      judge.see(output.correction);
      if (testing::Test::HasFatalFailure()) return;
      outcome.releases += judge.in_force() ? 0 : 1;
      if (judge.in_force() && !was_in_force) first_asked_ns = answered_ns = output.correction.stamp_ns;
    }
    core.clear_outputs();
    if (judge.in_force()) {
      const bool says = controller == Controller::answers || controller == Controller::refuses ||
                        controller == Controller::picks ||
                        (controller == Controller::sometimes && chance(random) < 0.02);
      if (says) {
        const bool taken = takes(judge.last().kind);
        core.add_ack({block.stamp_ns, judge.last().sequence, taken, 9000.0, 1.0, short_text("cannot")});
        if (taken) answered_ns = std::max(answered_ns, block.stamp_ns);
      }
      if (controller == Controller::wrong_answers) {
        core.add_ack(
            {block.stamp_ns, judge.last().sequence + 1 + static_cast<std::int64_t>(5 * chance(random)), true, 0, 1});
        core.add_ack({block.stamp_ns, -1, true, kNaN, kNaN});
      }
    }
    // The conditions, at the moment that was decided last. A stop is not taken back by a monitor that goes deaf.
    const std::int64_t now_ns = core.view().stamp_ns;
    if (!judge.in_force() || now_ns == before_ns) continue;
    const bool stop = judge.last().kind == CorrectionKind::stop_request;
    const bool deafened = core.view().doubts == kSaturated;  // by the chatter itself
    ASSERT_TRUE(stop || deafened || core.view().doubts == kNoDoubt) << "in force while the monitor cannot tell";
    if (!active) continue;
    ASSERT_LT(now_ns - robot_ns, kControllerSilent_ns + 5 * kMillisecond) << "asked of a silent controller";
    ASSERT_LT(now_ns - std::max(answered_ns, first_asked_ns), kUnanswered_ns + 5 * kMillisecond)
        << "asked without answer";
  }
  outcome.asked += judge.asked;
}

TEST(DoNoHarm, HoldsForRandomCutsFaultsControllersLobesAndClocks) {
  const std::uint64_t cases = test::kSanitized ? 25 : 250;
  Outcome outcome;
  for (std::uint64_t seed = 1; seed <= cases; ++seed) {
    SCOPED_TRACE(seed);
    run_one(seed, outcome);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(outcome.asked, static_cast<int>(20 * cases));  // it did ask for something
  EXPECT_GT(outcome.releases, static_cast<int>(cases / 4));
}

}  // namespace
}  // namespace stillcut
