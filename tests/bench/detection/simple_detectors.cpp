#include <algorithm>
#include <cmath>
#include <complex>

#include "dsp/fft.hpp"
#include "tests/bench/detection/detectors.hpp"

namespace stillcut::detection {
namespace {

constexpr double kHoldOff = 5.0;    // revolutions after an entry
constexpr double kLearned = 10.0;   // revolutions in which a detector learns what is usual, after that
constexpr double kRelease_s = 0.1;  // below the limit, then the episode is over
constexpr double kLevelWindow_s = 0.02, kLevelLimit = 2.0;  // of the usual level
constexpr std::size_t kVarianceTurns = 10;
constexpr double kVarianceLimit = 10.0;  // of the usual variance
constexpr std::size_t kMeanTurns = 12;
constexpr double kEnergyLimit = 0.2;
constexpr double kSpectrum_s = 0.1, kSpectrumHop_s = 0.025, kLineLimit = 0.5;  // of the largest order's amplitude
constexpr double kLowestLine_hz = 100.0, kHighestOfSampleRate = 0.4;

// In the cut, by the plan, for so many revolutions and so long that a detector's memory holds nothing else.
class Contact {
 public:
  explicit Contact(const CutPlan& plan, double turns = kHoldOff, double seconds = 0.0)
      : plan_{plan}, turns_{turns}, seconds_{seconds} {}
  bool judges(double time, double turns) {
    if (!(value_at(plan_.schedule.axial_depth, time) > 0.0)) {
      since_ = -1.0;
    } else if (since_ < 0.0) {
      since_ = turns;
      since_s_ = time;
    }
    return since_ >= 0.0 && turns - since_ > turns_ && time - since_s_ > seconds_;
  }

 private:
  const CutPlan& plan_;
  double turns_, seconds_;
  double since_ = -1.0, since_s_ = 0.0;
};

class Episodes {
 public:
  void judge(bool above, double time, double frequency_hz = kNaN) {
    if (above && !open_) {
      Alarm alarm;
      alarm.time = time;
      alarm.frequency_hz = frequency_hz;
      alarms_.push_back(alarm);
    }
    if (above) above_at_ = time;
    const bool was_open = open_ || above;
    open_ = above || (open_ && time - above_at_ < kRelease_s);
    if (was_open && !open_) alarms_.back().end = time;
  }
  std::vector<Alarm> take() { return std::move(alarms_); }

 private:
  std::vector<Alarm> alarms_;
  bool open_ = false;
  double above_at_ = 0.0;
};

double time_of(const CutPlan& plan, std::size_t sample) {
  return static_cast<double>(sample + 1) / plan.sensor_rate_hz;
}

double power_of(const std::array<float, 2>& sample) {
  return static_cast<double>(sample[0]) * sample[0] + static_cast<double>(sample[1]) * sample[1];
}

// The mean of what is heard while the first revolutions are judged: what is usual in this cut.
class Usual {
 public:
  // Whether it is known by now.
  bool learn(double value, double turns) {
    if (from_ < 0.0) from_ = turns;
    if (turns - from_ > kLearned && count_ > 0) return true;
    sum_ += value;
    ++count_;
    return false;
  }
  [[nodiscard]] double value() const { return sum_ / count_; }

