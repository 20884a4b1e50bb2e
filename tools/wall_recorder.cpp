#include "tools/wall_recorder.hpp"

#include <cmath>
#include <numbers>

namespace stillcut {

WallRecorder::WallRecorder(Tool tool, double feed_direction)
    : tool_{std::move(tool)}, start_direction_{feed_direction}, passes_(static_cast<std::size_t>(tool_.teeth), 0) {}

// The wall stands on the side where down-milling teeth leave the part and up-milling teeth enter it: phi = pi or 0.
void WallRecorder::add(const MillingState& state, const MillingConditions& conditions, double step) {
  const bool up = conditions.milling == Milling::up;
  const double side = up ? 0.0 : std::numbers::pi, outward = up ? 1.0 : -1.0;  // along the cross-feed axis
  const double feed = conditions.feed_direction;
  along_ += conditions.feed_per_tooth * tool_.teeth * state.spindle_speed / kTwoPi * step;
  const double turned = state.spindle_angle + feed - start_direction_;
  double tooth_angle = 0.0;
  for (std::size_t t = 0; t < passes_.size(); tooth_angle += tool_.pitch[t], ++t) {
    const auto passes = static_cast<std::int64_t>(std::floor((turned + tooth_angle - side) / kTwoPi));
    if (passes == passes_[t]) continue;
    passes_[t] = passes;
    if (state.axial_depth <= 0.0) continue;
    const double cross = -std::sin(feed) * state.displacement.x() + std::cos(feed) * state.displacement.y();
    wall_.push_back({along_, outward * cross + tool_.runout * std::cos(tooth_angle - tool_.runout_angle)});
  }
}

double WallRecorder::roughness() const { return wall_roughness(wall_, 0.5 * tool_.diameter); }

}  // namespace stillcut
