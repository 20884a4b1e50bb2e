#include "tests/tools/closed_loop/summary.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <functional>

#include "drivers/files/csv.hpp"

namespace stillcut::campaign {
namespace {

constexpr double kInTime = 0.95;  // share of the cells
constexpr double kGrown = 3.0;    // at the correction, of the amplitude at the alarm
constexpr int kMostTargets = 2;
constexpr double kBroughtDown = 0.1;  // of the peak

[[gnu::format(printf, 1, 2)]] std::string printed(const char* format, ...) {
  char text[512];
  va_list values;
  va_start(values, format);
  std::vsnprintf(text, sizeof text, format, values);
  va_end(values);
  return text;
}

const char* kind_name(CorrectionKind kind) {
  switch (kind) {
    case CorrectionKind::release:
      return "release";
    case CorrectionKind::spindle_speed:
      return "speed";
    case CorrectionKind::speed_variation:
      return "variation";
    case CorrectionKind::feed_direction:
      return "direction";
    case CorrectionKind::feed_override:
      return "feed";
    case CorrectionKind::stop_request:
      return "stop";
  }
  return "";
}

double shown_value(const Asked& asked) {
  if (asked.kind == CorrectionKind::spindle_speed) return rad_s_to_rpm(asked.value);
  return asked.kind == CorrectionKind::feed_direction ? rad_to_deg(asked.value) : asked.value;
}

std::string kinds_of(const RunMetrics& m) {
  std::string kinds;
  for (const Asked& asked : m.asked) kinds.append(kinds.empty() ? "" : " ").append(kind_name(asked.kind));
  return kinds;
}

bool brought_down(const RunMetrics& m) {
  return (m.stopped && !m.reason.empty()) || m.ended < RunMetrics::kFar || m.settled < kBroughtDown * m.peak;
}

using Verdict = std::function<bool(const RunMetrics&)>;

struct Counted {
  const std::vector<CellRun>& runs;

