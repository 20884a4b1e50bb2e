// How fast the residual's vibration at the expected modes dies out, while the cut is still sound: as the margin fades
// the decay goes to zero, and beyond it vibration grows.
//
// Noise in the cutting force keeps the modes ringing. A mode that decays by exp(-s t) makes the correlation of two
// windows that lie a time t apart fall as exp(-s t), whatever the window; white noise has none between windows that do
// not overlap. So from the correlations over one and two window lengths T
//
//   s = log(|R(T)| / |R(2T)|) / T.
#pragma once

#include <array>
#include <complex>
#include <span>

#include "dsp/line_watch.hpp"
#include "dsp/signals.hpp"

namespace stillcut {

struct ModeDecay {
  double frequency_hz = 0.0;  // the mode's; NaN: none could be measured
  double per_s = 0.0;         // 1/s; NaN: dies out within a window, or is lost in noise
};

class DecayWatch {
 public:
  explicit DecayWatch(int axes) : axes_{axes} {}

  // The cut is another one: what was heard holds no longer.
  void forget() noexcept { hops_ = 0; }
  // Looks at the newest window, once a hop, at the first four modes in the watched band. One thread; allocates nothing.
  void step(const LineWatch& watch, std::span<const ExpectedMode> modes) noexcept;
  // Of the mode that decays slowest.
  [[nodiscard]] ModeDecay slowest() const noexcept;

 private:
  static constexpr std::size_t kMostModes = 4, kHopsAWindow = LineWatch::kHopsAWindow, kKept = 2 * kHopsAWindow + 1;
  using Complex = std::complex<float>;

  struct Heard {
    double frequency_hz = 0.0;
    std::array<std::array<Complex, kMaxAxes>, kKept> line{};  // a ring of the last hops
    float power = 0.0F;
    Complex over_one{}, over_two{};  // correlations over one and two windows
  };

  int axes_;
  std::array<Heard, kMostModes> heard_{};
  std::size_t modes_ = 0;
  int hops_ = 0;
  double window_s_ = 0.0;
};

}  // namespace stillcut
