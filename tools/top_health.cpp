// The panels of `stillcut top` that say how far all else can be trusted: sensors, losses, latency.
#include <algorithm>
#include <array>
#include <cmath>

#include "tools/cell_json.hpp"
#include "tools/spoken.hpp"
#include "tools/top_panels.hpp"

namespace stillcut {
namespace {

TextPiece count_piece(const char* name, std::int64_t count, const char* behind) {
  return {count > 0 ? Ink::caution : Ink::faint,
          printf_text("%s%s %lld%s", count > 0 ? "! " : "", name, static_cast<long long>(count), behind)};
}

TextLine sensor_line(std::size_t i, const SensorHealth& sensor) {
  constexpr double kRateTolerance_percent = 0.5;
  const double error = 100.0 * (sensor.rate_hz / sensor.nominal_rate_hz - 1.0);
  const bool off = std::isfinite(error) && std::abs(error) > kRateTolerance_percent;
  return {{Ink::plain, printf_text("%zu: ", i + 1)},
          {off ? Ink::caution : Ink::plain, (off ? "! " : "") + number_text("%.1f", sensor.rate_hz) +
                                                printf_text(" of %.0f Hz (", sensor.nominal_rate_hz) +
                                                number_text("%+.3f %%", error, "not known yet") + "), "},
          count_piece("lost", sensor.lost, ", "),
          count_piece("gaps", sensor.gaps, ", "),
          count_piece("saturated", sensor.saturated, ", "),
          count_piece("not finite", sensor.not_finite, "")};
}

TextLine doubts_line(const HealthReport& health) {
  const auto doubts = doubt_names(health.doubts);
  return {{doubts.empty() ? Ink::plain : Ink::doubt, doubts.empty() ? "no doubts" : "! doubts: " + list_of(doubts)},
          {Ink::faint, printf_text("; %lld frames; bus-off %lld times, interface came back %lld times",
                                   static_cast<long long>(health.frames), static_cast<long long>(health.bus_off),
                                   static_cast<long long>(health.reopened))}};
}

// Counts of a histogram's buckets, a column each: few stay visible beside many.
std::string spark(const HistogramReport::Counts& counts) {
  static constexpr std::array kLevels{"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  const auto most = static_cast<double>(std::max<std::int64_t>(2, *std::max_element(counts.begin(), counts.end())));
  std::string text;
  for (const std::int64_t count : counts) {
    const double share = count > 0 ? std::log1p(static_cast<double>(count)) / std::log1p(most) : 0.0;
    text += count > 0 ? kLevels[static_cast<std::size_t>(std::clamp(share * 7.0, 0.0, 7.0))] : "·";
  }
  return text;
}

}  // namespace

TopPanel sensors_panel(const CellView& view, int columns) {
  constexpr int kBelowTheNumber = 3;
  if (!view.health()) return empty_panel("Accelerometers", "nothing was heard yet");
  TopPanel panel{"Accelerometers", wrapped(doubts_line(*view.health()), columns, kBelowTheNumber), 0, {}};
  for (std::size_t i = 0; i < view.health()->sensors.size(); ++i)
    for (TextLine& line : wrapped(sensor_line(i, view.health()->sensors[i]), columns, kBelowTheNumber))
      panel.lines.push_back(std::move(line));
  panel.least = panel.wanted();
  return panel;
}

TopPanel losses_panel(const CellView& view, std::int64_t unreadable, int columns) {
  std::vector<Hop> hops;
  if (view.health()) hops = hops_of(*view.health());
  hops.push_back({"LCM to here, not readable", "here", unreadable});
  const int across = columns >= 76 ? 2 : 1;
  TopPanel panel{"Lost on the way, since the daemon's start", {}, 0, {}};
  for (std::size_t i = 0; i < hops.size(); ++i) {
    TextPiece piece = count_piece(hops[i].name, hops[i].lost, "");
    if (i % static_cast<std::size_t>(across) == 0) panel.lines.emplace_back();
    piece.text = padded(piece.text, columns / across);
    panel.lines.back().push_back(std::move(piece));
  }
  panel.least = panel.wanted();
  return panel;
}

TopPanel latency_panel(const CellView& view) {
  if (!view.latency()) return empty_panel("Latency", "nothing was heard yet");
  const LatencyReport& report = *view.latency();
  TopPanel panel{"Latency of the loop, since its start", {}, 0, {}};
  panel.lines.push_back(
      {{report.in_time ? Ink::good : Ink::alarm, report.in_time ? "in time" : "OUT OF TIME"},
       {Ink::plain, printf_text(", was out of it %lld times; %lld ticks, %lld overruns, %lld skipped",
                                static_cast<long long>(report.times_out), static_cast<long long>(report.ticks),
                                static_cast<long long>(report.overruns), static_cast<long long>(report.skipped))}});
  panel.lines.push_back(
      {{Ink::faint, padded("µs", 11) + printf_text("%9s%9s%9s%9s%13s", "p50", "p99", "p99.9", "worst", "count")}});
  for (const LatencyReport::Stage& stage : report.stages)
    panel.lines.push_back(
        {{Ink::plain, padded(printable(stage.name), 11) + printf_text("%9.1f%9.1f%9.1f%9.1f%13lld", stage.p50_us,
                                                                      stage.p99_us, stage.p999_us, stage.max_us,
                                                                      static_cast<long long>(stage.count))}});
  panel.least = std::min(panel.wanted(), 12);
  return panel;
}

TopPanel spread_panel(const CellView& view) {
  if (!view.histogram()) return empty_panel("Spread of the loop's times", "nothing was heard yet");
  TopPanel panel{"Spread of the loop's times, since its start (height: how often, logarithmic)", {}, 4, {}};
  for (const auto& [name, counts] :
       {std::pair{"wake-up", &view.histogram()->wake_up}, std::pair{"tick", &view.histogram()->tick},
        std::pair{"decision", &view.histogram()->decision}})
    panel.lines.push_back({{Ink::faint, padded(name, 11)}, {Ink::plain, spark(*counts)}});
  std::string axis;
  for (const auto& [us, text] : {std::pair{1.0, "1 µs"}, std::pair{16.0, "16"}, std::pair{256.0, "256"},
                                 std::pair{4096.0, "4 ms"}, std::pair{65536.0, "66"}})
    axis =
        padded(axis, static_cast<int>(std::log2(us / HistogramReport::kFirst_us) * HistogramReport::kPerOctave)) + text;
  panel.lines.push_back({{Ink::faint, padded("", 11) + axis}});
  return panel;
}

}  // namespace stillcut
