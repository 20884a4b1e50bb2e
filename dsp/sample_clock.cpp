#include "dsp/sample_clock.hpp"

#include <algorithm>
#include <cmath>

namespace stillcut {
namespace {

// An arrival this far from where the count puts it is not jitter: the stream stopped, or the counter wrapped unseen.
constexpr double kJump_ns = 50e6;
// Time in which the clock would take over a lasting lateness: long enough to keep jitter out, short enough for a sensor
// whose rate is off (it lags by this times the error of the rate: 0.45 ms at 300 ppm).
constexpr double kFollowLate_ns = 1.5e9;
constexpr double kLatenessFollowed_ns =
    2e6;  // of more, as frames have that waited for others, no more than this counts

}  // namespace

SampleClock::Placed SampleClock::place(std::int64_t arrival_ns, int samples, std::uint32_t frames_lost) noexcept {
  if (!started_) {
    started_ = true;
    origin_ns_ = arrival_ns;
    expected_ns_ = 0.0;
    return {arrival_ns, 0, false};
  }
  const std::int64_t lost = std::int64_t{frames_lost} * samples;
  const double arrived_ns = static_cast<double>(arrival_ns - origin_ns_);
  const double counted_ns = expected_ns_ + static_cast<double>(lost + samples) * sample_ns_;
  const double late_ns = arrived_ns - counted_ns;
  if (std::abs(late_ns) > kJump_ns) {
    const double missing_ns = arrived_ns - expected_ns_ - samples * sample_ns_;
    origin_ns_ = arrival_ns;
    expected_ns_ = 0.0;
    return {arrival_ns, std::max<std::int64_t>(0, std::llround(missing_ns / sample_ns_)), true};
  }
  expected_ns_ = late_ns < 0.0 ? arrived_ns
                               : counted_ns + std::min(1.0, samples * sample_ns_ / kFollowLate_ns) *
                                                  std::min(late_ns, kLatenessFollowed_ns);
  return {origin_ns_ + std::llround(expected_ns_), lost, false};
}

}  // namespace stillcut
