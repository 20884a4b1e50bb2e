// Watches the spectrum of a residual for lines that stand out of their own past: the narrow-band half of chatter
// detection.
//
// Every hop (an eighth of a 25 ms Hann window) the power P of each bin is held against its running floor F. The
// statistic S = P / F, divided by the broad-band rise common to all bins, must stay above the bin's limit for two
// hops. The floor is the clipped running mean of the same bin, so a constant false-alarm rate needs no level to be
// set; the limit is lower near modes that the dynamics map predicts and follows the predicted margin (the prior).
// docs/detection.md.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "dsp/axes_fft.hpp"
#include "dsp/lanes.hpp"

namespace stillcut {

struct ExpectedMode {
  double frequency_hz = 0.0;
  double damping_ratio = 0.0;
};

// Of a mode's frequency: where its regenerative chatter may stand.
inline constexpr double kNearAMode = 0.2;
// Within `share` of the frequency of one of them.
bool near_a_mode(std::span<const ExpectedMode> modes, double frequency_hz, double share) noexcept;

struct LineWatchSettings {
  double window_s = 0.025;
  double lowest_hz = 100.0;
  double highest_of_rate = 0.4;  // of the sample rate
  double limit = 12.0;           // of S, without prior
  double floor_memory_s = 1.0;
  double floor_clip = 4.0;  // a single window raises the floor by no more than this times itself
};

struct LineCandidate {
  double frequency_hz = 0.0;  // to a fraction of a bin
  double ratio = 0.0;         // S over its limit
  int axis = 0;               // where it is strongest
};

class LineWatch {
 public:
  static constexpr int kCandidates = 3, kHopsAWindow = 8;
  static constexpr int kWindowsKept = 4;

  LineWatch(int axes, double sample_rate_hz, const LineWatchSettings& settings);

  // Residual samples, a lane an axis, no more than to_hop(); true when they complete a hop and the results below are
  // new.
  bool push(std::span<const Lanes> residual) noexcept;
  // One sample of every axis.
  bool push(std::span<const float> residual) noexcept;
  // Samples until the next hop is complete.
  [[nodiscard]] int to_hop() const noexcept { return hop_ - filled_; }

  // Of the newest hop: the strongest separate lines, strongest first, and the largest S over its limit.
  [[nodiscard]] std::span<const LineCandidate> candidates() const noexcept { return {candidates_.data(), found_}; }
  [[nodiscard]] double largest_ratio() const noexcept { return found_ > 0 ? candidates_[0].ratio : 0.0; }

  // The line of most power near any expected mode, however long it has been there: chatter that was there before the
  // floor could be learned is part of the floor. Its ratio is the amplitude, in units of the samples; 0: no mode is
  // expected.
  [[nodiscard]] LineCandidate loudest_near_modes() const noexcept;
  // Takes a line out of the floor, so that from now on it stands out until it has lost most of its power.
  void expose(double frequency_hz) noexcept;

  // S over its limit at a frequency, the largest of the bin and its neighbours.
  [[nodiscard]] double ratio_at(double frequency_hz) const noexcept;

  // The newest window of an axis, oldest sample first, and all that is kept of it: kWindowsKept windows.
  [[nodiscard]] std::span<const float> window(int axis) const noexcept {
    return kept(axis).last(static_cast<std::size_t>(length_));
  }
  [[nodiscard]] std::span<const float> kept(int axis) const noexcept {
    return std::span{residual_[axis]}.subspan(static_cast<std::size_t>(begin_), static_cast<std::size_t>(kept_));
  }
  [[nodiscard]] int window_length() const noexcept { return length_; }
  // Of the newest window under its Hann weights, a value a bin, a lane an axis; those between lowest_hz() and
  // highest_hz() are watched.
  [[nodiscard]] std::span<const ComplexLanes> spectrum() const noexcept { return spectrum_; }
  [[nodiscard]] double bin_hz() const noexcept { return bin_hz_; }
  [[nodiscard]] double lowest_hz() const noexcept { return first_ * bin_hz_; }
  [[nodiscard]] double highest_hz() const noexcept { return last_ * bin_hz_; }
  // How far back a whole window can be taken out of kept().
  [[nodiscard]] double longest_lag_s() const noexcept { return (kept_ - length_ - 2) / (bin_hz_ * length_); }
  [[nodiscard]] int hop_length() const noexcept { return hop_; }

  // What all bins of the newest hop have gained together over their floors, the most of any axis: 1 in an even cut.
  [[nodiscard]] double common() const noexcept { return common_; }
  // The floor has seen enough to judge by.
  [[nodiscard]] bool ready() const noexcept { return floor_hops_ >= kHopsToLearn; }
  // Keeps the floor as it is (chatter must not become its own floor).
  void hold_floor(bool hold) noexcept { floor_held_ = hold; }
  // Lets the floor follow quickly again (a new cut has its own noise).
  void relearn_floor() noexcept;
  // Forgets window and history, keeps the floor (after a gap).
  void clear_window() noexcept;

  // Prior: modes at which chatter is expected, and the predicted margin (NaN: unknown).
  void set_prior(std::span<const ExpectedMode> modes, double margin) noexcept;

 private:
  static constexpr int kHopsToStay = 2, kHopsToLearn = 32;

  void make_room() noexcept;
  void finish_hop() noexcept;
  void transform() noexcept;
  [[nodiscard]] float common_rise() const noexcept;
  void judge() noexcept;
  void find_candidates() noexcept;
  [[nodiscard]] double frequency_of_peak(int axis, int bin) const noexcept;

  int axes_, length_, kept_, hop_, bins_, first_, last_;  // lines are sought between bins first_ and last_
  double bin_hz_;
  LineWatchSettings settings_;
  AxesFft fft_;
  std::vector<float> window_;
  std::vector<Lanes> windowed_;
  std::vector<ComplexLanes> spectrum_;
  std::array<std::vector<float>, 3> residual_, power_, floor_;  // of residual_, begin_ .. begin_ + kept_ is valid
  std::array<std::vector<float>, kHopsToStay> history_;         // S of the last hops
  std::vector<float> inverse_limit_, ratio_, over_floor_;
  std::vector<char> near_mode_;          // per bin
  int near_first_ = 0, near_last_ = -1;  // outside of these no bin is near a mode
  int begin_ = 0, filled_ = 0, hops_in_window_ = 0, history_at_ = 0, floor_hops_ = 0;
  float power_scale_;
  bool floor_held_ = false;
  std::array<LineCandidate, kCandidates> candidates_{};
  std::size_t found_ = 0;
  float common_ = 1.0F;
};

// Window length for a duration: a multiple of 8 whose half is even and a product of 2, 3 and 5.
int window_length(double sample_rate_hz, double duration_s) noexcept;

}  // namespace stillcut
