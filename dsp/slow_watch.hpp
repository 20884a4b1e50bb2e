// Listens for chatter of the robot's structure: lines of 4 to 90 Hz that grow from cycle to cycle. They are too slow
// for the spectrum of the tool's chatter (dsp/line_watch) and too few cycles old, when they must be told, for a fixed
// window; so every frequency has a window of its own, two cycles long, and is held against itself one cycle before.
//
// The samples are thinned out to some 500 a second. A bank of Hann windows, spaced by an eighth of an octave, gives the
// complex amplitude X_a(f) on every axis every 10 ms. Power is summed over the axes: two close modes at right angles,
// each dying out, beat on every axis but not in the sum. docs/detection.md. One thread; nothing allocates after
// construction.
#pragma once

#include <array>
#include <complex>
#include <span>
#include <vector>

#include "dsp/lanes.hpp"
#include "dsp/signals.hpp"

namespace stillcut {

struct SlowLine {
  double frequency_hz = 0.0;
  double amplitude = 0.0;     // m/s^2, all axes together
  double cycle_growth = 0.0;  // amplitude over that one cycle before
  double ratio = 0.0;         // power over its limit
  double evidence = 0.0;      // that it is chatter: 1 is enough
};

class SlowWatch {
 public:
  SlowWatch(int axes, double sample_rate_hz);

  // Samples, a lane an axis, what repeats with the spindle taken out, gravity left in. True when they complete a step:
  // then the lines are new.
  bool push(std::span<const Lanes> x) noexcept;
  // One sample of every axis.
  bool push(std::span<const float> x) noexcept;
  [[nodiscard]] double step_s() const noexcept { return kStep * thinned_ / sample_rate_hz_; }

  // The line for which there is most evidence after the newest step, of all that `allowed(frequency in Hz)` lets pass.
  template <typename Allowed>
  [[nodiscard]] SlowLine best_line(Allowed&& allowed) const noexcept {
    const Band* best = nullptr;
    for (const Band& band : bands_) {
      const bool more = best == nullptr || band.evidence > best->evidence ||
                        (band.evidence == best->evidence && band.power > best->power);
      if (band.evidence > 0.0 && more && allowed(band.line.frequency_hz)) best = &band;
    }
    return best == nullptr ? SlowLine{} : strongest_near(*best);
  }
  // The line at a frequency now.
  [[nodiscard]] SlowLine line_at(double frequency_hz) const noexcept;

  // Keeps the floor as it is (chatter must not become its own floor).
  void hold_floor(bool hold) noexcept { floor_held_ = hold; }
  // Forgets what was heard (after a gap); the floor stays.
  void clear() noexcept;
  // Forgets the evidence (the cut has changed), and lets the floor follow quickly again.
  void relearn_floor() noexcept;
  void forget_evidence() noexcept;

 private:
  static constexpr int kBands = 37, kStep = 5, kHistory = 512;
  static constexpr int kStepsKept = 64;  // more than a cycle of the slowest

  struct Band {
    double frequency_hz = 0.0;
    int length = 0;             // thinned samples, two cycles
    std::vector<float> re, im;  // window: `length` weights, after zeros that make their number a multiple of 4
    std::array<std::array<std::complex<float>, kMaxAxes>, kStepsKept> heard{};
    std::complex<double> turned;  // phasor of a cycle's turn, over the last steps
    double power = 0.0, floor = 0.0, evidence = 0.0;
    bool alone = false;  // a line of its own that turns steadily, not the flank of another
    SlowLine line;
  };

  void thin_out(std::span<const Lanes> x) noexcept;
  bool keep_thinned() noexcept;
  void finish_step() noexcept;
  void listen(Band& band) noexcept;
  void judge(Band& band) noexcept;
  [[nodiscard]] SlowLine strongest_near(const Band& band) const noexcept;

  int axes_, thinned_;
  double sample_rate_hz_;
  std::vector<float> kernel_;  // three parts of thinned_ weights each
  std::array<Lanes, 3> sums_{};
  std::array<std::vector<float>, kMaxAxes> history_;  // 2 * kHistory, of which the newest kHistory are valid
  std::vector<Band> bands_;
  int in_sample_ = 0, at_ = 0, in_step_ = 0, step_ = 0;
  long samples_ = 0, steps_ = 0;  // since the last clear()
  long floor_steps_ = 0;
  double noise_ = 0.0;  // power a hertz of a band's frequency
  bool floor_held_ = false;
};

}  // namespace stillcut
