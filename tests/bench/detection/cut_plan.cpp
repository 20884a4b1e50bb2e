#include "tests/bench/detection/cut_plan.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <stdexcept>

#include "dsp/numbers.hpp"
#include "models/floquet.hpp"
#include "models/linear_cut.hpp"

namespace stillcut::detection {
namespace {

constexpr int kTries = 400;
constexpr double kDeepest = 0.012;       // m, that a plan may use
constexpr double kDeepestSound = 0.003;  // m: deeper cuts throw the tool about before they chatter
constexpr double kAgree = 1.1;           // of the depth at which the robot alone chatters as fast: there both must
constexpr double kEntry = 0.3, kStable = 0.9;  // s: air before the cut; a sound cut before chatter
constexpr double kSlowestTool = 300.0, kFastestTool = 1500.0, kSlowestRobot = 8.0, kFastestRobot = 20.0;  // Hz

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_{seed} {}
  double even(double low, double high) { return low + (high - low) * share(); }
  double log_even(double low, double high) { return low * std::pow(high / low, share()); }
  bool chance(double part) { return share() < part; }
  int whole(int low, int high) { return low + static_cast<int>(share() * (high - low + 1)); }

 private:
  // Not std::uniform_real_distribution: its values differ between libraries, a seed list must not.
  double share() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  std::mt19937_64 random_;
};

Mode mode_at(double hz, double damping, double stiffness, double angle) {
  return {kTwoPi * hz, damping, stiffness, {std::cos(angle), std::sin(angle), 0.0}};
}

std::vector<Mode> tool_modes(Draw& draw) {
  const double hz = draw.log_even(kSlowestTool, kFastestTool / 1.25), angle = draw.even(-0.3, 0.3);
  const double stiffness = draw.log_even(6e6, 25e6);
  return {mode_at(hz, draw.even(0.015, 0.04), stiffness, angle),
          mode_at(hz * draw.even(1.02, 1.25), draw.even(0.015, 0.04), stiffness * draw.even(0.8, 1.3),
                  angle + 0.25 * kTwoPi)};
}

// Two close modes at an angle to the cutting force; `soft` ones can chatter by coupling.
std::vector<Mode> robot_modes(Draw& draw, bool soft) {
  const double hz = draw.even(kSlowestRobot, kFastestRobot / 1.25), angle = draw.even(0.0, 0.5 * kTwoPi);
  const double stiffness = soft ? draw.log_even(0.3e6, 1e6) : draw.log_even(6e6, 12e6);
  return {mode_at(hz, draw.even(0.01, 0.03), stiffness, angle),
          mode_at(hz * draw.even(1.05, 1.25), draw.even(0.01, 0.03), stiffness * draw.even(0.9, 1.2),
                  angle + 0.25 * kTwoPi)};
}

MillingSetup draw_setup(Draw& draw) {
  MillingSetup setup;
  Tool& tool = setup.tool;
  tool.diameter = draw.even(8e-3, 20e-3);
  tool.teeth = draw.whole(1, 6);
  const double uneven = tool.teeth > 1 && draw.chance(0.25) ? draw.even(0.03, 0.1) : 0.0;
  double sum = 0.0;
  for (int t = 0; t < tool.teeth; ++t) tool.pitch.push_back(1.0 + (t % 2 == 0 ? uneven : -uneven));
  for (const double pitch : tool.pitch) sum += pitch;
  for (double& pitch : tool.pitch) pitch *= kTwoPi / sum;
  if (uneven == 0.0) tool.pitch.assign(static_cast<std::size_t>(tool.teeth), kTwoPi / tool.teeth);
  tool.runout = draw.even(0.0, 20e-6);
  tool.runout_angle = draw.even(0.0, kTwoPi);
  setup.material.ktc = draw.even(600e6, 1200e6);
  setup.material.krc = draw.even(0.25, 0.45) * setup.material.ktc;
  Cut& cut = setup.cut;
  const double immersion = draw.even(0.15, 1.1);
  cut.milling = immersion > 1.0 ? Milling::slot : draw.chance(0.5) ? Milling::down : Milling::up;
  cut.radial_depth = std::min(1.0, immersion) * tool.diameter;
  cut.feed_per_tooth = draw.even(0.04e-3, 0.12e-3);
  cut.spindle_speed = rpm_to_rad_s(draw.log_even(3000.0, 16000.0));
  setup.force_noise = draw.even(0.003, 0.01);  // more, and noise alone holds a tenth of the forced amplitude
  return setup;
}

// The smallest depth at which the radius per period reaches a value, and the multiplier's frequency there.
struct Reached {
  double depth = kNaN, hz = kNaN;
};

Reached depth_for(const MillingSetup& setup, const std::vector<Mode>& modes, double speed, double radius) {
  const LinearCut cut = linear_cut(setup.tool, setup.material, setup.cut);
  CutAtSpeed cutting{cut, modes, speed, 0};
  constexpr double kStep = 1.25, kFirst = 20e-6;
  double low = kFirst, high = kFirst;
  if (cutting.radius(kFirst) >= radius) return {};
  while (cutting.radius(high) < radius) {
    low = high;
    high *= kStep;
    if (high > kDeepest) return {};
  }
  for (int i = 0; i < 14; ++i) {
    const double middle = std::sqrt(low * high);
    (cutting.radius(middle) < radius ? low : high) = middle;
  }
  return {high, cutting.leading(high).frequency / kTwoPi};
}

double period_of(const MillingSetup& setup) {
  return linear_cut(setup.tool, setup.material, setup.cut).period_angle() / setup.cut.spindle_speed;
}

bool within(double value, double low, double high) { return value > 0.9 * low && value < 1.1 * high; }

// A sound depth, then the unstable one; lasts until slow growth has had its time.
void schedule_onset(CutPlan& plan, Draw& draw, double depth, double growth_per_s) {
  const double sound = draw.even(0.7, 0.95) * std::min(plan.limit, depth);
  const double entered = kEntry + draw.even(0.02, 0.15);
  plan.unstable_from = entered + kStable + draw.even(0.0, 0.4);
  plan.unstable_depth_at = plan.unstable_from + draw.even(0.005, 0.05);
  plan.reference_from = entered + 0.3;
  plan.reference_to = plan.unstable_from;
  plan.reference_scale = depth / sound;
  plan.duration = plan.unstable_depth_at + std::min(5.0, 0.5 + std::log(300.0) / growth_per_s);
  plan.schedule.axial_depth = {
      {0.0, 0.0}, {kEntry, 0.0}, {entered, sound}, {plan.unstable_from, sound}, {plan.unstable_depth_at, depth}};
}

std::optional<CutPlan> try_tool_chatter(Draw& draw) {
  CutPlan plan;
  plan.setup = draw_setup(draw);
  plan.growth = draw.log_even(1.03, 1.3);
  std::vector<Mode> modes = tool_modes(draw);
  if (draw.chance(0.5)) {
    const std::vector<Mode> robot = robot_modes(draw, false);
    modes.insert(modes.end(), robot.begin(), robot.end());
  }
  const double speed = plan.setup.cut.spindle_speed, period = period_of(plan.setup);
  const double teeth_a_period = std::round(period * speed / kTwoPi * plan.setup.tool.teeth);
  const Reached limit = depth_for(plan.setup, modes, speed, 1.0);
  if (!(limit.depth < kDeepestSound)) return {};
  const Reached grown = depth_for(plan.setup, modes, speed, std::pow(plan.growth, teeth_a_period));
  if (!within(grown.hz, kSlowestTool, kFastestTool) || !within(limit.hz, kSlowestTool, kFastestTool)) return {};
  plan.setup.modes = modes;
  plan.limit = limit.depth;
  plan.chatter_hz = grown.hz;
  plan.growth_per_s = std::log(plan.growth) * teeth_a_period / period;
  schedule_onset(plan, draw, grown.depth, plan.growth_per_s);
  return plan;
}

// The robot's growth is drawn per cycle of its own vibration. For both kinds the tool's stiffness is then chosen so
// that the tool chatters at the same depth: depth over stiffness is all that its stability depends on.
std::optional<CutPlan> try_structural(Draw& draw, bool both) {
  CutPlan plan;
  plan.setup = draw_setup(draw);
  plan.setup.tool.runout *= 0.25;
  std::vector<Mode> robot = robot_modes(draw, true), tool = tool_modes(draw);
  const double speed = plan.setup.cut.spindle_speed, period = period_of(plan.setup);
  const double a_cycle = draw.log_even(1.1, 1.6), hz = robot[0].natural_frequency / kTwoPi;
  const Reached limit = depth_for(plan.setup, robot, speed, 1.0);
  const Reached grown = depth_for(plan.setup, robot, speed, std::pow(a_cycle, hz * period));
  if (!(limit.depth > 30e-6) || !within(grown.hz, kSlowestRobot, kFastestRobot)) return {};
  plan.slow_hz = grown.hz;
  plan.slow_growth_per_s = std::log(a_cycle) * hz;
  plan.slow_heard_at = draw.log_even(5e-6, 50e-6);
  plan.growth = both ? draw.log_even(1.03, 1.3) : 0.6;
  const double teeth_a_period = std::round(period * speed / kTwoPi * plan.setup.tool.teeth);
  const Reached tool_grown = depth_for(plan.setup, tool, speed, both ? std::pow(plan.growth, teeth_a_period) : 1.0);
  if (!within(tool_grown.hz, kSlowestTool, kFastestTool)) return {};
  const double stiffer = grown.depth / tool_grown.depth * (both ? 1.0 : draw.even(2.0, 3.0));
  for (Mode& mode : tool) mode.stiffness *= stiffer;
  plan.chatter_hz = tool_grown.hz;
  if (both) plan.growth_per_s = std::log(plan.growth) * teeth_a_period / period;
  plan.limit = limit.depth;
  if (both) plan.limit = std::min(plan.limit, stiffer * depth_for(plan.setup, tool, speed, 1.0).depth);
  plan.setup.modes = tool;
  plan.setup.modes.insert(plan.setup.modes.end(), robot.begin(), robot.end());
  // The tool gives way as well: together they chatter at another depth than the robot alone.
  const Reached together = depth_for(plan.setup, plan.setup.modes, speed, std::pow(a_cycle, hz * period));
  if (!both && !within(together.hz, kSlowestRobot, kFastestRobot)) return {};
  if (both && !(together.depth < kAgree * grown.depth)) return {};
  if (!both) plan.slow_hz = together.hz;
  const double slowest = both ? std::min(plan.growth_per_s, plan.slow_growth_per_s) : plan.slow_growth_per_s;
  schedule_onset(plan, draw, both ? grown.depth : together.depth, slowest);
  return plan;
}

void schedule_stable(CutPlan& plan, Draw& draw, double depth) {
  plan.duration = kSoundCut;
  Schedule& cut = plan.schedule.axial_depth;
  cut = {{0.0, 0.0}, {kEntry, 0.0}, {kEntry + draw.even(0.02, 0.2), depth}};
  plan.reference_from = 0.8;
  plan.reference_to = 1.2;
  if (plan.kind == CutKind::knocks)
    for (double t = 1.3; t < plan.duration; t += draw.even(0.2, 0.7)) plan.knocks.push_back(t);
  if (plan.kind == CutKind::entries)
    for (double t = 1.2; t < plan.duration - 0.6; t += 0.8) {
      const double away = draw.even(0.02, 0.1), back = draw.even(0.02, 0.1);
      cut.insert(cut.end(), {{t, depth}, {t + away, 0.0}, {t + away + 0.2, 0.0}, {t + away + 0.2 + back, depth}});
    }
  if (plan.kind == CutKind::deeper) {
    const double less = draw.even(0.3, 0.8) * depth, took = draw.even(0.005, 0.05);
    cut.back().value = less;
    cut.insert(cut.end(), {{1.5, less}, {1.5 + took, depth}, {2.8, depth}, {2.8 + took, less}});
    depth = less;
  }
  if (plan.kind == CutKind::interrupted) {
    const double period = draw.even(0.06, 0.25);
    for (double t = 1.2; t < plan.duration; t += period)
      cut.insert(cut.end(), {{t, depth}, {t + 0.004, 0.0}, {t + 0.4 * period, 0.0}, {t + 0.4 * period + 0.004, depth}});
  }
  cut.push_back({plan.duration + 1.0, depth});
}

std::optional<CutPlan> try_stable(Draw& draw, CutKind kind) {
  CutPlan plan;
  plan.kind = kind;
  plan.setup = draw_setup(draw);
  plan.setup.modes = tool_modes(draw);
  const double mode_hz = plan.setup.modes[0].natural_frequency / kTwoPi;
  if (draw.chance(0.5)) {
    const std::vector<Mode> robot = robot_modes(draw, false);
    plan.setup.modes.insert(plan.setup.modes.end(), robot.begin(), robot.end());
  }
  double& speed = plan.setup.cut.spindle_speed;
  double last = speed;
  if (kind == CutKind::speed_ramp) last = speed * draw.even(0.8, 1.25);
  if (kind == CutKind::forced_near_mode) {
    const double tooth_hz = speed / kTwoPi * plan.setup.tool.teeth;
    const double on_mode = speed * mode_hz / (tooth_hz * std::max(1.0, std::round(mode_hz / tooth_hz)));
    const bool held = draw.chance(0.4);
    speed = on_mode * (held ? 1.0 + draw.even(-3.0, 3.0) / mode_hz : draw.even(0.94, 0.98));
    last = held ? speed : on_mode * draw.even(1.02, 1.06);
  }
  if (!(speed > rpm_to_rad_s(2000.0)) || speed > rpm_to_rad_s(30000.0)) return {};
  plan.limit = kDeepest;
  for (int i = 0; i < (last == speed ? 1 : 9); ++i) {
    const Reached found = depth_for(plan.setup, plan.setup.modes, std::lerp(speed, last, i / 8.0), 1.0);
    if (found.depth > 0.0) plan.limit = std::min(plan.limit, found.depth);
  }
  const double depth = draw.even(0.3, 0.75) * plan.limit;
  if (depth < 50e-6) return {};
  schedule_stable(plan, draw, depth);
  plan.chatter_hz = mode_hz;
  plan.knock = draw.even(2e-6, 10e-6) * plan.setup.modes[0].stiffness / plan.setup.modes[0].natural_frequency;
  if (last != speed) {
    const double steepest = rpm_to_rad_s(1000.0);  // rad/s^2
    const double start = 1.3, took = std::max(std::abs(last - speed) / steepest, 1.0);
    plan.duration = std::max(plan.duration, start + took + 0.3);
    plan.schedule.axial_depth.back().time = plan.duration + 1.0;
    plan.schedule.spindle_speed = {{0.0, speed}, {start, speed}, {start + took, last}};
  }
  return plan;
}

std::optional<CutPlan> try_cut(Draw& draw, CutKind kind) {
  if (kind == CutKind::tool_chatter) return try_tool_chatter(draw);
  if (chatters(kind)) return try_structural(draw, kind == CutKind::both_kinds);
  return try_stable(draw, kind);
}

}  // namespace

