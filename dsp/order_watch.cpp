#include "dsp/order_watch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dsp/hann_line.hpp"
#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

constexpr double kOrderMemory = 32.0;  // revolutions, of what an order was
constexpr double kSpeedHolds = 0.01;
constexpr int kMostForced = 8;      // orders of the teeth
constexpr double kApartBins = 2.5;  // nearer ones share a window's bins
constexpr int kOrderStepsToLearn = 32;
constexpr float kOrderFloorMemory = 160.0F;  // steps
constexpr float kOrderFloorClip = 4.0F;
constexpr float kOrderGrows = 1.25F;  // power over that of kFastSteps or kSlowSteps before
constexpr float kOrderHolds = 0.9F;   // and over the most since it was suspected
// While the orders of the teeth change by more than they usually do, and by more than this share of what the suspect
// has moved, it is the cut that changes.
constexpr float kUsual = 2.5F, kForcedStands = 0.03F;
constexpr float kStandsOut = 4.0F;  // over the largest ratio of those orders: they have not moved lately
constexpr float kBeyond = 2.0F;
constexpr double kMostOff = 0.4;   // of an order's distance to the next
constexpr float kTurnGain = 0.3F;  // a step
constexpr int kMostOrderEvidence = 32;
constexpr std::size_t kFastSteps = 5, kSlowSteps = 9;
constexpr float kSlowForced = 0.3F;
constexpr float kSlowTrendSmoothing = 0.3F, kSlowTrendLimit = 0.5F;
constexpr int kEnoughFast = 5, kEnoughAfterChange = 8, kEnoughSlow = 14;

using Complex = std::complex<float>;

}  // namespace

void OrderWatch::forget() noexcept {
  watched_ = 0;
  steps_ = 0;
}

void OrderWatch::choose(const LineWatch& watch, std::span<const ExpectedMode> modes, const Turning& turning) noexcept {
  watched_ = 0;
  const int teeth = std::max(1, turning.teeth);
  const auto last = static_cast<int>(watch.highest_hz() / ((1.0 + kSpeedHolds) * turning.spindle_hz));
  int forced = 0;
  for (int order = 1; order <= last && watched_ < kMostOrders; ++order) {
    const double hz = order * turning.spindle_hz;
    const bool callable = teeth == 1 || order % teeth != 0;
    const bool near = callable && hz > watch.lowest_hz() && (modes.empty() || near_a_mode(modes, hz, kNearAMode));
    const bool of_teeth = order % teeth == 0 && hz > 2.0 * watch.bin_hz() && forced < kMostForced;
    if (!near && !of_teeth) continue;
    Order& next = orders_[watched_++] = {};
    next.order = order;
    next.near_mode = near;
    next.forced = of_teeth;
    forced += of_teeth ? 1 : 0;
  }
}

float OrderWatch::gain() const noexcept {
  return held_ ? 0.0F : std::max(1.0F / kOrderFloorMemory, 1.0F / static_cast<float>(steps_));
}

void OrderWatch::step(const LineWatch& watch, const SynchronousFilter& filter, std::span<const ExpectedMode> modes,
                      const Turning& turning, double limit) noexcept {
  if (std::abs(turning.spindle_hz - spindle_hz_) > kSpeedHolds * spindle_hz_) forget();
  if (steps_ == 0) choose(watch, modes, turning);
  spindle_hz_ = turning.spindle_hz;
  ++steps_;
  step_s_ = turning.revolutions / turning.spindle_hz;
  bin_hz_ = watch.bin_hz();
  held_ = !std::isnan(followed_hz_);
  // By the angle that each order has turned: powers of the spindle's own turn.
  const std::complex<double> once = std::polar(1.0, -2.0 * std::numbers::pi * turning.angle);
  std::complex<double> back = 1.0;
  int turned = 0;
  for (std::size_t n = 0; n < watched_; ++n) {
    for (; turned < orders_[n].order; ++turned) back *= once;
    hear(orders_[n], std::complex<float>{back}, watch, filter, turning);
  }
  for (std::size_t n = 0; n < watched_; ++n) {
    Order& order = orders_[n];
    if (!order.near_mode) continue;
    const float forced = forced_changes(order);
    judge(order.fast, kFastSteps, static_cast<float>(limit), forced);
    judge(order.slow, kSlowSteps, kSlowTrendLimit * static_cast<float>(limit), kSlowForced * forced);
  }
}

void OrderWatch::hear(Order& order, Complex back, const LineWatch& watch, const SynchronousFilter& filter,
                      const Turning& turning) noexcept {
  const HannLine line{order.order * turning.spindle_hz / watch.bin_hz(), watch.window_length()};
  const auto keeps = static_cast<float>(turning.revolutions / filter.memory());
  const auto loses = static_cast<float>(turning.revolutions / kOrderMemory);
  const bool followed = held_ && order.order == std::lround(followed_hz_ / spindle_hz_);
  std::array<Complex, kMaxAxes> u{};
  Complex turned{};
  order.changes = 0.0F;
  const ComplexLanes heard = line.in(watch.spectrum());
  for (int a = 0; a < axes_; ++a) {
    const Complex e = Complex{heard.re[a], heard.im[a]} * back;
    order.changes += std::norm(e);
    if (followed) {  // the sum is not exact for as long as that; the filter itself knows
      const Complex content = filter.content(order.order, a);
      if (!order.followed) order.before[a] = content - order.learned[a];
      order.learned[a] = content - order.before[a];
    } else {
      order.learned[a] += keeps * e - loses * order.learned[a];
    }
    u[a] = e + order.learned[a];
    turned += u[a] * std::conj(order.fast.u[a]);
  }
  order.followed = followed;
  order.turn += kTurnGain * (turned - order.turn);
  const float highest = steps_ <= kOrderStepsToLearn ? order.changes : kOrderFloorClip * order.usual_changes;
  order.usual_changes += gain() * (std::min(order.changes, highest) - order.usual_changes);
  smooth(order.fast, 1.0F, u);
  smooth(order.slow, kSlowTrendSmoothing, u);
}

