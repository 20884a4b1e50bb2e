#include "models/stabilization_chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "models/median.hpp"

namespace stillcut {
namespace {

constexpr double kAgreeingHalfWidths = 0.5;  // of a mode's half-width (zeta w), that agreeing poles lie apart at most
constexpr double kAgreeingFrequency = 2e-3;  // relative, beside that
constexpr double kAgreeingShare = 0.4;       // of the orders from the first at which the pole appears
constexpr int kLeastAgreeing = 3;            // orders

}  // namespace

std::vector<ChartPole> agreed_poles(const StabilizationChart& chart) {
  struct Seen {
    ChartPole pole;
    int row;
  };
  std::vector<Seen> stable;
  for (std::size_t row = 0; row < chart.rows.size(); ++row)
    for (const ChartPole& pole : chart.rows[row].poles)
      if (pole.stable()) stable.push_back({pole, static_cast<int>(row)});
  std::sort(stable.begin(), stable.end(),
            [](const Seen& a, const Seen& b) { return a.pole.natural_frequency < b.pole.natural_frequency; });
  std::vector<ChartPole> agreed;
  for (std::size_t first = 0; first < stable.size();) {
    std::size_t end = first + 1;
    const auto near = [](const ChartPole& a, const ChartPole& b) {
      const double width =
          std::max(kAgreeingHalfWidths * std::min(a.damping_ratio, b.damping_ratio), kAgreeingFrequency);
      return b.natural_frequency - a.natural_frequency < width * a.natural_frequency;
    };
    while (end < stable.size() && near(stable[end - 1].pole, stable[end].pole)) ++end;
    std::vector<double> frequencies, dampings;
    std::vector<bool> rows(chart.rows.size(), false);
    for (std::size_t k = first; k < end; ++k) {
      frequencies.push_back(stable[k].pole.natural_frequency);
      dampings.push_back(stable[k].pole.damping_ratio);
      rows[static_cast<std::size_t>(stable[k].row)] = true;
    }
    const auto from = std::find(rows.begin(), rows.end(), true);
    const auto seen = static_cast<double>(std::count(from, rows.end(), true));
    if (seen >= kLeastAgreeing && seen >= kAgreeingShare * static_cast<double>(rows.end() - from))
      agreed.push_back({median(frequencies), median(dampings), true, true, true});
    first = end;
  }
  return agreed;
}

}  // namespace stillcut
