#include "models/chart_poles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "models/pole_fractions.hpp"

namespace stillcut {
namespace {

using Eigen::Index;

constexpr double kFrequencyStable = 0.01, kDampingStable = 0.05, kShapeStable = 0.02;  // 1 - MAC
constexpr double kMarginBelow = 1.5, kMarginAbove = 1.2;
constexpr Index kLeastLines = 30;  // in an octave; with fewer it reaches down to the lowest line

Index first_from(const Eigen::VectorXd& omega, double frequency) {
  return std::lower_bound(omega.data(), omega.data() + omega.size(), frequency) - omega.data();
}

void mark_stable(ChartPole& pole, const FractionPole& here, const std::vector<FractionPole>& below) {
  const FractionPole* nearest = nullptr;
  double distance = std::numeric_limits<double>::infinity();
  for (const FractionPole& other : below) {
    const double apart = std::abs(other.pole.natural_frequency / here.pole.natural_frequency - 1.0);
    if (apart < distance) {
      distance = apart;
      nearest = &other;
    }
  }
  if (!nearest) return;
  pole.stable_frequency = distance < kFrequencyStable;
  pole.stable_damping =
      std::abs(nearest->pole.damping_ratio - here.pole.damping_ratio) < kDampingStable * here.pole.damping_ratio;
  pole.stable_shape = std::norm(nearest->shape.dot(here.shape)) > 1.0 - kShapeStable;
}

}  // namespace

StabilizationChart chart_of(const FrfLines& lines, const FrfWeights& weights, int most_pairs, PoleMethod method) {
  StabilizationChart chart;
  for (int order = 1; order <= most_pairs; ++order) chart.rows.push_back({order, {}});
  const Eigen::VectorXd& omega = lines.omega;
  const Index count = omega.size();
  double high = std::nextafter(omega[count - 1], std::numeric_limits<double>::infinity());
  while (high > omega[0]) {
    double low = 0.5 * high;
    if (first_from(omega, high) - first_from(omega, low) < kLeastLines ||
        first_from(omega, low) - first_from(omega, 0.5 * low) < kLeastLines)
      low = 0.0;
    const Index first = first_from(omega, low / kMarginBelow);
    const Index end = first_from(omega, high * kMarginAbove);
    FrfWeights some;
    for (const Eigen::VectorXd& weight : weights) some.emplace_back(weight.segment(first, end - first));
    const std::vector<std::vector<FractionPole>> rows =
        fraction_poles(some_lines(lines, first, end - first), some, most_pairs, method);
    for (std::size_t row = 0; row < rows.size(); ++row)
      for (const FractionPole& here : rows[row]) {
        if (here.pole.natural_frequency < std::max(low, omega[0]) || here.pole.natural_frequency >= high) continue;
        ChartPole pole{here.pole.natural_frequency, here.pole.damping_ratio};
        if (row > 0) mark_stable(pole, here, rows[row - 1]);
        chart.rows[row].poles.push_back(pole);
      }
    high = low;
  }
  for (ChartRow& row : chart.rows)
    std::sort(row.poles.begin(), row.poles.end(),
              [](const ChartPole& a, const ChartPole& b) { return a.natural_frequency < b.natural_frequency; });
  while (!chart.rows.empty() && chart.rows.back().poles.empty()) chart.rows.pop_back();
  return chart;
}

}  // namespace stillcut
