#include "adapters/feed_motion.hpp"

#include <algorithm>
#include <cmath>

namespace stillcut {
namespace {

constexpr std::int64_t kWindow_us = 50'000;
constexpr std::int64_t kLongestGap_us = 1'000'000;
constexpr double kStandsStill_m_per_s = 1e-4;  // below it a direction is noise
constexpr double kFastest_m_per_s = 100.0;     // what a robot_state_t may say

}  // namespace

void FeedMotion::add(std::int64_t clock_us, const std::array<double, 3>& position) {
  if (count_ > 0) {
    const std::int64_t since = clock_us - places_[(next_ + kPlaces - 1) % kPlaces].clock_us;
    if (since <= 0 || since > kLongestGap_us) count_ = 0;
  }
  places_[next_] = {clock_us, position};
  next_ = (next_ + 1) % kPlaces;
  count_ = std::min(count_ + 1, kPlaces);
  // The oldest within the window, or the one before the newest where cycles are longer than that.
  std::size_t back = std::min<std::size_t>(count_ - 1, 1);
  while (back + 1 < count_ && clock_us - places_[(next_ + kPlaces - 2 - back) % kPlaces].clock_us <= kWindow_us) ++back;
  rate_ = 0.0;
  if (back == 0) return;
  const Place& from = places_[(next_ + kPlaces - 1 - back) % kPlaces];
  const double seconds = static_cast<double>(clock_us - from.clock_us) * 1e-6;
  const double x = (position[0] - from.position[0]) / seconds, y = (position[1] - from.position[1]) / seconds,
               z = (position[2] - from.position[2]) / seconds;
  rate_ = std::min(std::hypot(x, y, z), kFastest_m_per_s);
  if (std::hypot(x, y) > kStandsStill_m_per_s) direction_ = std::atan2(y, x);
}

}  // namespace stillcut
