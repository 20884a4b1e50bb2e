#include "tools/surface_recorder.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

constexpr double kMarkEvery = 20e-6;  // m of way
constexpr std::size_t kMostFloorLengths = 40;
constexpr std::size_t kMostTrackSamples = 40000000;  // half a GiB: of longer cuts the beginning counts

}  // namespace

SurfaceRecorder::SurfaceRecorder(Tool tool, const Cut& cut, double step)
    : tool_{std::move(tool)},
      cut_{cut},
      start_direction_{cut.feed_direction},
      passes_(static_cast<std::size_t>(tool_.teeth), 0) {
  track_.step = step;
}

void SurfaceRecorder::add(const MillingState& state, const MillingConditions& conditions) {
  along_ += conditions.feed_per_tooth * tool_.teeth * state.spindle_speed / kTwoPi * track_.step;
  if (of_floor())
    add_to_track(state, conditions);
  else
    add_passes(state, conditions);
}

// The wall stands on the side where down-milling teeth leave the part and up-milling teeth enter it: phi = pi or 0.
void SurfaceRecorder::add_passes(const MillingState& state, const MillingConditions& conditions) {
  const bool up = conditions.milling == Milling::up;
  const double side = up ? 0.0 : std::numbers::pi, outward = up ? 1.0 : -1.0;  // along the cross-feed axis
  const double feed = conditions.feed_direction;
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

void SurfaceRecorder::add_to_track(const MillingState& state, const MillingConditions& conditions) {
  if (track_.displacement.size() == kMostTrackSamples) return;
  if (track_.marks.empty() || along_ >= track_.marks.back().along + kMarkEvery)
    track_.marks.push_back({.sample = track_.displacement.size(),
                            .along = along_,
                            .angle = state.spindle_angle + conditions.feed_direction - start_direction_,
                            .feed_rate = conditions.feed_per_tooth * tool_.teeth * state.spindle_speed / kTwoPi,
                            .feed_direction = conditions.feed_direction,
                            .axial_depth = state.axial_depth});
  track_.displacement.push_back(state.displacement.cast<float>());
}

double SurfaceRecorder::begin() const {
  if (of_floor()) return track_.marks.empty() ? 0.0 : track_.marks.front().along;
  return wall_.empty() ? 0.0 : wall_.front().along;
}

double SurfaceRecorder::end() const {
  if (of_floor()) return track_.marks.empty() ? 0.0 : track_.marks.back().along;
  return wall_.empty() ? 0.0 : wall_.back().along;
}

std::vector<double> SurfaceRecorder::heights(double from, double spacing, std::size_t count) const {
  if (!of_floor()) return wall_heights(wall_, 0.5 * tool_.diameter, from, spacing, count);
  try {
    return floor_heights(tool_, cut_, track_, from, spacing, count);
  } catch (const std::invalid_argument&) {  // the ball is tilted onto its shank: there is no such floor
    return std::vector<double>(count, kNaN);
  }
}

std::vector<MilledLength> SurfaceRecorder::lengths() const {
  const MilledHeights milled = [this](double from, double spacing, std::size_t count) {
    return heights(from, spacing, count);
  };
  return of_floor() ? milled_lengths(milled, begin(), end(), kMostFloorLengths)
                    : milled_lengths(milled, begin(), end());
}

}  // namespace stillcut
