#include "tests/tools/closed_loop/random_cell.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <stdexcept>

#include "models/lobes.hpp"

namespace stillcut::campaign {
namespace {

constexpr int kMostDraws = 2000;
constexpr double kHighestMode_hz = 1280.0;                            // 20 samples a period at the sensors' 25.6 kHz
constexpr double kDeepest = 6e-3;                                     // m
constexpr double kTruly = -0.1, kPocket = 0.15, kSound = 0.3;         // margins
constexpr double kSlowest = rpm_to_rad_s(1200.0), kLeastRange = 1.4;  // of the spindle; highest over lowest speed
constexpr double kAround = 0.02;                                      // of a speed: what a pocket must hold
constexpr double kNearPocket = 0.05;                                  // of 60 f_c / (N k): where it is
constexpr double kMostOverLimit = 2.5, kMostWithoutPocket = 2.0;  // times the limit: deeper, and the sensor saturates
constexpr double kAirFor = 0.4, kEntry = 0.05, kExit = 0.1;       // s

class Draw {
 public:
  explicit Draw(std::seed_seq seed) : random_{seed} {}
  double from(double low, double high) { return std::uniform_real_distribution<double>{low, high}(random_); }
  double log_from(double low, double high) { return std::exp(from(std::log(low), std::log(high))); }
  int whole(int low, int high) { return std::uniform_int_distribution<int>{low, high}(random_); }
  bool chance(double share) { return from(0.0, 1.0) < share; }