void OrderWatch::smooth(Trend& trend, float smoothing, const std::array<Complex, kMaxAxes>& u) noexcept {
  float power = 0.0F;
  for (int a = 0; a < axes_; ++a) {
    trend.u[a] += smoothing * (u[a] - trend.u[a]);
    power += std::norm(trend.u[a]);
  }
  std::copy_backward(trend.power.begin(), trend.power.end() - 1, trend.power.end());
  trend.power[0] = power;
  const float highest = steps_ <= kOrderStepsToLearn ? power : kOrderFloorClip * trend.floor;
  trend.floor += gain() * (std::min(power, highest) - trend.floor);
}

void OrderWatch::judge(Trend& trend, std::size_t steps, float limit, float forced_changes) noexcept {
  const float power = trend.power[0];
  if (steps_ <= kOrderStepsToLearn || !(power > limit * trend.floor)) {
    trend.evidence = std::max(0, trend.evidence - 1);
    if (trend.evidence == 0) trend.most = 0.0F;
    return;
  }
  const bool holds = power > kOrderHolds * trend.most;
  const bool grows = holds && power > kOrderGrows * trend.power[steps] && forced_changes < kForcedStands * power;
  trend.most = std::max(trend.most, power);
  trend.evidence = std::clamp(trend.evidence + (grows ? 1 : holds ? 0 : -1), 0, kMostOrderEvidence);
}

// The teeth force it, and it shares no bins with the other.
bool OrderWatch::forced_apart(const Order& order, const Order& from) const noexcept {
  return order.forced && std::abs(order.order - from.order) * spindle_hz_ > kApartBins * bin_hz_;
}

float OrderWatch::forced_changes(const Order& but) const noexcept {
  float sum = 0.0F;
  for (std::size_t n = 0; n < watched_; ++n) {
    const Order& order = orders_[n];
    if (forced_apart(order, but)) sum += std::max(0.0F, order.changes - kUsual * order.usual_changes);
  }
  return sum;
}

float OrderWatch::forced_ratio(const Order& but, Trend Order::*trend) const noexcept {
  float most = 0.0F;
  for (std::size_t n = 0; n < watched_; ++n) {
    if (forced_apart(orders_[n], but)) most = std::max(most, (orders_[n].*trend).ratio());
  }
  return most;
}

// A deeper cut makes forced orders larger, in proportion and somewhat beyond.
bool OrderWatch::beyond_what_it_was(const Order& order, const SynchronousFilter& filter) const noexcept {
  float before = 0.0F;
  for (int a = 0; a < axes_; ++a) before += std::norm(filter.content(order.order, a) - order.learned[a]);
  return order.fast.power[0] > kBeyond * kBeyond * before;
}

OrderLine OrderWatch::grown(const SynchronousFilter& filter) const noexcept {
  OrderLine line{.frequency_hz = kNaN};
  for (std::size_t n = 0; n < watched_; ++n) {
    const Order& order = orders_[n];
    if (!order.near_mode || order.fast.ratio() < line.ratio) continue;
    const auto alone = [&](Trend Order::*trend) {
      return (order.*trend).ratio() > kStandsOut * forced_ratio(order, trend);
    };
    const bool alone_enough = (order.fast.evidence >= kEnoughFast && alone(&Order::fast)) ||
                              (order.slow.evidence >= kEnoughSlow && alone(&Order::slow));
    const bool enough = alone_enough || order.fast.evidence >= kEnoughAfterChange;
    if (!enough || !beyond_what_it_was(order, filter)) continue;
    int axis = 0;
    for (int a = 1; a < axes_; ++a) {
      if (std::norm(order.slow.u[a]) > std::norm(order.slow.u[axis])) axis = a;
    }
    const double most_off_hz = kMostOff * spindle_hz_;
    const double off_hz =
        std::clamp(std::arg(order.turn) / (2.0 * std::numbers::pi * step_s_), -most_off_hz, most_off_hz);
    line = {order.order * spindle_hz_ + off_hz, order.order, axis, order.fast.ratio(), std::sqrt(order.fast.power[0])};
  }
  return line;
}

double OrderWatch::ratio_at(double frequency_hz) const noexcept {
  for (std::size_t n = 0; n < watched_; ++n) {
    const Order& order = orders_[n];
    if (order.order == std::lround(frequency_hz / spindle_hz_) && order.fast.floor > 0.0F) return order.fast.ratio();
  }
  return kNaN;
}

}  // namespace stillcut
