// Chatter that stands on a spindle order repeats with the spindle. It is told by its growth alone, while speed and
// contact are constant and the orders that the teeth force stay as they are.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "dsp/monitor.hpp"
#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

constexpr double kRevolutionsToSettle =
    10.0;  // of constant speed and contact, until the synchronous filter has settled
constexpr double kRevolutionsToJudge = 42.0;
constexpr int kHopsAStep = 2;
// A fall of the whole vibration's power: the tool leaves the cut. A rise out of the cut: it may enter one.
constexpr double kFalls = 2.5, kRises = 1.8;

constexpr double kForcedEvery_s = 0.25, kForcedShare = 0.5, kOnMode_hz = 3.0;

// Of an order in the power of all that repeats.
double share_of_order(const SensorPath& path, int order) noexcept {
  const double level = path.synchronous_level();
  double power = 0.0;
  for (int a = 0; a < path.axes(); ++a) power += 0.5 * std::norm(path.filter().content(order, a));
  return level > 0.0 ? power / (level * level) : 0.0;
}

}  // namespace

void Monitor::follow_orders(std::size_t index, bool trusted) noexcept {
  Sensor& sensor = sensors_[index];
  SensorPath& path = sensor.path;
  const bool judged = gate_.state() == State::cut || gate_.state() == State::air;
  const bool settled = steady_s_ * spindle_hz() >= kRevolutionsToSettle;
  if (path.take_table_change() || !trusted || !judged || !settled) {
    sensor.orders.forget();
    sensor.hops_to_orders = kHopsAStep;
    return;
  }
  if (--sensor.hops_to_orders > 0) return;
  sensor.hops_to_orders = kHopsAStep;
  sensor.orders.follow(view_.chatter ? heard_hz_ : kNaN);
  // path.angle() is that of the newest sample, the last of the window.
  const double rate_hz = path.sample_rate_hz(), since_middle_s = 0.5 / path.bin_hz() - 1.0 / rate_hz;
  const double step_s = kHopsAStep * path.watch().hop_length() / rate_hz;
  sensor.orders.step(
      path.watch(), path.filter(), modes(),
      {spindle_hz(), path.angle() - spindle_hz() * since_middle_s, step_s * spindle_hz(), settings_.teeth},
      settings_.watch.limit);
}

bool Monitor::look_for_growing_order(std::size_t index, std::int64_t stamp_ns) noexcept {
  const SensorPath& path = sensors_[index].path;
  if (steady_s_ * spindle_hz() < kRevolutionsToJudge || path.fall() > kFalls) return false;
  if (gate_.state() == State::air && path.rise() > kRises) return false;
  const OrderLine line = sensors_[index].orders.grown(path.filter());
  if (!(line.frequency_hz > 0.0)) return false;
  const LineCandidate candidate{line.frequency_hz, line.ratio / settings_.watch.limit, line.axis};
  const Tone tone{.frequency_hz = line.frequency_hz, .amplitude = line.amplitude};
  if (of_forced(path, tone) < kLeastOfForced) return false;
  suspect_[index].line = Line::on_order;
  begin_chatter(index, stamp_ns, candidate, tone);
  return true;
}

// A strong order that stands on a mode is forced vibration as far as can be told; were it chatter, it would stay where
// it is when the speed changes.
void Monitor::look_for_forced_vibration(std::size_t index, std::int64_t stamp_ns, double step_s) noexcept {
  if (index != 0) return;
  if (gate_.state() != State::cut) {
    forced_order_ = 0;
    until_forced_s_ = kForcedEvery_s;
    return;
  }
  until_forced_s_ -= step_s;
  if (until_forced_s_ > 0.0 || view_.chatter) return;
  until_forced_s_ = kForcedEvery_s;
  if (steady_s_ * spindle_hz() < kRevolutionsToSettle) return;
  int strongest = 0;
  double most = 0.0;
  for (const ExpectedMode& mode : modes()) {
    const auto order = static_cast<int>(std::lround(mode.frequency_hz / spindle_hz()));
    const double reach_hz = std::max(kOnMode_hz, mode.damping_ratio * mode.frequency_hz);
    if (order < 1 || std::abs(order * spindle_hz() - mode.frequency_hz) > reach_hz) continue;
    const double share = share_of_order(sensors_[index].path, order);
    const double least = order == forced_order_ ? 0.5 * kForcedShare : kForcedShare;
    if (share < least || share <= most) continue;
    most = share;
    strongest = order;
  }
  if (strongest != 0 && strongest != forced_order_) {
    char note[96];
    std::snprintf(note, sizeof note,
                  "order %d stands on a mode, %.0f %% of the vibration; a speed 1-2 %% off would tell", strongest,
                  100.0 * std::min(1.0, most));
    emit(stamp_ns, EventType::forced_vibration, ChatterKind::unknown, strongest * spindle_hz(), note);
  }
  forced_order_ = strongest;
}

void Monitor::follow_decay(std::size_t index, bool able) noexcept {
  if (!able || view_.chatter || gate_.state() != State::cut) {
    for (Sensor& each : sensors_) each.decay.forget();
  } else {
    sensors_[index].decay.step(sensors_[index].path.watch(), modes());
  }
  view_.decay_per_s = view_.decay_frequency_hz = kNaN;
  for (const Sensor& each : sensors_) {
    const ModeDecay slowest = each.decay.slowest();
    if (std::isnan(slowest.per_s) || slowest.per_s >= view_.decay_per_s) continue;
    view_.decay_per_s = slowest.per_s;
    view_.decay_frequency_hz = slowest.frequency_hz;
  }
}

}  // namespace stillcut
