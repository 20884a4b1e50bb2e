// When was a sample taken? The sensor's own counter and rate say; arrival stamps only bound it, because frames cluster
// on a busy bus and in a busy kernel. A frame can be late but never early, so the clock follows the earliest arrivals.
#pragma once

#include <cstdint>

namespace stillcut {

class SampleClock {
 public:
  explicit SampleClock(double sample_rate_hz) : sample_ns_{1e9 / sample_rate_hz} {}

  struct Placed {
    std::int64_t stamp_ns = 0;      // of the block's last sample
    std::int64_t samples_lost = 0;  // before the block
    bool jumped = false;            // the stream stopped or the clock stepped: the count could not bridge it
  };

  // Places a block of `samples` that arrived at `arrival_ns` after `frames_lost` frames were missed (0 without a
  // counter).
  Placed place(std::int64_t arrival_ns, int samples, std::uint32_t frames_lost) noexcept;

 private:
  double sample_ns_;
  double expected_ns_ = 0.0;  // offset of the last sample from origin_ns_
  std::int64_t origin_ns_ = 0;
  bool started_ = false;
};

}  // namespace stillcut
