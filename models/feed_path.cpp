#include "models/feed_path.hpp"

#include <algorithm>
#include <stdexcept>

namespace stillcut {

FeedState feed_state(const FeedPath& path, double time) {
  if (!(path.jerk_time > 0.0) || !(path.constant_time >= 0.0))
    throw std::invalid_argument("a feed path needs a jerk time above 0 and a constant time of 0 or more");
  const double highest = path.feed_rate / (path.jerk_time + path.constant_time);
  const double jerk = highest / path.jerk_time;
  FeedState state{0.0, 0.0, 0.0};
  // Each phase takes the state on from where the last one left it.
  const auto phase = [&](double duration, double phase_jerk) {
    const double t = std::clamp(time, 0.0, duration);
    state.travel += t * (state.speed + t * (state.acceleration / 2.0 + t * phase_jerk / 6.0));
    state.speed += t * (state.acceleration + t * phase_jerk / 2.0);
    state.acceleration += t * phase_jerk;
    time -= duration;
    return time <= 0.0;
  };
  if (phase(path.jerk_time, jerk) || phase(path.constant_time, 0.0) || phase(path.jerk_time, -jerk)) return state;
  return {state.travel + time * path.feed_rate, path.feed_rate, 0.0};
}

Eigen::Vector3d feed_position(const FeedPath& path, double time) {
  return path.start + feed_state(path, time).travel * path.direction;
}

}  // namespace stillcut
