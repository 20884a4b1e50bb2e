#include "tests/bench/detection/score.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <ostream>

namespace stillcut::detection {
namespace {

using Value = std::function<double(const CutOutcome&, const DetectorOutcome&)>;
using Keep = std::function<bool(const CutOutcome&)>;

constexpr double kGatedRise_s = 0.015;
constexpr double kHour_s = 3600.0;

bool visible(const CutOutcome& cut) { return !cut.not_stable && std::isfinite(cut.visible_s); }
bool structural(const CutOutcome& cut) { return !cut.not_stable && cut.slow_hz > 0.0 && std::isfinite(cut.slow_s); }
bool gated(const CutOutcome& cut) { return visible(cut) && cut.visible_s - cut.tenth_s >= kGatedRise_s; }

double delay(const DetectorOutcome& heard, double from) { return heard.detected ? heard.alarm_s - from : kInfinity; }

std::string text(double value, const char* format) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return "missed";
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

// Every value is kept of every detector; the cuts are those that `keep` names.
std::vector<double> values_of(std::span<const CutOutcome> cuts, std::size_t detector, const Keep& keep,
                              const Value& value) {
  std::vector<double> values;
  for (const CutOutcome& cut : cuts) {
    if (!keep(cut)) continue;
    const double v = value(cut, cut.detectors[detector]);
    if (!std::isnan(v)) values.push_back(v);
  }
  return values;
}

using Reduce = std::function<double(const std::vector<double>&)>;
Reduce at_share(double share) {
  return [share](const std::vector<double>& values) { return percentile(values, share); };
}
double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return values.empty() ? kNaN : sum / static_cast<double>(values.size());
}
double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return values.empty() ? kNaN : std::sqrt(sum / static_cast<double>(values.size()));
}
double total(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return sum;
}

struct Wanted {
  std::string text;
  double limit = kNaN;  // NaN: reported only
  bool at_least = false;
};

class Table {
 public:
  explicit Table(std::span<const CutOutcome> cuts) : cuts_{cuts} {}

  void add(std::string measure, const Wanted& wanted, const char* format, const Keep& keep, const Value& value,
           const Reduce& reduce, std::size_t detectors = kDetectors) {
    Row row{std::move(measure), wanted.text, "", {}};
    for (std::size_t d = 0; d < kDetectors; ++d) {
      const double reached = d < detectors ? reduce(values_of(cuts_, d, keep, value)) : kNaN;
      row.reached[d] = text(reached, format);
      if (d > 0 || std::isnan(wanted.limit)) continue;
      const bool met = wanted.at_least ? reached >= wanted.limit : reached <= wanted.limit;
      row.verdict = std::isnan(reached) ? "no cuts" : met ? "met" : "missed";
    }
    rows_.push_back(std::move(row));
  }
  std::vector<Row> take() { return std::move(rows_); }

 private:
  std::span<const CutOutcome> cuts_;
  std::vector<Row> rows_;
};

double detected_percent(const CutOutcome&, const DetectorOutcome& heard) { return heard.detected ? 100.0 : 0.0; }
double after_tenth_ms(const CutOutcome& cut, const DetectorOutcome& heard) { return 1e3 * delay(heard, cut.tenth_s); }
double after_tenth_turns(const CutOutcome& cut, const DetectorOutcome& heard) {
  return delay(heard, cut.tenth_s) / cut.revolution_s;
}
double after_visible_ms(const CutOutcome& cut, const DetectorOutcome& heard) {
  return 1e3 * delay(heard, cut.visible_s);
}
// Of the longer of some revolutions and some time, which is what is allowed.
Value of_allowed(double turns, double seconds) {
  return [=](const CutOutcome& cut, const DetectorOutcome& heard) {
    return delay(heard, cut.tenth_s) / std::max(turns * cut.revolution_s, seconds);
  };
}

