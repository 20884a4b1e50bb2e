#include "tests/bench/detection/milled_cut.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace stillcut::detection {
namespace {

constexpr int kSamplesPerFrame = 10;
constexpr double kThrownOff = 2e-3;                          // m
constexpr double kSpeedPeriod = 0.02;                        // s
constexpr double kTenth = 0.1, kVisible = 0.5, kLoud = 3.0;  // of the forced amplitude; of the noise
constexpr double kLowest_hz = 100.0, kHighestOfRate = 0.4;   // the band of the signal-to-noise ratio
constexpr double kSlowBand_hz = 98.0;
constexpr double kLostShare = 0.01, kGapEvery = 0.4;  // of frames; s between gaps in the speed

struct Clean {
  std::vector<std::array<double, 3>> acceleration;  // at the sensor's rate
  std::vector<double> turns, speed;
};

// A sample is the mean acceleration over its interval, as a sensor's own filter would leave it.
Clean simulate(const CutPlan& plan, TipMotion& motion) {
  const int finer = static_cast<int>(std::ceil(lowest_sample_rate_hz(plan.setup.modes) / plan.sensor_rate_hz));
  motion.rate_hz = finer * plan.sensor_rate_hz;
  MillingSimulation milling{plan.setup, motion.rate_hz};
  Clean clean;
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  std::size_t knock = 0;
  for (long i = 0; i < static_cast<long>(plan.duration * motion.rate_hz); ++i) {
    const double time = static_cast<double>(i + 1) / motion.rate_hz;
    if (knock < plan.knocks.size() && time >= plan.knocks[knock]) {
      milling.structure().strike(plan.knock * Eigen::Vector3d(0.8, 0.6, 0.0));
      ++knock;
    }
    const MillingState& state = milling.advance(conditions_at(plan.setup, plan.schedule, time));
    if (state.displacement.norm() > kThrownOff) break;  // here a machine would be stopped, and the record ends
    motion.x.push_back(state.displacement.x());
    motion.y.push_back(state.displacement.y());
    motion.angle.push_back(state.spindle_angle);
    if ((i + 1) % finer != 0) continue;
    const Eigen::Vector3d mean = (state.velocity - before) * plan.sensor_rate_hz;
    before = state.velocity;
    clean.acceleration.push_back({mean.x(), mean.y(), mean.z()});
    clean.turns.push_back(state.spindle_angle / kTwoPi);
    clean.speed.push_back(state.spindle_speed);
  }
  return clean;
}

// Chatter at half the forced displacement, as the sensor's axis that hears more of it would measure it.
double noise_for(const CutPlan& plan, double forced) {
  const auto& direction = plan.setup.modes[0].direction;
  const double omega = kTwoPi * plan.chatter_hz, part = std::max(std::abs(direction[0]), std::abs(direction[1]));
  const double chatter_power = 0.5 * std::pow(kVisible * forced * part * omega * omega, 2);
  const double in_band = (kHighestOfRate - kLowest_hz / plan.sensor_rate_hz) / 0.5;
  return std::sqrt(chatter_power / std::pow(10.0, 0.1 * plan.snr_db) / in_band);
}

// Displacement of the robot's chatter whose acceleration is three times the noise in 2-100 Hz, rms beside rms.
double slow_amplitude_at_clock(const CutPlan& plan, double noise) {
  const double omega = kTwoPi * plan.slow_hz, in_band = noise * std::sqrt(kSlowBand_hz / (0.5 * plan.sensor_rate_hz));
  return kLoud * in_band * std::sqrt(2.0) / (omega * omega);
}

void quieten(const CutPlan& plan, CutTruth& truth) {
  const double less = std::min(1.0, plan.slow_heard_at / slow_amplitude_at_clock(plan, truth.noise));
  truth.noise *= less;
  truth.snr_db -= 20.0 * std::log10(less);
}

std::vector<double> depth_shares(const CutPlan& plan, const TipMotion& motion) {
  const double then = value_at(plan.schedule.axial_depth, plan.reference_from);
  std::vector<double> shares(motion.x.size());
  for (std::size_t i = 0; i < shares.size(); ++i)
    shares[i] = value_at(plan.schedule.axial_depth, static_cast<double>(i + 1) / motion.rate_hz) / then;
  return shares;
}

CutTruth find_truth(const CutPlan& plan, TipMotion motion) {
  CutTruth truth;
  truth.forced = plan.reference_scale * forced_amplitude(motion, plan.reference_from, plan.reference_to);
  truth.noise = noise_for(plan, truth.forced);
  truth.snr_db = plan.snr_db;
  if (plan.slow_hz > 0.0) quieten(plan, truth);
  if (plan.slow_hz > 0.0) {
    const TipLine line = slow_line(plan);
    const double limit = slow_amplitude_at_clock(plan, truth.noise);
    truth.slow_s = rise_of(line_amplitude(motion, line), limit, limit, plan.unstable_depth_at).limit_s;
  }
  if (chatters(plan.kind))
    remove_repetition(motion, plan.reference_from, plan.reference_to, depth_shares(plan, motion));
  truth.amplitude = line_amplitude(motion, tool_line(plan));
  if (plan.kind == CutKind::tool_chatter || plan.kind == CutKind::both_kinds) {
    const Rise rise = rise_of(truth.amplitude, kTenth * truth.forced, kVisible * truth.forced, plan.unstable_depth_at);
    truth.tenth_s = rise.limit_s;
    truth.visible_s = rise.proof_s;
  }
  truth.motion = std::move(motion);
  return truth;
}

std::int64_t stamp(double seconds) { return kOrigin_ns + std::llround(seconds * 1e9); }

void send_speed(const CutPlan& plan, const Clean& clean, std::mt19937_64& random, MilledCut& cut) {
  std::uniform_real_distribution<double> share;
  double gap_until = 0.0, next_gap = kGapEvery;
  for (double t = 0.0; t < plan.duration; t += kSpeedPeriod) {
    if (plan.speed_gaps && t > next_gap) gap_until = t + 0.05, next_gap = t + kGapEvery * (0.5 + share(random));
    if (t < gap_until) continue;
    const auto at = std::min(clean.speed.size() - 1, static_cast<std::size_t>(t * plan.sensor_rate_hz));
    cut.readings.push_back({stamp(t + plan.speed_jitter * share(random)), clean.speed[at]});
  }
}

void send_samples(const CutPlan& plan, const Clean& clean, std::mt19937_64& random, MilledCut& cut) {
  std::normal_distribution<double> normal{0.0, cut.truth.noise};
  std::uniform_real_distribution<double> share;
  SampleBlock block;
  block.axes_present = 7;
  std::uint32_t lost = 0;
  for (std::size_t i = 0; i < clean.acceleration.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      block.acceleration[axis][block.samples] = static_cast<float>(clean.acceleration[i][axis] + normal(random));
    cut.samples.push_back({block.acceleration[0][block.samples], block.acceleration[1][block.samples]});
    if (++block.samples < kSamplesPerFrame) continue;
    block.stamp_ns = stamp(static_cast<double>(i + 1) / plan.sensor_rate_hz);
    if (plan.frames_lost && share(random) < kLostShare) {
      ++lost;
    } else {
      block.frames_lost = lost;
      lost = 0;
      cut.blocks.push_back(block);
    }
    block.samples = 0;
  }
}

}  // namespace

TipLine tool_line(const CutPlan& plan) { return {plan.chatter_hz, plan.growth_per_s, false}; }
TipLine slow_line(const CutPlan& plan) { return {plan.slow_hz, plan.slow_growth_per_s, true}; }

MilledCut mill(const CutPlan& plan) {
  MilledCut cut;
  TipMotion motion;
  Clean clean = simulate(plan, motion);
  cut.truth = find_truth(plan, std::move(motion));
  std::mt19937_64 random{plan.seed};
  send_speed(plan, clean, random, cut);
  send_samples(plan, clean, random, cut);
  cut.turns = std::move(clean.turns);
  return cut;
}

}  // namespace stillcut::detection
