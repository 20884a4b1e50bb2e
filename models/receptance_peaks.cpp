#include "models/receptance_peaks.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "models/receptance.hpp"

namespace stillcut {
namespace {

constexpr double kProminence = 1.05;  // over the saddle beside it
constexpr double kBelow = 0.7, kAbove = 1.4;
constexpr double kMostPoints = 20'000;

// The maximum between two frequencies by golden section: the curve has one there.
ReceptancePeak refined(std::span<const Mode> modes, double low, double high) {
  constexpr double kGolden = 0.6180339887498949;
  const auto height = [&](double frequency) { return largest_receptance(modes, frequency); };
  double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
  double at_left = height(left), at_right = height(right);
  for (int step = 0; step < 30; ++step) {
    if (at_left > at_right) {
      high = right, right = left, at_right = at_left;
      at_left = height(left = high - kGolden * (high - low));
    } else {
      low = left, left = right, at_left = at_right;
      at_right = height(right = low + kGolden * (high - low));
    }
  }
  return at_left > at_right ? ReceptancePeak{left, at_left} : ReceptancePeak{right, at_right};
}

// The lowest value between a maximum and the next higher point on one side.
double saddle(std::span<const double> heights, std::size_t peak, bool rightward) {
  double lowest = heights[peak];
  for (std::size_t i = peak; rightward ? i + 1 < heights.size() : i > 0;) {
    i = rightward ? i + 1 : i - 1;
    if (heights[i] > heights[peak]) return lowest;
    lowest = std::min(lowest, heights[i]);
  }
  return -1.0;  // nothing higher on this side
}

}  // namespace

double largest_receptance(std::span<const Mode> modes, double frequency) {
  const Eigen::Matrix3cd g = receptance(modes, frequency);
  // The largest eigenvalue of the Hermitian H = G^H G, by the trigonometric solution of its cubic.
  Eigen::Matrix3cd h = g.adjoint() * g;
  const double mean = h.trace().real() / 3.0;
  h.diagonal().array() -= mean;
  const double spread = std::sqrt(h.squaredNorm() / 6.0);
  if (!(spread > 1e-15 * mean)) return std::sqrt(mean);
  const double cosine = std::clamp(0.5 * (h / spread).determinant().real(), -1.0, 1.0);
  return std::sqrt(mean + 2.0 * spread * std::cos(std::acos(cosine) / 3.0));
}

std::vector<double> peak_frequencies(std::span<const Mode> modes, double per_peak) {
  check_modes(modes);
  double low = modes.front().natural_frequency, high = low, sharpest = modes.front().damping_ratio;
  for (const Mode& mode : modes) {
    low = std::min(low, mode.natural_frequency);
    high = std::max(high, mode.natural_frequency);
    sharpest = std::min(sharpest, mode.damping_ratio);
  }
  const double span = std::log(kAbove * high / (kBelow * low));
  const double steps = std::clamp(std::ceil(span * per_peak / sharpest), 100.0, kMostPoints - 1.0);
  std::vector<double> frequencies(static_cast<std::size_t>(steps) + 1);
  for (std::size_t i = 0; i < frequencies.size(); ++i)
    frequencies[i] = kBelow * low * std::exp(span * static_cast<double>(i) / steps);
  return frequencies;
}

std::vector<ReceptancePeak> receptance_peaks(std::span<const Mode> modes) {
  const std::vector<double> frequencies = peak_frequencies(modes);
  std::vector<double> heights(frequencies.size());
  std::transform(frequencies.begin(), frequencies.end(), heights.begin(),
                 [&](double frequency) { return largest_receptance(modes, frequency); });
  std::vector<ReceptancePeak> peaks;
  for (std::size_t i = 1; i + 1 < heights.size(); ++i) {
    if (!(heights[i] > heights[i - 1] && heights[i] >= heights[i + 1])) continue;
    if (kProminence * std::max(saddle(heights, i, false), saddle(heights, i, true)) > heights[i]) continue;
    peaks.push_back(refined(modes, frequencies[i - 1], frequencies[i + 1]));
  }
  // Nothing but modes damped beyond resonance: the soft end stands for a peak.
  if (peaks.empty()) peaks.push_back({frequencies.front(), heights.front()});
  return peaks;
}

ReceptancePeak highest_peak(std::span<const ReceptancePeak> peaks) {
  return *std::max_element(peaks.begin(), peaks.end(),
                           [](const auto& a, const auto& b) { return a.receptance < b.receptance; });
}

}  // namespace stillcut