void add_delays(Table& table) {
  table.add("chatter that becomes visible: detected, %", {">= 99", 99.0, true}, "%.1f", visible, detected_percent,
            mean);
  table.add(
      "  missed, as an episode begun falsely before stood open, %", {}, "%.1f", visible,
      [](const CutOutcome&, const DetectorOutcome& heard) { return heard.hidden ? 100.0 : 0.0; }, mean);
  table.add("delay after 10 %, median, ms", {}, "%.1f", visible, after_tenth_ms, at_share(0.5));
  table.add("the same, revolutions", {}, "%.1f", visible, after_tenth_turns, at_share(0.5));
  table.add("the same over the longer of 5 rev and 10 ms", {"<= 1", 1.0}, "%.2f", visible, of_allowed(5.0, 0.010),
            at_share(0.5));
  table.add("delay after 10 %, 95th percentile, ms", {}, "%.1f", visible, after_tenth_ms, at_share(0.95));
  table.add("the same, revolutions", {}, "%.1f", visible, after_tenth_turns, at_share(0.95));
  table.add("the same over the longer of 10 rev and 25 ms", {"<= 1", 1.0}, "%.2f", visible, of_allowed(10.0, 0.025),
            at_share(0.95));
  table.add("delay after visible, median, ms (rise >= 15 ms)", {"<= 0", 0.0}, "%.1f", gated, after_visible_ms,
            at_share(0.5));
  table.add(
      "delay after visible, median, ms (rise < 15 ms)", {"not gated"}, "%.1f",
      [](const CutOutcome& c) { return visible(c) && !gated(c); }, after_visible_ms, at_share(0.5));
  table.add("delay after visible, 95th percentile, ms", {"<= 20", 20.0}, "%.1f", visible, after_visible_ms,
            at_share(0.95));
}

void add_false_alarms(Table& table, std::span<const CutOutcome> cuts) {
  double sound_s = 0.0;
  for (const CutOutcome& cut : cuts) sound_s += cut.not_stable ? 0.0 : cut.stable_s;
  const Keep sound = [](const CutOutcome& cut) { return !cut.not_stable; };
  const Value count = [](const CutOutcome&, const DetectorOutcome& heard) { return heard.false_alarms; };
  const std::string hours = text(sound_s / kHour_s, "%.2f");
  table.add("false alarms in " + hours + " h of sound cutting", {"0 in 8 h", 0.0}, "%.0f", sound, count, total);
  table.add("the same, an hour", {}, "%.0f", sound, count,
            [sound_s](const std::vector<double>& v) { return total(v) / (sound_s / kHour_s); });
  for (const CutKind kind : {CutKind::forced_near_mode, CutKind::steady, CutKind::speed_ramp, CutKind::entries,
                             CutKind::knocks, CutKind::interrupted, CutKind::deeper})
    table.add(
        "  of them in cuts of kind '" + std::string(name(kind)) + "'", {}, "%.0f",
        [kind](const CutOutcome& cut) { return !cut.not_stable && cut.kind == kind; }, count, total);
  table.add(
      "forced line near a mode called regenerative, times", {"0", 0.0}, "%.0f",
      [](const CutOutcome& cut) { return !cut.not_stable && cut.kind == CutKind::forced_near_mode; },
      [](const CutOutcome&, const DetectorOutcome& heard) { return heard.called_regenerative; }, total, 1);
}

// Off by more than this it is another line that was heard: a sideband, an order, another mode.
constexpr double kAnotherLine_hz = 10.0;