CutPlan draw_cut(SeedList list, int index, CutKind kind) {
  const std::uint64_t first = list == SeedList::tuning ? 1'000'000 : 2'000'000;
  Draw draw{first + static_cast<std::uint64_t>(index)};
  for (int i = 0; i < kTries; ++i) {
    std::optional<CutPlan> found = try_cut(draw, kind);
    if (!found) continue;
    CutPlan& plan = *found;
    plan.kind = kind;
    plan.seed = first + static_cast<std::uint64_t>(index);
    plan.setup.seed = plan.seed;
    plan.sensor_rate_hz = draw.chance(0.6) ? 10000.0 : 25600.0;
    plan.snr_db = draw.even(0.0, 30.0);
    plan.frames_lost = draw.chance(0.2);
    plan.speed_jitter = draw.chance(0.3) ? 5e-3 : 0.0;
    plan.speed_gaps = draw.chance(0.2);
    for (const Mode& mode : plan.setup.modes)
      plan.map_modes.push_back({mode.natural_frequency / kTwoPi * draw.even(0.98, 1.02), mode.damping_ratio});
    plan.map_limit = plan.limit * draw.even(0.8, 1.2);
    plan.setup = scheduled(plan.setup, plan.schedule);
    return plan;
  }
  throw std::runtime_error("no cut of this kind was found; the draw's ranges are too narrow");
}

}  // namespace stillcut::detection
