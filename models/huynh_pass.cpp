#include "models/huynh_pass.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "models/feed_path.hpp"
#include "models/four_axis_arm.hpp"
#include "models/newmark_robot.hpp"
#include "models/wall_profile.hpp"

namespace stillcut {
namespace {

constexpr double kFeedRate = 3.7 / 60.0;      // m/s, 3700 mm/min
constexpr double kBacking = 3e-3;             // m of plate behind the wall
constexpr double kBehindTool = 1e-3;          // m behind the tool's axis the wall is finished
constexpr double kHighestForceLine = 2500.0;  // Hz

Eigen::Vector2d feed_of(PassWay way) {
  return way == PassWay::longitudinal ? Eigen::Vector2d(1.0, 0.0) : Eigen::Vector2d(0.0, 1.0);
}

struct PassGeometry {
  FeedPath path;
  double entry_travel = 0.0, end_travel = 0.0;  // m: where the tool's edge meets the plate, and the end
  double duration = 0.0;                        // s
  Eigen::Vector2d feed, cross;
  double side = 0.0;  // +1: the plate is on the side of `cross`, -1: on the other
};

PassGeometry geometry_of(const HuynhPass& pass) {
  if (pass.milling != Milling::down && pass.milling != Milling::up)
    throw std::invalid_argument("a pass mills down or up");
  if (!(pass.air_time >= 0.0 && pass.cutting_time > 0.0 && pass.wall_length > 0.0) || pass.measured_turns < 2)
    throw std::invalid_argument("a pass needs times, a wall's length and at least two turns to measure");
  PassGeometry g;
  g.feed = feed_of(pass.way);
  g.cross = {-g.feed.y(), g.feed.x()};
  g.side = pass.milling == Milling::up ? 1.0 : -1.0;
  g.path.direction = {g.feed.x(), g.feed.y(), 0.0};
  g.path.feed_rate = kFeedRate;
  const double taken_up = 2.0 * g.path.jerk_time + g.path.constant_time;
  g.duration = taken_up + pass.air_time + pass.cutting_time;
  g.entry_travel = feed_state(g.path, taken_up + pass.air_time).travel;
  g.end_travel = feed_state(g.path, g.duration).travel;
  g.path.start = pass.place - g.end_travel * g.path.direction;
  return g;
}

// The plate in front of the tool's edge as the feed has settled, its face a radial depth inside the tool.
Contour plate_of(const HuynhPass& pass, const PassGeometry& g) {
  const Tool tool = huynh_tool();
  const double radius = 0.5 * tool.diameter, face = radius - huynh_cut(pass.way, pass.milling).radial_depth;
  const Eigen::Vector2d start = g.path.start.head<2>();
  const auto corner = [&](double along, double across) -> Eigen::Vector2d {
    return start + along * g.feed + g.side * across * g.cross;
  };
  const double from = g.entry_travel + radius, to = g.end_travel + 2.0 * radius, back = radius + kBacking;
  return {corner(from, face), corner(to, face), corner(to, back), corner(from, back)};
}

PartMilling milling_of(const HuynhPass& pass, const PassGeometry& g) {
  PartMillingSetup setup;
  setup.tool = huynh_tool();
  setup.tool.runout = pass.runout;
  setup.material = huynh_material();
  setup.part = {plate_of(pass, g)};
  const Cut cut = huynh_cut(pass.way, pass.milling);
  setup.axial_depth = pass.axial_depth;
  setup.spindle_speed = cut.spindle_speed;
  setup.start_angle = pass.start_angle;
  setup.steps_per_turn = pass.steps_per_turn;
  setup.discs = pass.discs;
  setup.chords = pass.chords;
  setup.path = [path = g.path](double time) -> Eigen::Vector2d { return feed_position(path, time).head<2>(); };
  setup.structure = [path = g.path](double step) {
    return std::make_unique<NewmarkRobot>(
        huynh_robot(), [path](double time) { return four_axis_angles({}, feed_position(path, time)); }, step);
  };
  return PartMilling(std::move(setup));
}

struct Recorded {
  std::vector<double> feed, cross, deviation, angle;
  double feed_acceleration = 0.0, cross_acceleration = 0.0;
};

double rms(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double mean_of(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double peak_of(std::span<const double> values) {
  double peak = 0.0;
  for (const double value : values) peak = std::max(peak, std::abs(value));
  return peak;
}

// A tooth's own part of a turn is the half in which it faces the feed.
std::array<double, 2> tooth_peaks(const Recorded& run, double feed_angle, int turns_measured) {
  const Tool tool = huynh_tool();
  std::array<double, 2> sum{};
  const auto turns = static_cast<std::size_t>(turns_measured);
  for (std::size_t t = 0; t < turns; ++t) {
    std::array<double, 2> peak{};
    for (std::size_t i = t * run.cross.size() / turns; i < (t + 1) * run.cross.size() / turns; ++i)
      for (std::size_t tooth = 0; tooth < 2; ++tooth) {
        const double phi = run.angle[i] + feed_angle + (tooth == 0 ? 0.0 : tool.pitch[0]);
        if (std::sin(phi) > 0.0) peak[tooth] = std::max(peak[tooth], std::abs(run.cross[i]));
      }
    for (std::size_t tooth = 0; tooth < 2; ++tooth) sum[tooth] += peak[tooth] / static_cast<double>(turns);
  }
  return sum;
}

WallLine wall_line_of(const HuynhPass& pass, const PassGeometry& g) {
  constexpr double kInside = 0.5e-3;  // m that the stylus starts before the nominal wall
  WallLine line;
  line.along = g.feed;
  line.into = g.side * g.cross;
  line.length = pass.wall_length;
  line.start = g.path.start.head<2>() + (g.end_travel - kBehindTool - pass.wall_length) * g.feed +
               (0.5 * huynh_tool().diameter - kInside) * line.into;
  line.reach = 2.0 * kInside;
  return line;
}

void measure_wall(const HuynhPass& pass, const PassGeometry& g, const PartMilling& milling, HuynhPassResult& result) {
  const WallLine line = wall_line_of(pass, g);
  const double nominal = 0.5 * line.reach;
  const auto& slices = milling.slices();
  for (std::size_t i = 0; i < slices.size(); ++i) {
    std::vector<double> heights = wall_profile(slices[i], line);
    for (double& height : heights) height -= nominal;
    result.wall.push_back(profile_roughness(heights, line.spacing));
    if (i == slices.size() / 2) result.profile = std::move(heights);
  }
}

}  // namespace

Tool huynh_tool() {
  Tool tool;
  tool.diameter = 10e-3;
  tool.teeth = 2;
  tool.pitch = {deg_to_rad(170.0), deg_to_rad(190.0)};
  tool.helix = deg_to_rad(30.0);
  return tool;
}

Material huynh_material() { return {.name = "AL6060-T6", .ktc = 661.513e6, .krc = 253.458e6}; }

Cut huynh_cut(PassWay way, Milling milling) {
  Cut cut;
  cut.milling = milling;
  cut.radial_depth = 4e-3;
  cut.axial_depth = 1.6e-3;
  cut.spindle_speed = rpm_to_rad_s(18700.0);
  cut.feed_per_tooth = kFeedRate * kTwoPi / (2.0 * cut.spindle_speed);
  cut.feed_direction = way == PassWay::longitudinal ? 0.0 : 0.5 * std::numbers::pi;
  return cut;
}

Spectrum amplitude_spectrum(std::span<const double> samples, double step, double highest_hz) {
  if (samples.empty() || !(step > 0.0)) throw std::invalid_argument("a spectrum needs samples and their step");
  const auto count = static_cast<double>(samples.size());
  Spectrum spectrum{.resolution = 1.0 / (count * step), .amplitude = {}};
  const auto lines = static_cast<int>(std::min(highest_hz / spectrum.resolution, 0.5 * count));
  for (int line = 0; line <= lines; ++line) {
    const double turn = kTwoPi * line / count, twice = 2.0 * std::cos(turn);
    double last = 0.0, before = 0.0;  // Goertzel's recurrence
    for (const double sample : samples) {
      const double now = sample + twice * last - before;
      before = last;
      last = now;
    }
    const double power = last * last + before * before - twice * last * before;
    spectrum.amplitude.push_back((line == 0 ? 1.0 : 2.0) / count * std::sqrt(std::max(0.0, power)));
  }
  return spectrum;
}

RoughnessRange over_slices(std::span<const ProfileRoughness> wall) {
  if (wall.empty()) throw std::invalid_argument("a wall needs slices");
  RoughnessRange range{.mean = mean_of(wall), .low = wall[0], .high = wall[0]};
  for (const auto figure : {&ProfileRoughness::ra, &ProfileRoughness::rq, &ProfileRoughness::rt})
    for (const ProfileRoughness& slice : wall) {
      range.low.*figure = std::min(range.low.*figure, slice.*figure);
      range.high.*figure = std::max(range.high.*figure, slice.*figure);
    }
  return range;
}

HuynhPassResult run_huynh_pass(const HuynhPass& pass, const std::function<void(double)>& progress) {
  const PassGeometry g = geometry_of(pass);
  PartMilling milling = milling_of(pass, g);
  const auto steps = static_cast<std::int64_t>(std::llround(g.duration / milling.step()));
  const std::int64_t measured = std::llround(pass.measured_turns * pass.steps_per_turn);
  if (measured > steps) throw std::invalid_argument("a pass shorter than the turns to measure");
  Recorded run;
  std::vector<double> feed_acceleration, cross_acceleration;
  for (std::int64_t i = 0; i < steps; ++i) {
    const MillingState& state = milling.advance();
    if (progress && i % 1024 == 0) progress(static_cast<double>(i) / static_cast<double>(steps));
    if (i < steps - measured) continue;
    const Eigen::Vector2d force = state.force.head<2>(), moved = state.displacement.head<2>();
    run.feed.push_back(force.dot(g.feed));
    run.cross.push_back(force.dot(g.cross));
    run.deviation.push_back(g.side * moved.dot(g.cross));
    run.angle.push_back(state.spindle_angle);
    feed_acceleration.push_back(state.acceleration.head<2>().dot(g.feed));
    cross_acceleration.push_back(state.acceleration.head<2>().dot(g.cross));
  }
  HuynhPassResult result;
  result.step = milling.step();
  result.feed_peak = peak_of(run.feed);
  result.feed_rms = rms(run.feed);
  result.feed_mean = mean_of(run.feed);
  result.cross_peak = peak_of(run.cross);
  result.cross_rms = rms(run.cross);
  result.cross_mean = mean_of(run.cross);
  result.tooth_peak = tooth_peaks(run, huynh_cut(pass.way, pass.milling).feed_direction, pass.measured_turns);
  result.cross_spectrum = amplitude_spectrum(run.cross, result.step, kHighestForceLine);
  result.deviation_mean = mean_of(run.deviation);
  result.deviation_peak = peak_of(run.deviation);
  result.feed_vibration = rms(feed_acceleration);
  result.cross_vibration = rms(cross_acceleration);
  measure_wall(pass, g, milling, result);
  for (std::size_t i = run.feed.size() - static_cast<std::size_t>(std::llround(2.0 * pass.steps_per_turn));
       i < run.feed.size(); ++i) {
    result.turns.push_back((run.angle[i] - run.angle[run.feed.size() - 1]) / kTwoPi + 2.0);
    result.feed_force.push_back(run.feed[i]);
    result.cross_force.push_back(run.cross[i]);
    result.deviation.push_back(run.deviation[i]);
  }
  return result;
}

}  // namespace stillcut
