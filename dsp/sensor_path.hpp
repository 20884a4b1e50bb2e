// One accelerometer's way through the monitor: check the samples, turn the spindle angle, take out what repeats with
// the spindle, watch the rest for lines. Knows of gaps: missing samples are bridged with silence and counted.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>

#include "dsp/integrity.hpp"
#include "dsp/lanes.hpp"
#include "dsp/line_watch.hpp"
#include "dsp/signals.hpp"
#include "dsp/slow_watch.hpp"
#include "dsp/stage_probe.hpp"
#include "dsp/synchronous_filter.hpp"

namespace stillcut {

struct SensorSettings {
  double sample_rate_hz = 0.0;
  std::uint8_t axes_present = 1;  // bit 0 x, 1 y, 2 z
};

class SensorPath {
 public:
  SensorPath(const SensorSettings& sensor, const LineWatchSettings& watch);

  void set_probe(const StageProbe& probe) noexcept { probe_ = probe; }

  // Missing samples before the block that follows: the angle turns on, the window is bridged or cleared.
  void skip(std::int64_t samples, double speed) noexcept;

  // Feeds samples from index `from` on until a hop is complete or the block ends; returns the index after the last one
  // used. `speed` is the spindle speed at the block, rad/s.
  int process(const SampleBlock& block, int from, double speed) noexcept;

  // True when the last process() ended on a complete hop.
  [[nodiscard]] bool hop_complete() const noexcept { return hop_complete_; }
  // Doubts raised by samples that are still in the window.
  [[nodiscard]] std::uint32_t doubts() const noexcept;
  // Root mean square of the whole (not residual) signal without its mean, all axes together, over the last three
  // revolutions or 30 ms, m/s^2. A plain mean: it forgets a loud cut as soon as the cut is over.
  [[nodiscard]] double level() const noexcept { return level_; }
  // The same of what repeats with the spindle alone.
  [[nodiscard]] double synchronous_level() const noexcept { return synchronous_level_; }
  // The same of what does not repeat.
  [[nodiscard]] double residual_level() const noexcept { return residual_level_; }

  // The largest fall and rise of power, from one revolution to any later one, within the last quarter of a second, as
  // ratios. After a fall the tool has left the cut for a moment, or a knock has died out; after a rise it may have
  // entered one: what rings now may be no more than that.
  [[nodiscard]] double fall() const noexcept { return fall_; }
  [[nodiscard]] double rise() const noexcept { return rise_; }

  [[nodiscard]] LineWatch& watch() noexcept { return watch_; }
  [[nodiscard]] const LineWatch& watch() const noexcept { return watch_; }
  [[nodiscard]] SlowWatch& slow() noexcept { return slow_; }
  [[nodiscard]] const SlowWatch& slow() const noexcept { return slow_; }
  // True once for every step that slow() has completed since it was last asked.
  bool take_slow_step() noexcept { return std::exchange(slow_stepped_, false); }
  [[nodiscard]] SynchronousFilter& filter() noexcept { return filter_; }
  [[nodiscard]] const SynchronousFilter& filter() const noexcept { return filter_; }
  [[nodiscard]] double sample_rate_hz() const noexcept { return rate_; }
  // True once after what the filter knew was lost, as its table had to get another size.
  bool take_table_change() noexcept { return std::exchange(table_changed_, false); }
  [[nodiscard]] int axes() const noexcept { return axes_; }
  // Spindle angle at the newest sample, revolutions, 0 to 1.
  [[nodiscard]] double angle() const noexcept { return revolutions_; }
  [[nodiscard]] double bin_hz() const noexcept { return rate_ / watch_.window_length(); }

 private:
  static constexpr std::size_t kLevelHops = 128;

  void look_for_doubts(const SampleBlock& block, int from, std::span<const Lanes> x) noexcept;
  void turn(double step, std::span<double> angles) noexcept;
  // x without its mean goes to `alternating`; its power is part of the level.
  void follow_mean(std::span<const Lanes> x, std::span<Lanes> alternating) noexcept;
  void update_level(double revolution_s) noexcept;
  void update_changes(double revolution_s) noexcept;
  void raise(std::uint32_t doubts) noexcept;

  StageProbe probe_;
  double rate_;
  std::uint8_t axes_present_;
  int axes_;
  std::array<int, kMaxAxes> axis_{};  // columns of the block that this sensor fills
  SampleCheck check_;
  double revolutions_ = 0.0;  // spindle angle, 0..1
  SynchronousFilter filter_;
  LineWatch watch_;
  SlowWatch slow_;
  Lanes mean_, slow_sample_;
  // What the stages hand on to each other.
  std::array<double, kMaxSamplesPerBlock> angles_{};
  std::array<Lanes, kMaxSamplesPerBlock> x_{}, residual_{}, without_orders_{};
  double hop_power_ = 0.0, hop_residual_ = 0.0;                  // sums of squares in the present hop
  std::array<double, kLevelHops> powers_{}, residual_powers_{};  // of the last hops, rings
  std::size_t newest_power_ = 0;
  double level_ = 0.0, synchronous_level_ = 0.0, residual_level_ = 0.0, fall_ = 1.0, rise_ = 1.0;
  std::int64_t samples_ = 0;                               // processed so far
  std::array<std::int64_t, kDoubtCount> doubted_until_{};  // the sample at which each doubt has left the window
  bool hop_complete_ = false, slow_stepped_ = false, table_changed_ = false;
};

}  // namespace stillcut