void add_frequency(Table& table, const std::string& when, const Wanted& wanted, double DetectorOutcome::*error,
                   double CutOutcome::*bound) {
  const Keep ten_decibels = [](const CutOutcome& cut) {
    return visible(cut) && cut.sensor_rate_hz == 10000.0 && std::abs(cut.snr_db - 10.0) <= 5.0;
  };
  using Outcome = const DetectorOutcome&;
  table.add(
      "frequency " + when + ", 5-15 dB, 10 kS/s: rms error, Hz", wanted, "%.2f", ten_decibels,
      [error](const CutOutcome&, Outcome heard) { return heard.*error; }, rms, 1);
  table.add(
      "  another line heard (> 10 Hz off: sideband, order, other mode), %", {}, "%.1f", ten_decibels,
      [error](const CutOutcome&, Outcome heard) {
        return std::isnan(heard.*error) ? kNaN : std::abs(heard.*error) > kAnotherLine_hz ? 100.0 : 0.0;
      },
      mean, 1);
  table.add(
      "  rms error of the others, Hz", {}, "%.2f", ten_decibels,
      [error](const CutOutcome&, Outcome heard) {
        return std::abs(heard.*error) > kAnotherLine_hz ? kNaN : heard.*error;
      },
      rms, 1);
  table.add(
      "  median of the absolute error, Hz", {}, "%.2f", ten_decibels,
      [error](const CutOutcome&, Outcome heard) { return std::abs(heard.*error); }, at_share(0.5), 1);
  table.add(
      "  Cramer-Rao bound there, rms, Hz", {}, "%.3f", ten_decibels,
      [bound](const CutOutcome& cut, Outcome) { return cut.*bound; }, rms, 1);
}

void add_structural(Table& table) {
  using Outcome = const DetectorOutcome&;
  table.add(
      "structural 8-20 Hz: found within 3 cycles, %", {"100", 100.0, true}, "%.1f", structural,
      [](const CutOutcome&, Outcome heard) { return heard.structural_found ? 100.0 : 0.0; }, mean, 1);
  table.add(
      "structural: kind right, %", {">= 98", 98.0, true}, "%.1f", structural,
      [](const CutOutcome&, Outcome heard) { return heard.structural_named ? 100.0 : 0.0; }, mean, 1);
  table.add(
      "structural: rms frequency error 0.4 s after the clock, Hz", {"<= 1", 1.0}, "%.2f", structural,
      [](const CutOutcome&, Outcome heard) { return heard.structural_error_hz; }, rms, 1);
  table.add(
      "structural: frequency within 1 Hz, %", {}, "%.1f", structural,
      [](const CutOutcome&, Outcome heard) {
        return std::isnan(heard.structural_error_hz) ? kNaN : std::abs(heard.structural_error_hz) <= 1.0 ? 100.0 : 0.0;
      },
      mean, 1);
}

void add_thirds(Table& table, const std::string& label, const Keep& third) {
  table.add(label + ": detected, %", {}, "%.1f", third, detected_percent, mean);
  table.add(label + ": delay after 10 %, median / ms", {}, "%.1f", third, after_tenth_ms, at_share(0.5));
  table.add(label + ": delay after 10 %, 95th percentile / ms", {}, "%.1f", third, after_tenth_ms, at_share(0.95));
  table.add(label + ": delay after visible, median / ms", {}, "%.1f", third, after_visible_ms, at_share(0.5));
}

}  // namespace

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return kNaN;
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::vector<Row> score(std::span<const CutOutcome> cuts) {
  Table table{cuts};
  add_delays(table);
  add_false_alarms(table, cuts);
  add_frequency(table, "25 ms after the alarm", {"<= 1", 1.0}, &DetectorOutcome::error_25ms_hz,
                &CutOutcome::bound_25ms_hz);
  add_frequency(table, "250 ms after the alarm", {"<= 0.3", 0.3}, &DetectorOutcome::error_250ms_hz,
                &CutOutcome::bound_250ms_hz);
  add_structural(table);
  constexpr std::array kGrowths{1.03, 1.113, 1.203, 1.3}, kDecibels{0.0, 10.0, 20.0, 30.0};
  for (std::size_t i = 0; i < 3; ++i)
    add_thirds(
        table, "growth " + text(kGrowths[i], "%.2f") + "-" + text(kGrowths[i + 1], "%.2f"),
        [=](const CutOutcome& c) { return visible(c) && c.growth >= kGrowths[i] && c.growth < kGrowths[i + 1]; });
  for (std::size_t i = 0; i < 3; ++i)
    add_thirds(
        table, "signal to noise " + text(kDecibels[i], "%.0f") + "-" + text(kDecibels[i + 1], "%.0f") + " dB",
        [=](const CutOutcome& c) { return visible(c) && c.snr_db >= kDecibels[i] && c.snr_db < kDecibels[i + 1]; });
  return table.take();
}

}  // namespace stillcut::detection
