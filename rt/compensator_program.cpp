// The program beside which a correction stands: what it commands, when it has become another, when it is safe again,
// and the way back to it.
#include <algorithm>
#include <cmath>

#include "dsp/numbers.hpp"
#include "rt/compensator.hpp"
#include "rt/watch.hpp"

namespace stillcut {
namespace {

constexpr double kPathTurned = 0.15;                        // rad
constexpr double kProgramChanged = 0.02;                    // relative, of the programmed speed
constexpr double kReturnPace = 0.1;                         // of the limits: recover slowly
constexpr double kSafeToReturn = 0.1;                       // margin at the program, with its scatter against it
constexpr double kBetterThanThen = 0.2;                     // margin over the one with which it chattered
constexpr double kMuchShallower = 0.7;                      // of the depth that chattered against the prediction
constexpr double kSlowestTurnBack = 5.0;                    // times the turn itself: adapters go back at a fifth
constexpr std::int64_t kTurnBackStarts_ns = 1'000'000'000;  // at the latest

double turn_from(double direction, double to) noexcept { return std::remainder(to - direction, kTwoPi); }

}  // namespace

// As found when the correction began; before, as it is now. A programmed speed that the spindle cannot turn is none,
// and a feed that still turns back from the last correction is not that of the program.
CutSetting Compensator::programmed(const CompensatorInputs& in) const noexcept {
  if (correcting()) return programmed_;
  const SpindleLimits& spindle = settings_.limits.spindle;
  CutSetting program;
  const bool programmed = in.nominal_speed >= spindle.min_speed && in.nominal_speed <= spindle.max_speed;
  program.speed = programmed ? in.nominal_speed : std::clamp(in.monitor->speed, spindle.min_speed, spindle.max_speed);
  program.feed_direction = turns_back_ ? programmed_.feed_direction : in.feed_direction;
  return program;
}

// What a correction that begins now begins from: the program, but for a feed that still turns back to it.
CutSetting Compensator::uncorrected(const CompensatorInputs& in) const noexcept {
  CutSetting present = programmed(in);
  if (!turns_back_) return present;
  const double told = present.feed_direction + turn_from(present.feed_direction, in.feed_direction);
  present.feed_direction = turn_is_told_ ? told : motion_.at(motion_time(in.now_ns)).now.feed_direction;
  return present;
}

void Compensator::begin_motion(const CompensatorInputs& in) noexcept {
  CutSetting present = uncorrected(in);
  if (in.monitor->speed > 0.0) present.speed = in.monitor->speed;
  programmed_ = programmed(in);
  turns_back_ = false;
  began_ns_ = in.now_ns;
  motion_.begin(present);
}

// Released, a turned feed goes back at the controller's own pace. Controllers tell the direction of the motion or that
// of the program; which, is seen while it is turned. Where it is neither, the path goes elsewhere.
void Compensator::begin_turn_back(const CompensatorInputs& in) noexcept {
  const double t = motion_time(in.now_ns);
  turn_ = motion_.at(t).now.feed_direction - programmed_.feed_direction;
  turns_back_ = settings_.mode == RuntimeMode::active && std::abs(turn_) > kTurned;
  if (!turns_back_) return;
  turn_is_told_ = is_told_on_its_turn(in);
  const bool told_as_programmed = std::abs(turn_from(programmed_.feed_direction, in.feed_direction)) <= kTurned;
  turns_back_ = (turn_is_told_ || told_as_programmed) && motion_.move_to(programmed_, t, settings_.limits, 1.0);
  turn_until_ns_ = in.now_ns + kTurnBackStarts_ns + to_ns(kSlowestTurnBack * (motion_.arrives_at() - t));
}

void Compensator::follow_turn_back(const CompensatorInputs& in) noexcept {
  if (!turns_back_) return;
  turns_back_ = turn_is_told_ ? is_told_on_its_turn(in) && in.now_ns < turn_until_ns_
                              : motion_time(in.now_ns) < motion_.arrives_at();
}

// Whether the robot tells a direction between the programmed one and that to which the feed was turned.
bool Compensator::is_told_on_its_turn(const CompensatorInputs& in) const noexcept {
  const double told = turn_from(programmed_.feed_direction, in.feed_direction);
  return std::abs(told) > kTurned && told * turn_ > 0.0 && std::abs(told) <= std::abs(turn_) + kTurned;
}

// A correction belongs to the program that it was chosen for: another programmed speed, or a path that takes a turned
// feed elsewhere, ends it.
bool Compensator::program_changed(const CompensatorInputs& in) const noexcept {
  if (phase_ == Phase::stopped) return false;
  const bool speed = in.nominal_speed > 0.0 && nominal_speed_ > 0.0 &&
                     std::abs(in.nominal_speed - nominal_speed_) > kProgramChanged * nominal_speed_;
  if (candidate_.kind != CorrectionKind::feed_direction || motion_time(in.now_ns) < motion_.arrives_at()) return speed;
  // Controllers tell the direction of the program or that of the motion.
  const auto away = [&](double direction) {
    return std::abs(std::remainder(in.feed_direction - direction, kTwoPi)) > kPathTurned;
  };
  return speed || (away(motion_.target().feed_direction) && away(programmed_.feed_direction));
}

// The program is safe again: less deep, another posture, another direction. Where the prediction called safe what then
// chattered, only less depth counts.
bool Compensator::reason_is_gone(const CompensatorInputs& in) const noexcept {
  if (return_failed_ || settings_.mode != RuntimeMode::active) return false;
  const Prediction now = prediction(in);
  if (!(safe_margin_at(now, programmed_.speed) > kSafeToReturn)) return false;
  // The lobes are those of the direction that the feed now has.
  const bool turned = candidate_.kind == CorrectionKind::feed_direction;
  if (turned || !(chatter_margin_ < 0.0)) return in.axial_depth < kMuchShallower * chatter_depth_;
  return margin_at(now, programmed_.speed) > chatter_margin_ + kBetterThanThen;
}

void Compensator::start_return(const CompensatorInputs& in) noexcept {
  if (!motion_.move_to(programmed_, motion_time(in.now_ns), settings_.limits, kReturnPace)) return;
  phase_ = Phase::returning;
  next_publish_ns_ = in.now_ns;
}

}  // namespace stillcut