 private:
  double from_ = -1.0, sum_ = 0.0;
  int count_ = 0;
};

// A sample at a spindle angle, in between the sensor's.
std::array<double, 2> sample_at(const MilledCut& cut, std::size_t after, double turn) {
  const double part = (turn - cut.turns[after - 1]) / (cut.turns[after] - cut.turns[after - 1]);
  const auto &a = cut.samples[after - 1], &b = cut.samples[after];
  return {std::lerp(double{a[0]}, double{b[0]}, part), std::lerp(double{a[1]}, double{b[1]}, part)};
}

double variance(std::span<const std::array<double, 2>> values) {
  double sum[2]{}, square = 0.0;
  for (const auto& value : values) {
    sum[0] += value[0];
    sum[1] += value[1];
    square += value[0] * value[0] + value[1] * value[1];
  }
  const auto n = static_cast<double>(values.size());
  return (square - (sum[0] * sum[0] + sum[1] * sum[1]) / n) / (n - 1.0);
}

// The strongest line between the orders over the strongest order.
struct StrongestLine {
  double ratio = 0.0, hz = 0.0;
};

StrongestLine line_between_orders(std::span<const std::complex<float>> x, std::span<const std::complex<float>> y,
                                  double bin_hz, double spindle_hz, double rate_hz) {
  double order = 0.0, line = 0.0, hz = 0.0;
  const auto bins = std::min(x.size(), static_cast<std::size_t>(kHighestOfSampleRate * rate_hz / bin_hz));
  for (auto k = static_cast<std::size_t>(kLowestLine_hz / bin_hz); k < bins; ++k) {
    const double f = static_cast<double>(k) * bin_hz, power = std::norm(x[k]) + std::norm(y[k]);
    const bool on_order = std::abs(f - spindle_hz * std::round(f / spindle_hz)) < 2.0 * bin_hz;
    if (on_order)
      order = std::max(order, power);
    else if (power > line)
      line = power, hz = f;
  }
  return {std::sqrt(line / std::max(order, 1e-30)), hz};
}

}  // namespace

std::vector<Alarm> ask_level(const CutPlan& plan, const MilledCut& cut) {
  Contact contact{plan};
  Episodes episodes;
  Usual usual;
  const auto window = static_cast<std::size_t>(kLevelWindow_s * plan.sensor_rate_hz);
  double sum = 0.0;
  for (std::size_t i = 0; i < cut.samples.size(); ++i) {
    sum += power_of(cut.samples[i]) - (i >= window ? power_of(cut.samples[i - window]) : 0.0);
    const double time = time_of(plan, i), level = std::sqrt(std::max(0.0, sum) / static_cast<double>(window));
    if (contact.judges(time, cut.turns[i]) && usual.learn(level, cut.turns[i]))
      episodes.judge(level > kLevelLimit * usual.value(), time);
  }
  return episodes.take();
}

std::vector<Alarm> ask_once_per_revolution(const CutPlan& plan, const MilledCut& cut) {
  Contact contact{plan};
  Episodes episodes;
  Usual usual;
  std::vector<std::array<double, 2>> once;
  for (std::size_t i = 1; i < cut.samples.size(); ++i) {
    const double turn = std::floor(cut.turns[i]), time = time_of(plan, i);
    const bool judges = contact.judges(time, cut.turns[i]);
    if (!judges) once.clear();
    if (!judges || turn == std::floor(cut.turns[i - 1])) continue;
    once.push_back(sample_at(cut, i, turn));
    if (once.size() < kVarianceTurns) continue;
    const double now = variance(std::span{once}.last(kVarianceTurns));
    if (usual.learn(now, turn)) episodes.judge(now > kVarianceLimit * usual.value(), time);
  }
  return episodes.take();
}

// Residual: what differs from the mean of the last twelve revolutions at the same angle; its share of all energy, over
// one revolution.
std::vector<Alarm> ask_energy_ratio(const CutPlan& plan, const MilledCut& cut) {
  Contact contact{plan, kHoldOff + static_cast<double>(kMeanTurns)};
  Episodes episodes;
  std::array<std::size_t, kMeanTurns> past{};
  std::vector<double> rest(cut.samples.size()), all(cut.samples.size());
  double rest_sum = 0.0, all_sum = 0.0;
  std::size_t first = 0;  // of the present revolution
  for (std::size_t i = 0; i < cut.samples.size(); ++i) {
    const double time = time_of(plan, i);
    const bool judges = contact.judges(time, cut.turns[i]);
    if (cut.turns[i] - cut.turns[0] <= static_cast<double>(kMeanTurns)) continue;
    std::array<double, 2> mean{};
    for (std::size_t r = 0; r < kMeanTurns; ++r) {
      const double turn = cut.turns[i] - static_cast<double>(r + 1);
      while (cut.turns[past[r] + 1] <= turn) ++past[r];
      const auto earlier = sample_at(cut, past[r] + 1, turn);
      for (std::size_t a = 0; a < 2; ++a) mean[a] += earlier[a] / static_cast<double>(kMeanTurns);
    }
    for (std::size_t a = 0; a < 2; ++a) {
      rest[i] += std::pow(cut.samples[i][a] - mean[a], 2);
      all[i] += std::pow(cut.samples[i][a], 2);
    }
    rest_sum += rest[i];
    all_sum += all[i];
    for (; cut.turns[i] - cut.turns[first] > 1.0; ++first) {
      rest_sum -= rest[first];
      all_sum -= all[first];
    }
    if (judges) episodes.judge(rest_sum > kEnergyLimit * all_sum, time);
  }
  return episodes.take();
}

std::vector<Alarm> ask_fft(const CutPlan& plan, const MilledCut& cut) {
  Contact contact{plan, kHoldOff, kSpectrum_s};
  Episodes episodes;
  const int length = window_length(plan.sensor_rate_hz, kSpectrum_s);
  const auto hop = static_cast<std::size_t>(kSpectrumHop_s * plan.sensor_rate_hz);
  RealFft fft{length};
  std::vector<float> windowed(static_cast<std::size_t>(length));
  std::array<std::vector<std::complex<float>>, 2> spectrum;
  for (auto& s : spectrum) s.resize(static_cast<std::size_t>(fft.bins()));
  for (std::size_t i = 0; i < cut.samples.size(); ++i) {
    const double time = time_of(plan, i);
    const bool judges = contact.judges(time, cut.turns[i]);
    const auto count = static_cast<std::size_t>(length);
    if (!judges || i + 1 < count || (i + 1) % hop != 0) continue;
    const std::size_t from = i + 1 - count;
    for (std::size_t a = 0; a < 2; ++a) {
      for (std::size_t n = 0; n < count; ++n)
        windowed[n] = cut.samples[from + n][a] * static_cast<float>(0.5 - 0.5 * std::cos(kTwoPi * n / length));
      fft.transform(windowed, spectrum[a]);
    }
    const double bin_hz = plan.sensor_rate_hz / length;
    const double spindle_hz = (cut.turns[i] - cut.turns[from]) / (time - time_of(plan, from));
    const StrongestLine line = line_between_orders(spectrum[0], spectrum[1], bin_hz, spindle_hz, plan.sensor_rate_hz);
    episodes.judge(line.ratio > kLineLimit, time, line.hz);
  }
  return episodes.take();
}

}  // namespace stillcut::detection
