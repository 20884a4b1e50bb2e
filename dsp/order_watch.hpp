// Watches the spindle's own orders for one that grows away from the rest: chatter that stands on an order, as the
// period doubling of an even number of teeth does. It repeats with the spindle, so the synchronous filter learns it,
// and the residual holds no more than its growth within the filter's short memory. What the filter has learned of an
// order since is its residual e added up, so with a filter memory of M revolutions
//
//   u = e + sum of e (revolutions a step) / M,  forgotten over 32 revolutions
//
// is how far the order has moved from what it was, amplitude and phase, in the frame that turns with the spindle.
// docs/detection.md.
#pragma once

#include <array>
#include <complex>
#include <span>

#include "dsp/line_watch.hpp"
#include "dsp/numbers.hpp"
#include "dsp/signals.hpp"
#include "dsp/synchronous_filter.hpp"

namespace stillcut {

struct Turning {
  double spindle_hz = 0.0;
  double angle = 0.0;        // at the middle of the newest window, revolutions
  double revolutions = 0.0;  // since the step before
  int teeth = 1;             // their multiples are the orders that they force; 0: unknown
};

struct OrderLine {
  double frequency_hz = 0.0;  // of what grows there: the order's, and what its phase turns against it; NaN: none
  int order = 0;
  int axis = 0;            // where it has moved most
  double ratio = 0.0;      // power of u over its floor
  double amplitude = 0.0;  // of u, in units of the samples, all axes together
};

class OrderWatch {
 public:
  explicit OrderWatch(int axes) : axes_{axes} {}

  // Speed or contact have changed: what was learned holds no longer.
  void forget() noexcept;
  // Looks at the newest window. Orders near `modes` are watched, where none is given the lowest 32; those of several
  // teeth are never called. An order counts as growing
  // while its power stands `limit` times over its floor. One thread; allocates nothing.
  void step(const LineWatch& watch, const SynchronousFilter& filter, std::span<const ExpectedMode> modes,
            const Turning& turning, double limit) noexcept;

  // The strongest of the orders that have grown for long enough.
  [[nodiscard]] OrderLine grown(const SynchronousFilter& filter) const noexcept;
  // Power of u over its floor of the order nearest to a frequency; NaN: it is not watched, or not for
  // long enough.
  [[nodiscard]] double ratio_at(double frequency_hz) const noexcept;
  // While chatter is followed at a frequency what its order was is kept, and floors with it. NaN: no chatter.
  void follow(double frequency_hz) noexcept { followed_hz_ = frequency_hz; }

 private:
  static constexpr std::size_t kMostOrders = 32, kSteps = 10;

  // How the power of u goes, smoothed more or less: what grows fast is heard soon, what grows slowly out of the noise.
  struct Trend {
    std::array<std::complex<float>, kMaxAxes> u{};
    std::array<float, kSteps> power{};  // of the last steps, newest first, all axes together
    float floor = 0.0F, most = 0.0F;
    int evidence = 0;  // steps in which it grew, less those in which it fell
    [[nodiscard]] float ratio() const noexcept { return floor > 0.0F ? power[0] / floor : 0.0F; }
  };
  struct Order {
    std::array<std::complex<float>, kMaxAxes> learned{}, before{};  // by the filter since; before that
    std::complex<float> turn{};                                     // of u in a step, its mean over some
    Trend fast, slow;
    float changes = 0.0F, usual_changes = 0.0F;  // |e|^2, all axes together
    int order = 0;
    bool near_mode = false, forced = false;  // chatter may stand there; the teeth force it
    bool followed = false;
  };

  void choose(const LineWatch& watch, std::span<const ExpectedMode> modes, const Turning& turning) noexcept;
  void hear(Order& order, std::complex<float> back, const LineWatch& watch, const SynchronousFilter& filter,
            const Turning& turning) noexcept;
  void smooth(Trend& trend, float smoothing, const std::array<std::complex<float>, kMaxAxes>& u) noexcept;
  void judge(Trend& trend, std::size_t steps, float limit, float forced_changes) noexcept;
  [[nodiscard]] bool forced_apart(const Order& order, const Order& from) const noexcept;
  [[nodiscard]] float forced_changes(const Order& but) const noexcept;
  [[nodiscard]] float forced_ratio(const Order& but, Trend Order::*trend) const noexcept;
  [[nodiscard]] bool beyond_what_it_was(const Order& order, const SynchronousFilter& filter) const noexcept;
  [[nodiscard]] float gain() const noexcept;

  int axes_;
  std::array<Order, kMostOrders> orders_{};
  std::size_t watched_ = 0;
  double spindle_hz_ = 0.0, step_s_ = 0.0, bin_hz_ = 0.0;
  int steps_ = 0;
  double followed_hz_ = kNaN;
  bool held_ = false;
};

}  // namespace stillcut
