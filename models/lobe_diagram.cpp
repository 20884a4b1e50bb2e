#include "models/lobe_diagram.hpp"

#include <algorithm>
#include <cmath>

#include "dsp/numbers.hpp"

namespace stillcut {

double place_among_points(const LobeDiagram& diagram, double speed) noexcept {
  if (!diagram.valid || diagram.point_count < 2) return kNaN;
  const auto last = static_cast<std::size_t>(std::min(diagram.point_count, LobeDiagram::kMaxPoints)) - 1;
  const double first_speed = diagram.points[0].speed, last_speed = diagram.points[last].speed;
  const double rounding = 1e-9 * last_speed;  // a speed at the spindle's limit may differ in its last bits
  if (!(speed >= first_speed - rounding && speed <= last_speed + rounding && last_speed > first_speed)) return kNaN;
  return std::clamp((speed - first_speed) / (last_speed - first_speed), 0.0, 1.0) * static_cast<double>(last);
}

double depth_limit_at(const LobeDiagram& diagram, double speed) noexcept {
  const double place = place_among_points(diagram, speed);
  if (std::isnan(place)) return kNaN;
  const auto limit = [&](double index) {
    const double depth = diagram.points[static_cast<std::size_t>(index)].depth_limit;
    return std::isnan(depth) ? 0.0 : depth;
  };
  constexpr double kOnPoint = 1e-6;  // of a spacing: at a point its own limit holds
  const double nearest = std::round(place);
  if (std::abs(place - nearest) < kOnPoint) return limit(nearest);
  return std::min(limit(std::floor(place)), limit(std::ceil(place)));
}

double margin_at(const LobeDiagram& diagram, double speed, double axial_depth) noexcept {
  if (!(axial_depth > 0.0)) return kNaN;
  return depth_limit_at(diagram, speed) / axial_depth - 1.0;
}

}  // namespace stillcut
