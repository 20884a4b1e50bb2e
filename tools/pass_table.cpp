#include "tools/pass_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

using OfRun = std::function<double(const PassRun&)>;

bool in_paper(const PassRun& run) {  // the paper prints the roughness of this pass alone
  return run.pass.way == PassWay::longitudinal && run.pass.milling == Milling::down;
}

struct SpectrumPeak {
  double frequency_hz, amplitude;
};

// The highest line within a tenth of a frequency.
SpectrumPeak peak_near(const Spectrum& spectrum, double frequency_hz) {
  SpectrumPeak peak{kNaN, 0.0};
  for (std::size_t i = 0; i < spectrum.amplitude.size(); ++i) {
    const double at = static_cast<double>(i) * spectrum.resolution;
    if (std::abs(at - frequency_hz) < 0.1 * frequency_hz && spectrum.amplitude[i] > peak.amplitude)
      peak = {at, spectrum.amplitude[i]};
  }
  return peak;
}

struct TableOf {
  const std::vector<PassRun>& runs;
  std::vector<PassRow> rows;

  void add(const char* quantity, const char* unit, const OfRun& paper, const OfRun& ours) {
    PassRow& row = rows.emplace_back(PassRow{quantity, unit, {}, {}});
    for (const PassRun& run : runs) {
      row.paper.push_back(paper ? paper(run) : kNaN);
      row.ours.push_back(ours(run));
    }
  }
  // The name and those of its extremes.
  void add_roughness(const std::array<const char*, 3>& names, double paper_um, double ProfileRoughness::*figure) {
    add(
        names[0], "um", [&](const PassRun& run) { return in_paper(run) ? paper_um : kNaN; },
        [&](const PassRun& run) { return over_slices(run.result.wall).mean.*figure * 1e6; });
    add(names[1], "um", {}, [&](const PassRun& run) { return over_slices(run.result.wall).low.*figure * 1e6; });
    add(names[2], "um", {}, [&](const PassRun& run) { return over_slices(run.result.wall).high.*figure * 1e6; });
  }
};

std::string column_text(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size() + 1), ' ');
  return text;
}

// What a number looks like in a column.
std::string cell_text(double value) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return "none";
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), std::abs(value) >= 10.0 ? "%.2f" : "%.3f", value);
  return text.data();
}

}  // namespace

std::string pass_name(const HuynhPass& pass) {
  const bool along = pass.way == PassWay::longitudinal, down = pass.milling == Milling::down;
  return along ? (down ? "longitudinal down" : "longitudinal up") : (down ? "transversal down" : "transversal up");
}

std::vector<PassRow> pass_rows(const std::vector<PassRun>& runs) {
  TableOf table{runs, {}};
  const auto of = [](double HuynhPassResult::*figure, double unit) {
    return [=](const PassRun& run) { return run.result.*figure * unit; };
  };
  const auto line = [](double hz, double SpectrumPeak::*figure) {
    return [=](const PassRun& run) { return peak_near(run.result.cross_spectrum, hz).*figure; };
  };
  const auto printed = [](double value) { return [=](const PassRun&) { return value; }; };
  constexpr double kSpindleHz = 18700.0 / 60.0, kToothHz = 18700.0 / 30.0;
  table.add("feed force, peak", "N", {}, of(&HuynhPassResult::feed_peak, 1.0));
  table.add("feed force, rms", "N", {}, of(&HuynhPassResult::feed_rms, 1.0));
  table.add("cross-feed force, peak", "N", {}, of(&HuynhPassResult::cross_peak, 1.0));
  table.add("cross-feed force, rms", "N", {}, of(&HuynhPassResult::cross_rms, 1.0));
  table.add("cross-feed peak of the tooth after 170 deg", "N", {},
            [](const PassRun& run) { return run.result.tooth_peak[0]; });
  table.add("cross-feed peak of the tooth after 190 deg", "N", {},
            [](const PassRun& run) { return run.result.tooth_peak[1]; });
  table.add("spectrum, peak at the spindle's frequency", "Hz", printed(311.67),
            line(kSpindleHz, &SpectrumPeak::frequency_hz));
  table.add("spectrum, height there", "N", {}, line(kSpindleHz, &SpectrumPeak::amplitude));
  table.add("spectrum, peak at the tooth passing frequency", "Hz", printed(623.33),
            line(kToothHz, &SpectrumPeak::frequency_hz));
  table.add("spectrum, height there", "N", {}, line(kToothHz, &SpectrumPeak::amplitude));
  table.add("tool deviation into the part, mean", "um", {}, of(&HuynhPassResult::deviation_mean, 1e6));
  table.add("tool deviation, largest", "um", printed(10.0), of(&HuynhPassResult::deviation_peak, 1e6));
  table.add("vibration along the feed, rms", "m/s^2", {}, of(&HuynhPassResult::feed_vibration, 1.0));
  table.add("vibration across the feed, rms", "m/s^2", {}, of(&HuynhPassResult::cross_vibration, 1.0));
  table.add_roughness({"wall Ra", "wall Ra, lowest slice", "wall Ra, highest slice"}, 0.32, &ProfileRoughness::ra);
  table.add_roughness({"wall Rq", "wall Rq, lowest slice", "wall Rq, highest slice"}, 0.39, &ProfileRoughness::rq);
  table.add_roughness({"wall Rt", "wall Rt, lowest slice", "wall Rt, highest slice"}, 1.98, &ProfileRoughness::rt);
  if (!runs.empty() && runs.front().depths) {
    table.add("depth that turns unstable, by lobes", "mm", {},
              [](const PassRun& run) { return run.depths->by_lobes * 1e3; });
    table.add("depth that turns unstable, in time, given immersion", "mm", {},
              [](const PassRun& run) { return run.depths->in_time * 1e3; });
    table.add("depth that turns unstable, in time, in the part", "mm", {},
              [](const PassRun& run) { return run.depths->in_part * 1e3; });
  }
  return table.rows;
}

void print_pass_table(std::ostream& out, const std::vector<PassRun>& runs, const std::vector<PassRow>& rows) {
  constexpr int kQuantity = 57, kColumn = 20;
  out << column_text("", kQuantity) << column_text("paper", 9);
  for (const PassRun& run : runs) out << column_text(pass_name(run.pass), kColumn);
  out << '\n';
  for (const PassRow& row : rows) {
    const auto paper =
        std::find_if(row.paper.begin(), row.paper.end(), [](double value) { return !std::isnan(value); });
    out << column_text(std::string(row.quantity).append(" [").append(row.unit).append("]"), kQuantity)
        << column_text(paper == row.paper.end() ? "" : cell_text(*paper), 9);
    for (const double value : row.ours) out << column_text(cell_text(value), kColumn);
    out << '\n';
  }
}

}  // namespace stillcut
