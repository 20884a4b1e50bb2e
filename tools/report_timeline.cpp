#include "tools/report_timeline.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace stillcut {
namespace {

int gravity(State state) {
  constexpr std::array<State, kStates> kRising{State::idle, State::air,         State::exit,  State::entry,
                                               State::cut,  State::cannot_tell, State::fault, State::chatter};
  return static_cast<int>(std::find(kRising.begin(), kRising.end(), state) - kRising.begin());
}

void join(TimelinePoint& into, const TimelinePoint& other) {
  into.state = graver(into.state, other.state);
  into.indicator = std::fmax(into.indicator, other.indicator);  // fmax and fmin pass NaN over
  into.low_rpm = std::fmin(into.low_rpm, other.low_rpm);
  into.high_rpm = std::fmax(into.high_rpm, other.high_rpm);
  into.level = std::fmax(into.level, other.level);
}

}  // namespace

State graver(State a, State b) { return gravity(b) > gravity(a) ? b : a; }

void Timeline::add(const TimelinePoint& seen) {
  const auto place_of = [&] { return static_cast<std::size_t>(std::max(0.0, seen.begin_s) / step_s_); };
  while (place_of() >= kMost) join_neighbours();
  const std::size_t place = place_of();
  while (points_.size() <= place) points_.push_back({.begin_s = static_cast<double>(points_.size()) * step_s_});
  join(points_[place], seen);
}

void Timeline::join_neighbours() {
  step_s_ *= 2.0;
  const std::size_t count = (points_.size() + 1) / 2;
  for (std::size_t i = 0; i < count; ++i) {
    TimelinePoint joined = points_[2 * i];
    if (2 * i + 1 < points_.size()) join(joined, points_[2 * i + 1]);
    joined.begin_s = static_cast<double>(i) * step_s_;
    points_[i] = joined;
  }
  points_.resize(count);
}

}  // namespace stillcut