 private:
  std::mt19937_64 random_;
};

Mode mode(double hz, double damping, double stiffness, double angle, double z = 0.0) {
  const double level = std::sqrt(1.0 - z * z);
  return {kTwoPi * hz, damping, stiffness, {level * std::cos(angle), level * std::sin(angle), z}};
}

// The tool's pair of modes, now and then a second one, and the robot's soft structure.
std::vector<Mode> draw_modes(Draw& draw, double tool_hz) {
  std::vector<Mode> modes;
  const double angle = draw.from(-0.3, 0.3), stiffness = draw.log_from(4e6, 2e7), damping = draw.from(0.01, 0.04);
  const double across = draw.from(0.93, 1.07);
  modes.push_back(mode(tool_hz, damping, stiffness, angle));
  modes.push_back(mode(across * tool_hz, damping * draw.from(0.8, 1.2), stiffness * draw.from(0.85, 1.2),
                       angle + deg_to_rad(90.0)));
  if (draw.chance(0.3)) {
    const double hz = tool_hz * draw.from(1.4, 2.2);
    if (hz < kHighestMode_hz) {
      const double second = stiffness * draw.from(2.0, 4.0), damped = draw.from(0.015, 0.04);
      modes.push_back(mode(hz, damped, second, angle));
      modes.push_back(mode(hz * draw.from(0.96, 1.0), damped, second, angle + deg_to_rad(90.0)));
    }
  }
  double hz = draw.from(10.0, 18.0), soft = draw.log_from(1.2e6, 4e6), direction = draw.from(-0.5, 0.5);
  for (int i = draw.whole(2, 4); i > 0 && hz < 130.0; --i) {
    modes.push_back(mode(hz, draw.from(0.03, 0.06), soft, direction, draw.from(-0.1, 0.1)));
    hz *= draw.from(1.4, 2.6);
    soft *= draw.from(1.5, 3.5);
    direction += deg_to_rad(90.0) + draw.from(-0.3, 0.3);
  }
  sort_modes(modes);
  return modes;
}

Material draw_material(Draw& draw) {
  const bool steel = draw.chance(0.4);
  Material m;
  m.name = steel ? "steel" : "aluminium";
  m.ktc = steel ? draw.from(1700e6, 2200e6) : draw.from(650e6, 950e6);
  m.krc = m.ktc * draw.from(0.3, 0.45);
  m.kac = m.ktc * draw.from(0.05, 0.15);
  m.kte = 1e3 * (steel ? draw.from(10.0, 20.0) : draw.from(5.0, 10.0));
  m.kre = m.kte * draw.from(0.7, 1.0);
  return m;
}

// The spindle's range spans several lobes; the higher their numbers, the shallower the pockets between them.
SpindleLimits draw_spindle(Draw& draw, CellClass kind, double tool_hz, int teeth) {
  const double step = kTwoPi * tool_hz / teeth;  // first of n_k
  const double fastest_lobe = kind == CellClass::none ? draw.from(3.0, 6.0) : draw.from(1.3, 3.3);
  SpindleLimits spindle;
  spindle.max_speed = std::min(step / fastest_lobe, rpm_to_rad_s(24000.0));
  spindle.min_speed = std::max(spindle.max_speed * draw.from(0.4, 0.65), kSlowest);
  spindle.acceleration = rpm_to_rad_s(draw.log_from(2000.0, 8000.0));
  spindle.jerk = spindle.acceleration * draw.from(8.0, 12.0);
  return spindle;
}

RandomCell draw_cell(Draw& draw, CellClass kind) {
  RandomCell cell;
  cell.kind = kind;
  const double tool_hz = draw.log_from(300.0, 1150.0);
  cell.tool.diameter = 1e-3 * draw.from(10.0, 25.0);
  cell.tool.teeth = draw.whole(2, 4);
  cell.tool.pitch.assign(static_cast<std::size_t>(cell.tool.teeth), kTwoPi / cell.tool.teeth);
  cell.tool.runout = 1e-6 * draw.from(0.0, 8.0);
  cell.material = draw_material(draw);
  cell.modes = draw_modes(draw, tool_hz);
  cell.spindle = draw_spindle(draw, kind, tool_hz, cell.tool.teeth);
  const double immersed = draw.from(0.2, 1.1);  // from 1 on: a slot
  cell.cut.milling = immersed >= 1.0 ? Milling::slot : draw.chance(0.6) ? Milling::down : Milling::up;
  cell.cut.radial_depth = std::min(immersed, 1.0) * cell.tool.diameter;
  cell.cut.feed_per_tooth = 1e-3 * draw.from(0.03, 0.08);
  cell.cut.feed_direction = draw.from(0.0, deg_to_rad(90.0));
  cell.cut.spindle_speed = std::lerp(cell.spindle.min_speed, cell.spindle.max_speed, draw.from(0.0, 1.0));
  cell.controller.cycle = 1e-3 * draw.from(4.0, 12.0);
  cell.controller.lag = 1e-3 * draw.from(10.0, 20.0);
  cell.controller.spindle_time_constant = draw.from(0.2, 0.5);
  cell.seed = static_cast<std::uint64_t>(draw.whole(1, 1'000'000));
  if (cell.seed % 2 == 0) cell.free_turn = deg_to_rad(15.0 + static_cast<double>(cell.seed % 46));
  return cell;
}

double chatter_frequency_at(const LobeDiagram& diagram, double speed) {
  const LobePoint* nearest = &diagram.points[0];
  for (int i = 0; i < diagram.point_count; ++i) {
    const LobePoint& point = diagram.points[static_cast<std::size_t>(i)];
    if (std::abs(point.speed - speed) < std::abs(nearest->speed - speed)) nearest = &point;
  }
  return nearest->chatter_frequency_hz;
}

// Chatter that repeats with the spindle looks like runout to the machine's truth (models/chatter_truth.hpp).
bool repeats_with_spindle(const RandomCell& cell) {
  constexpr double kTooNear = 0.06;  // of the spindle's frequency
  const double turns = kTwoPi * cell.chatter_hz / cell.cut.spindle_speed;
  return std::abs(turns - std::round(turns)) < kTooNear;
}

// The best speed near one of n = 60 f_c / (N k), with room about it inside the spindle's range.
void find_pocket(const LobeDiagram& diagram, RandomCell& cell) {
  const double first = kTwoPi * cell.chatter_hz / cell.tool.teeth;
  double best = 0.0;
  for (int i = 0; i < diagram.point_count; ++i) {
    const double speed = diagram.points[static_cast<std::size_t>(i)].speed;
    const double k = std::max(1.0, std::round(first / speed));
    const bool inside = speed * (1.0 - kAround) >= cell.spindle.min_speed &&
                        speed * (1.0 + kAround) <= cell.spindle.max_speed && first / k >= cell.spindle.min_speed &&
                        first / k <= cell.spindle.max_speed;
    if (!inside || std::abs(speed * k / first - 1.0) > kNearPocket) continue;
    const double limit = worst_limit(diagram, speed, kAround);
    if (limit <= best) continue;
    best = limit;
    cell.pocket_speed = speed;
  }
  cell.pocket_margin = best;  // a depth yet
}

// The depth that makes the cell what its class says; none where there is none.
std::optional<double> choose_depth(Draw& draw, const LobeDiagram& diagram, RandomCell& cell) {
  const double part = draw.from(0.0, 1.0);
  const auto between = [&](double low, double high) {
    return low < high ? std::optional{std::lerp(low, high, part)} : std::nullopt;
  };
  const double here = cell.depth_limit;
  if (cell.kind == CellClass::stable) {
    const double most = std::min(worst_limit(diagram, cell.cut.spindle_speed, kAround) / (1.02 + kSound), kDeepest);
    return most > 1e-4 ? between(0.6 * most, most) : std::nullopt;
  }
  const double least = 1.02 * here / (1.0 + kTruly),
               most = std::min((cell.kind == CellClass::none ? kMostWithoutPocket : kMostOverLimit) * here, kDeepest);
  if (cell.kind == CellClass::pocket) return between(least, std::min(most, cell.pocket_margin / (1.02 + kPocket)));
  double deepest = 0.0;
  for (int i = 0; i < diagram.point_count; ++i) {
    const double limit = diagram.points[static_cast<std::size_t>(i)].depth_limit;
    deepest = std::max(deepest, std::isnan(limit) ? 0.0 : limit);
  }
  const double everywhere = 1.02 * deepest / (1.0 + kTruly);
  return between(everywhere, std::min(most, 1.3 * everywhere));
}

// Air, a sound depth, then the depth in question: at once or slowly.
void schedule_into_chatter(Draw& draw, RandomCell& cell, double duration) {
  const double deep = cell.cut.axial_depth, sound = 0.45 * cell.depth_limit;
  const double from = draw.from(1.2, 1.8), until = from + (draw.chance(0.5) ? 0.0 : draw.from(0.4, 1.5));
  cell.deeper_from = from;
  cell.deep_from = until;
  cell.axial_depth = {{0.0, 0.0},
                      {kAirFor, 0.0},
                      {kAirFor + kEntry, sound},
                      {from, sound},
                      {until, deep},
                      {duration - 2.0 * kExit, deep},
                      {duration - kExit, 0.0}};
}

// Passes one after the other, each of a few depths, with air between.
void schedule_passes(Draw& draw, RandomCell& cell, double duration) {
  cell.axial_depth = {{0.0, 0.0}};
  double time = kAirFor;
  while (time + 4.0 < duration || cell.axial_depth.size() == 1) {
    const double room = duration - time - 2.0 * kExit, length = std::min(draw.from(3.0, 8.0), room);
    double depth = cell.cut.axial_depth * draw.from(0.4, 1.0);
    cell.axial_depth.push_back({time, 0.0});
    cell.axial_depth.push_back({time + draw.from(0.03, 0.2), depth});
    for (int steps = draw.whole(1, 3), i = 1; i <= steps; ++i) {
      const double at = time + length * i / (steps + 1);
      const double next = i == 1 ? cell.cut.axial_depth : cell.cut.axial_depth * draw.from(0.4, 1.0);
      cell.axial_depth.push_back({at, depth});
      cell.axial_depth.push_back({at + (draw.chance(0.5) ? 0.0 : 0.2), next});
      depth = next;
    }
    time += length;
    cell.axial_depth.push_back({time, depth});
    cell.axial_depth.push_back({time + kExit, 0.0});
    time += kExit + draw.from(0.4, 1.0);
  }
}

void blur_map(Draw& draw, RandomCell& cell, MapError error) {
  const auto off = [&](double full) { return 1.0 + error.share * draw.from(-full, full); };
  cell.map_modes = cell.modes;
  for (Mode& mode : cell.map_modes) {
    mode.natural_frequency *= off(0.01);
    mode.stiffness *= off(0.1);
    mode.damping_ratio *= off(0.2);
  }
  sort_modes(cell.map_modes);
}

}  // namespace

std::string_view name(CellClass kind) {
  switch (kind) {
    case CellClass::pocket:
      return "pocket";
    case CellClass::none:
      return "none";
    case CellClass::stable:
      return "stable";
  }
  return "";
}

double worst_limit(const LobeDiagram& diagram, double speed, double within) {
  double worst = depth_limit_at(diagram, speed);
  for (int i = 0; i < diagram.point_count; ++i) {
    const LobePoint& point = diagram.points[static_cast<std::size_t>(i)];
    if (std::abs(point.speed - speed) <= within * speed)
      worst = std::min(worst, std::isnan(point.depth_limit) ? 0.0 : point.depth_limit);
  }
  return worst;
}

RandomCell random_cell(CellClass kind, std::uint64_t seed, std::uint64_t index, double duration, MapError error) {
  Draw draw{std::seed_seq{static_cast<std::uint64_t>(kind), seed, index}};
  for (int i = 0; i < kMostDraws; ++i) {
    RandomCell cell = draw_cell(draw, kind);
    if (cell.spindle.max_speed < kLeastRange * cell.spindle.min_speed) continue;
    const LobeDiagram diagram =
        compute_lobe_diagram(cell.tool, cell.material, cell.cut, cell.spindle, cell.modes, {.points = 161});
    cell.depth_limit = depth_limit_at(diagram, cell.cut.spindle_speed);
    cell.chatter_hz = chatter_frequency_at(diagram, cell.cut.spindle_speed);
    if (kind != CellClass::stable &&
        (!(cell.depth_limit > 2e-4 && cell.depth_limit < kDeepest) || repeats_with_spindle(cell)))
      continue;
    if (kind == CellClass::pocket) find_pocket(diagram, cell);
    const std::optional<double> depth = choose_depth(draw, diagram, cell);
    if (!depth) continue;
    cell.cut.axial_depth = *depth;
    cell.pocket_margin = cell.pocket_margin / *depth - 1.0;
    cell.duration = duration;
    if (kind == CellClass::stable) {
      schedule_passes(draw, cell, duration);
    } else {
      schedule_into_chatter(draw, cell, duration);
    }
    blur_map(draw, cell, error);
    return cell;
  }
  throw std::runtime_error("no cell of class " + std::string(name(kind)) + " was found");
}

}  // namespace stillcut::campaign
