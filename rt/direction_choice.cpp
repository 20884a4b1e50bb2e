#include "rt/direction_choice.hpp"

#include <cmath>

#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

constexpr double kHalfTurn = std::numbers::pi;
constexpr double kSameSpeedAsked = 0.02;  // relative
constexpr double kStepDegrees = 5.0;
constexpr double kLeastTurn = 0.05;       // rad; less is no other direction
constexpr double kLeastGainOfTurn = 0.1;  // what is only better must be better by this

}  // namespace

double depth_limit_towards(const LobeDiagram& diagram, double direction) noexcept {
  const int count = diagram.direction_count;
  if (!diagram.valid || count < 1 || count > LobeDiagram::kMaxDirections || !std::isfinite(direction)) return kNaN;
  const double turned = direction - diagram.directions[0].direction;
  const double place = (turned / kHalfTurn - std::floor(turned / kHalfTurn)) * count;
  const auto limit = [&](int i) {
    const double depth = diagram.directions[static_cast<std::size_t>(i % count)].depth_limit;
    return std::isnan(depth) ? 0.0 : depth;
  };
  constexpr double kOnPoint = 1e-6;  // of a spacing: at a direction that is known its own limit holds
  const double nearest = std::round(place);
  if (std::abs(place - nearest) < kOnPoint) return limit(static_cast<int>(nearest));
  const int below = static_cast<int>(place);
  return std::min(limit(below), limit(below + 1));
}

DirectionChoice choose_direction(const DirectionQuestion& q, const CompensationLimits& limits) noexcept {
  DirectionChoice best;
  best.margin_before = best.margin_after = kNaN;
  if (q.lobes == nullptr || !(limits.free_turn > 0.0) || !(q.axial_depth > 0.0)) return best;
  const LobeDiagram& lobes = *q.lobes;
  if (!(std::abs(lobes.direction_speed - q.speed) < kSameSpeedAsked * q.speed)) return best;
  const auto margin_towards = [&](double direction) {
    return depth_limit_towards(lobes, direction) / q.axial_depth - 1.0;
  };
  const double margin_before = margin_towards(q.direction);
  if (std::isnan(margin_before)) return best;
  best.margin_before = margin_before;
  const auto candidate = [&](double direction) {
    DirectionChoice choice;
    choice.margin_before = margin_before;
    choice.direction = direction;
    choice.margin_after = margin_towards(direction);
    choice.stable = (1.0 + choice.margin_after) * (1.0 - lobes.depth_scatter) > 1.0;
    choice.found =
        !(std::abs(direction - q.direction) < kLeastTurn) && choice.margin_after > margin_before + kLeastGainOfTurn;
    return choice;
  };
  // The planned direction in the sense that is nearer to the program's.
  const double planned = std::remainder(lobes.planned_direction - q.programmed_direction, kHalfTurn);
  if (std::abs(planned) <= limits.free_turn) {
    const DirectionChoice choice = candidate(q.programmed_direction + planned);
    if (choice.found && choice.stable) return choice;
  }
  const int steps = static_cast<int>(limits.free_turn / deg_to_rad(kStepDegrees));
  double nearest = kInfinity;
  for (int i = -steps; i <= steps; ++i) {
    const DirectionChoice choice = candidate(q.programmed_direction + i * deg_to_rad(kStepDegrees));
    if (!choice.found) continue;
    const double turn = std::abs(choice.direction - q.direction);
    const bool improves =
        !best.found || (choice.stable && !best.stable) ||
        (choice.stable == best.stable && (choice.stable ? turn < nearest : choice.margin_after > best.margin_after));
    if (!improves) continue;
    best = choice;
    nearest = turn;
  }
  return best;
}

}  // namespace stillcut
