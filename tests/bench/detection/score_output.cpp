#include <algorithm>
#include <cmath>
#include <ostream>

#include "tests/bench/detection/score.hpp"

namespace stillcut::detection {
namespace {

constexpr double kShown_ms = 200.0;

// The share of all visible chatter that was reported by then.
plot::Line reported(std::span<const CutOutcome> cuts, std::size_t detector, double CutOutcome::*from,
                    plot::Color color) {
  plot::Line line;
  std::vector<double> delays;
  for (const CutOutcome& cut : cuts) {
    if (cut.not_stable || !std::isfinite(cut.visible_s)) continue;
    const DetectorOutcome& heard = cut.detectors[detector];
    delays.push_back(heard.detected ? 1e3 * (heard.alarm_s - cut.*from) : kInfinity);
  }
  std::sort(delays.begin(), delays.end());
  for (double ms = -kShown_ms; ms <= kShown_ms; ms += 1.0) {
    const auto below = std::upper_bound(delays.begin(), delays.end(), ms) - delays.begin();
    line.x.push_back(ms);
    line.y.push_back(delays.empty() ? 0.0 : 100.0 * static_cast<double>(below) / static_cast<double>(delays.size()));
  }
  line.color = color;
  line.width = detector == 0 ? 2.4 : 1.4;
  line.label = kDetectorNames[detector];
  return line;
}

void number(std::ostream& out, double value) {
  out << ',';
  if (std::isfinite(value)) out << value;
}

}  // namespace

void print_table(std::ostream& out, std::span<const Row> rows) {
  out << "| measure | target | monitor | | ";
  for (std::size_t d = 1; d < kDetectors; ++d) out << kDetectorNames[d] << " | ";
  out << "\n| --- | --- | --- | --- |"
      << " --- | --- | --- | --- |\n";
  for (const Row& row : rows) {
    out << "| " << row.measure << " | " << row.target << " | " << row.reached[0] << " | " << row.verdict << " | ";
    for (std::size_t d = 1; d < kDetectors; ++d) out << row.reached[d] << " | ";
    out << '\n';
  }
}

void print_csv(std::ostream& out, std::span<const CutOutcome> cuts) {
  out << "cut,kind,detector,growth,snr_db,sample_rate_hz,chatter_hz,slow_hz,revolution_s,stable_s,left_out,tenth_s,"
         "visible_s,slow_s,detected,alarm_s,false_alarms,called_regenerative,structural_s,error_25ms_hz,"
         "error_250ms_hz\n";
  for (const CutOutcome& cut : cuts) {
    for (std::size_t d = 0; d < kDetectors; ++d) {
      const DetectorOutcome& heard = cut.detectors[d];
      out << cut.index << ',' << name(cut.kind) << ',' << kDetectorNames[d];
      for (const double v :
           {cut.growth, cut.snr_db, cut.sensor_rate_hz, cut.chatter_hz, cut.slow_hz, cut.revolution_s, cut.stable_s})
        number(out, v);
      out << ',' << cut.not_stable;
      for (const double v : {cut.tenth_s, cut.visible_s, cut.slow_s}) number(out, v);
      out << ',' << heard.detected;
      number(out, heard.alarm_s);
      out << ',' << heard.false_alarms << ',' << heard.called_regenerative;
      for (const double v : {heard.structural_s, heard.error_25ms_hz, heard.error_250ms_hz}) number(out, v);
      out << '\n';
    }
  }
}

plot::Figure delay_figure(std::span<const CutOutcome> cuts, const std::string& title) {
  constexpr std::array kColors{plot::kBlue, plot::kOrange, plot::kGreen, plot::kVermilion, plot::kPurple};
  plot::Figure figure;
  figure.title = title;
  figure.subtitle = "share of all chatter that becomes visible";
  figure.x = {"alarm, ms after that moment", -kShown_ms, kShown_ms};
  figure.height = 800;
  const auto panel = [&](const char* heading, double CutOutcome::*from) {
    plot::Panel p;
    p.title = heading;
    p.y = {"reported, %", 0.0, 100.0};
    for (std::size_t d = 0; d < kDetectors; ++d) p.lines.push_back(reported(cuts, d, from, kColors[d]));
    p.events.push_back({0.0, "", plot::kGrey});
    figure.panels.push_back(std::move(p));
  };
  panel("since the chatter stood at 10 % of the forced vibration", &CutOutcome::tenth_s);
  panel("since it was visible: half the forced vibration", &CutOutcome::visible_s);
  return figure;
}

}  // namespace stillcut::detection
