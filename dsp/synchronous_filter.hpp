// Takes out of a signal everything that repeats with the spindle: tooth passing, runout, every spindle order at once.
//
// The repeating part is kept as a periodic cubic B-spline over one revolution, y(theta) = sum_k c_k b(theta B - k), and
// learned sample by sample: e = x - y(theta), c_k += g e b_k. It costs eight multiplications a sample whatever the
// number of orders, and follows speed ramps because it lives in angle, not in time. A memory of M revolutions makes a
// notch of about f_spindle / (2 pi M) on either side of each order; chatter between the orders passes untouched. Orders
// up to about a third of the samples a revolution are removed. docs/detection.md has the measured response.
#pragma once

#include <array>
#include <complex>
#include <span>
#include <vector>

#include "dsp/lanes.hpp"
#include "dsp/signals.hpp"

namespace stillcut {

class SynchronousFilter {
 public:
  // Room for up to kMaxKnots knots a revolution on each of `axes` axes; nothing is allocated later.
  explicit SynchronousFilter(int axes);

  // Prepares for a rate of samples a revolution; forgets what was learned when the number of knots has to change.
  // Returns true when it did. samples_per_revolution must be > 0.
  bool set_samples_per_revolution(double samples_per_revolution) noexcept;

  // Memory in revolutions that learning settles to; right after restart() it learns as fast as the data allow.
  void set_memory(double revolutions) noexcept { memory_ = revolutions; }
  // In force now, revolutions.
  [[nodiscard]] double memory() const noexcept;
  void restart() noexcept { learned_revolutions_ = 0.0; }
  // Forgets all but the mean.
  void forget() noexcept;

  // Samples, a lane an axis, each at a spindle angle (revolutions, 0 <= angle < 1). residual = x - synchronous part;
  // without_orders = residual + mean(). Once learned, a step is held to what three times the usual residual would give,
  // so that a knock is not learned and heard again each revolution. A sample that is not finite leaves the table as it
  // is and gives a residual of 0.
  void process(std::span<const double> angles, std::span<const Lanes> x, std::span<Lanes> residual,
               std::span<Lanes> without_orders) noexcept;
  // One sample of every axis.
  void process(double angle, std::span<const float> x, std::span<float> residual) noexcept;

  [[nodiscard]] double learned_revolutions() const noexcept { return learned_revolutions_; }
  // Root mean square of what repeats, without its mean, over a revolution and all axes together. Smoothed over three
  // knots: a sharp edge that is no longer there fades slowly between them.
  [[nodiscard]] double level() const noexcept;
  // How far what repeats moves the sensor: its acceleration integrated twice over the angle, root mean square of all
  // axes together, times the square of the speed (rad/s) that it turns with; m, for samples in m/s^2.
  [[nodiscard]] double displacement(double speed) const noexcept;
  // What repeats `order` times a revolution: its complex amplitude, the phase at angle 0, in units of the samples; 0
  // beyond half the knots.
  [[nodiscard]] std::complex<float> content(int order, int axis) const noexcept;
  // Mean of the repeating part over a revolution: gravity and whatever else is slower than the spindle. The residual
  // plus this mean is the signal without the spindle's orders, and with what lies below them.
  [[nodiscard]] float mean(int axis) const noexcept { return static_cast<float>(mean_[axis]); }

 private:
  static constexpr int kMinKnots = 32, kMaxKnots = 1024;
  static constexpr std::size_t kStretch = kMaxSamplesPerBlock;

  void update_gain() noexcept;
  // At most kStretch samples with the same gain.
  void learn(std::span<const double> angles, const Lanes* x, Lanes* residual, Lanes* without_orders) noexcept;

  int axes_;
  int knots_ = 0;
  double samples_per_revolution_ = 0.0;
  double memory_ = 16.0;
  double learned_revolutions_ = 0.0;
  float gain_ = 0.0F, usual_gain_ = 0.0F;
  int until_gain_ = 0;                   // samples until the gain is worked out again
  Lanes usual_;                          // mean square of the residual
  std::array<double, kMaxAxes> mean_{};  // of the table, kept up as it is learned
  std::vector<Lanes> table_;             // the knots' coefficients
  // Of a stretch of samples: the first of the four knots that each lies between, and their weights.
  std::array<int, kStretch> knot_{};
  std::array<std::array<float, kStretch>, 4> weights_{};
};

}  // namespace stillcut
