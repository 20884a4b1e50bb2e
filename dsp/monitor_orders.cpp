// Chatter that stands on a spindle order repeats with the spindle. It is told by its growth alone, while speed and
// contact are constant and the orders that the teeth force stay as they are.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "dsp/monitor.hpp"
#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

constexpr double kRevolutionsToLearn = 10.0;  // of constant speed and contact, until the synchronous filter has settled
constexpr double kRevolutionsToJudge = 42.0;
constexpr int kHopsAStep = 2;
// A fall of the whole vibration's power: the tool leaves the cut. A rise out of the cut: it may enter one.
constexpr double kFalls = 2.5, kRises = 1.8;

}  // namespace

void Monitor::follow_orders(std::size_t index, bool trusted) noexcept {
  Sensor& sensor = sensors_[index];
  const SensorPath& path = sensor.path;
  const double spindle_hz = view_.speed / (2.0 * std::numbers::pi);
  const double hop_s = path.watch().hop_length() / path.sample_rate_hz();
  const bool held = gate_.state() != State::cut && gate_.state() != State::air;
  if (!trusted || held || steady_s_ * spindle_hz < kRevolutionsToLearn) {
    sensor.orders.forget();
    sensor.hops_to_orders = kHopsAStep;
    return;
  }
  if (--sensor.hops_to_orders > 0) return;
  sensor.hops_to_orders = kHopsAStep;
  sensor.orders.follow(view_.chatter ? heard_hz_ : kNaN);
  sensor.orders.step(
      path.watch(), path.filter(), {modes_.data(), mode_count_},
      {spindle_hz, path.angle() - 0.5 * spindle_hz / path.bin_hz(), kHopsAStep * hop_s * spindle_hz, settings_.teeth},
      settings_.watch.limit);
}

bool Monitor::look_for_growing_order(std::size_t index, std::int64_t stamp_ns) noexcept {
  const SensorPath& path = sensors_[index].path;
  if (steady_s_ * view_.speed < 2.0 * std::numbers::pi * kRevolutionsToJudge || path.fall() > kFalls) return false;
  if (gate_.state() == State::air && path.rise() > kRises) return false;
  const OrderLine line = sensors_[index].orders.grown();
  if (!(line.frequency_hz > 0.0) || (settings_.teeth > 1 && line.order % settings_.teeth == 0)) return false;
  const LineCandidate candidate{line.frequency_hz, line.ratio / settings_.watch.limit, line.axis};
  const Tone tone{.frequency_hz = line.frequency_hz, .amplitude = line.amplitude};
  if (of_forced(path, tone) < kLeastOfForced) return false;
  suspect_[index].line = Line::on_order;
  begin_chatter(index, stamp_ns, candidate, tone);
  return true;
}

}  // namespace stillcut