  [[nodiscard]] std::vector<const CellRun*> of(const Verdict& verdict) const {
    std::vector<const CellRun*> found;
    for (const CellRun& run : runs)
      if (run.problem.empty() && verdict(run.metrics)) found.push_back(&run);
    return found;
  }
};

std::string indices(const std::vector<const CellRun*>& runs) {
  constexpr std::size_t kShown = 40;
  std::string text;
  for (std::size_t i = 0; i < std::min(runs.size(), kShown); ++i)
    text.append(i == 0 ? " (cells " : " ").append(std::to_string(runs[i]->index));
  if (runs.size() > kShown) text += " ...";
  if (!text.empty()) text += ')';
  return text;
}

// One line: how many of `all` meet it, and which do not.
std::string criterion(const char* words, const Counted& counted, const Verdict& among, const Verdict& verdict,
                      double share, bool& met) {
  const std::size_t all = counted.of(among).size();
  const auto bad = counted.of([&](const RunMetrics& m) { return among(m) && !verdict(m); });
  const double good = all > 0 ? 1.0 - static_cast<double>(bad.size()) / static_cast<double>(all) : 0.0;
  const bool ok = all > 0 && good >= share;
  met = met && ok;
  return printed("%-4s %5.1f %% of %zu: %s; not %zu", ok ? "ok" : "NOT", 100.0 * good, all, words, bad.size()) +
         indices(bad) + '\n';
}

double median(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return kNaN;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

std::string pocket_text(const Counted& counted, bool& met) {
  const Verdict heard = [](const RunMetrics& m) { return m.chattered || m.forestalled(); };
  const Verdict corrected = [](const RunMetrics& m) { return m.chattered && !m.asked.empty(); };
  std::string text =
      criterion(
          "chatter below 10 % of its peak within move + 4 T + 0.1 s of the alarm, never back at 30 %", counted, heard,
          [](const RunMetrics& m) { return m.in_time() || m.forestalled(); }, kInTime, met) +
      criterion(
          "amplitude at the correction below 3 x that at the alarm", counted, corrected,
          [](const RunMetrics& m) { return m.at_correction < kGrown * m.at_alarm; }, kInTime, met) +
      criterion(
          "at most two targets", counted, heard, [](const RunMetrics& m) { return m.targets <= kMostTargets; }, kInTime,
          met) +
      criterion(
          "no limit cycle", counted, heard, [](const RunMetrics& m) { return !m.limit_cycle; }, 1.0, met);
  const auto also = [&](const char* words, const Verdict& verdict) {
    bool ignored = true;
    text += "also: " + criterion(words, counted, heard, verdict, 0.0, ignored);
  };
  also("the same, where twice what noise leaves in the pocket counts as down",
       [](const RunMetrics& m) { return m.in_time_but_for_noise() || m.forestalled(); });
  also("below 10 % in time and for good: one burst of noise in a minute counts against it",
       [](const RunMetrics& m) { return m.below_for_good_after <= m.allowed || m.forestalled(); });
  also("heard", [](const RunMetrics& m) { return !std::isnan(m.alarm); });
  also("by the truth ended", [](const RunMetrics& m) { return m.ended < RunMetrics::kFar || m.forestalled(); });
  also("by the truth ended, or below 10 %, in time",
       [](const RunMetrics& m) { return m.in_time() || m.forestalled() || m.ended <= m.alarm + m.allowed; });
  const auto hidden = counted.of([](const RunMetrics& m) { return m.chattered && m.hidden(); });
  text += printed("at the pocket's own speed more than 10 %% of the peak remains in %zu", hidden.size()) +
          indices(hidden) + '\n';
  return text;
}

std::string medians(const std::vector<CellRun>& runs) {
  const auto of = [&](const std::function<double(const RunMetrics&)>& value) {
    std::vector<double> values;
    for (const CellRun& run : runs)
      if (run.problem.empty() && run.metrics.chattered) values.push_back(value(run.metrics));
    return median(values);
  };
  const double down = of([](const RunMetrics& m) { return m.down_after; });
  return printed(
      "medians: alarm %.0f ms after the chatter, down %s after the alarm (allowed %.2f s), peak %.1f um, "
      "remains %.2f um, pocket itself %.2f um, sound cut before %.2f um\n",
      1e3 * of([](const RunMetrics& m) { return m.alarm - m.chatter_from; }),
      (down < RunMetrics::kFar ? printed("%.2f s", down) : "not").c_str(),
      of([](const RunMetrics& m) { return m.allowed; }), 1e6 * of([](const RunMetrics& m) { return m.peak; }),
      1e6 * of([](const RunMetrics& m) { return m.settled; }),
      1e6 * of([](const RunMetrics& m) { return m.in_pocket; }), 1e6 * of([](const RunMetrics& m) { return m.sound; }));
}

}  // namespace

Summary summarise(const std::vector<CellRun>& runs) {
  Summary summary{{}, true};
  const Counted counted{runs};
  const CellClass kind = runs.front().cell.kind;
  const auto chattered = counted.of([](const RunMetrics& m) { return m.chattered; });
  summary.text = printed("%zu cells of class %s, %zu chatter by the machine's truth\n", runs.size(),
                         std::string(name(kind)).c_str(), chattered.size());
  const Verdict any = [](const RunMetrics&) { return true; };
  const Verdict chatter = [](const RunMetrics& m) { return m.chattered; };
  if (kind == CellClass::stable) {
    summary.text += "     chatter all the same, left out:" + indices(chattered) + '\n';
    summary.text += criterion(
        "no correction", counted, [](const RunMetrics& m) { return !m.chattered; },
        [](const RunMetrics& m) { return m.asked.empty(); }, 1.0, summary.met);
    bool ignored = true;
    summary.text +=
        "also: " + criterion(
                       "no alarm", counted, any, [](const RunMetrics& m) { return m.onsets == 0; }, 0.0, ignored);
  } else if (kind == CellClass::pocket) {
    summary.text += pocket_text(counted, summary.met) + medians(runs);
  } else {
    summary.text +=
        criterion("brought down, or stopped with a reason", counted, chatter, brought_down, 1.0, summary.met);
    bool ignored = true;
    summary.text += "also: " + criterion(
                                   "heard", counted, chatter, [](const RunMetrics& m) { return !std::isnan(m.alarm); },
                                   0.0, ignored);
    summary.text += "also: " +
                    criterion(
                        "not stopped", counted, chatter, [](const RunMetrics& m) { return !m.stopped; }, 0.0, ignored) +
                    medians(runs);
  }
  for (const CellRun& run : runs) {
    if (run.problem.empty()) continue;
    summary.met = false;
    summary.text += printed("cell %d broke off: %s\n", run.index, run.problem.c_str());
  }
  return summary;
}

std::string line_of(const CellRun& run) {
  const RunMetrics& m = run.metrics;
  if (!run.problem.empty()) return printed("%4d broke off: %s", run.index, run.problem.c_str());
  return printed(
             "%4d %5.0f rpm %.2f mm (limit %.2f) pocket %5.0f rpm %+.2f | chatter %6.1f Hz from %5.2f s, alarm %+5.0f "
             "ms, "
             "down %7.2f s (allowed %.2f) peak %5.1f settled %5.2f floor %5.2f sound %5.2f um, x%.1f, %d targets, %d "
             "spells, %d times back%s%s | ",
             run.index, rad_s_to_rpm(run.cell.cut.spindle_speed), 1e3 * run.cell.cut.axial_depth,
             1e3 * run.cell.depth_limit, rad_s_to_rpm(run.cell.pocket_speed), run.cell.pocket_margin, m.chatter_hz,
             m.chatter_from, 1e3 * (m.alarm - m.chatter_from), m.down_after < RunMetrics::kFar ? m.down_after : kNaN,
             m.allowed, 1e6 * m.peak, 1e6 * m.settled, 1e6 * m.in_pocket, 1e6 * m.sound, m.at_correction / m.at_alarm,
             m.targets, m.spells, m.times_back, m.limit_cycle ? ", LIMIT CYCLE" : "", m.stopped ? ", stopped" : "") +
         kinds_of(m) + (m.reason.empty() ? "" : ": " + m.reason);
}

std::string settings_text(const CellRun& run) {
  std::string text;
  for (const Asked& asked : run.metrics.asked)
    text += printed("  %7.3f s %-10s %g\n", asked.time, kind_name(asked.kind), shown_value(asked));
  return text;
}

std::string csv_header() {
  return "index,spindle_speed_rpm,axial_depth_mm,depth_limit_mm,pocket_rpm,pocket_margin,predicted_hz,chatter_hz,"
         "chatter_from_s,alarm_s,allowed_s,down_after_s,down_to_noise_after_s,ended_s,peak_um,at_alarm_um,at_"
         "correction_um,sound_um,"
         "settled_um,floor_um,targets,spells,onsets,limit_cycle,stopped,asked,reason,problem\n";
}

std::string csv_row(const CellRun& run) {
  const RunMetrics& m = run.metrics;
  const auto number = [](double value) { return csv_number_or_empty(value < RunMetrics::kFar ? value : kNaN); };
  std::string row = std::to_string(run.index);
  for (const double value :
       {rad_s_to_rpm(run.cell.cut.spindle_speed), 1e3 * run.cell.cut.axial_depth, 1e3 * run.cell.depth_limit,
        rad_s_to_rpm(run.cell.pocket_speed), run.cell.pocket_margin, run.cell.chatter_hz, m.chatter_hz, m.chatter_from,
        m.alarm, m.allowed, m.down_after, m.down_to_noise_after, m.ended, 1e6 * m.peak, 1e6 * m.at_alarm,
        1e6 * m.at_correction, 1e6 * m.sound, 1e6 * m.settled, 1e6 * m.in_pocket})
    row.append(",").append(number(value));
  for (const int count : {m.targets, m.spells, m.onsets, int{m.limit_cycle}, int{m.stopped}})
    row.append(",").append(std::to_string(count));
  return row + "," + csv_text(kinds_of(m)) + "," + csv_text(m.reason) + "," + csv_text(run.problem) + "\n";
}

}  // namespace stillcut::campaign
