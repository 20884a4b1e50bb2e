#include "models/contact_window.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stillcut {
namespace {

constexpr double kBinsARadian = ContactWindow::kBins / (2.0 * std::numbers::pi);

}  // namespace

void ContactWindow::add(double kappa, double phi, double around, double tan_helix) {
  const double low = std::max(0.0, kappa - around), high = std::min(0.5 * std::numbers::pi, kappa + around);
  if (low > high) return;  // on the shank
  empty_ = false;
  const auto take = [&](Kappas& bin) {
    bin = bin.empty() ? Kappas{low, high} : Kappas{std::min(bin.low, low), std::max(bin.high, high)};
  };
  // A circle about the point takes in the tip, or is seen from there within two tangents.
  const double wide = std::sin(std::min(around, 0.5 * std::numbers::pi)) / std::max(std::sin(kappa), 1e-12);
  const double beside = wide < 1.0 && around < 0.5 * std::numbers::pi ? std::asin(wide) : std::numbers::pi;
  const double first = phi - beside + tan_helix * (1.0 - std::cos(low)),
               last = phi + beside + tan_helix * (1.0 - std::cos(high));
  if (beside >= std::numbers::pi || last - first >= 2.0 * std::numbers::pi) {
    for (Kappas& bin : bins_) take(bin);
    return;
  }
  const auto begin = static_cast<long>(std::floor(first * kBinsARadian)),
             end = static_cast<long>(std::floor(last * kBinsARadian)) + 1;
  const auto bins = static_cast<long>(kBins);
  for (long bin = begin; bin < std::min(end, begin + bins); ++bin)
    take(bins_[static_cast<std::size_t>((bin % bins + bins) % bins)]);
}

ContactWindow::Kappas ContactWindow::between(double first, double last) const {
  const auto begin = static_cast<long>(std::floor(first * kBinsARadian)),
             end = static_cast<long>(std::floor(last * kBinsARadian)) + 1;
  const auto bins = static_cast<long>(kBins);
  Kappas all;
  for (long bin = begin; bin < std::min(end, begin + bins); ++bin) {
    const Kappas& one = bins_[static_cast<std::size_t>((bin % bins + bins) % bins)];
    if (!one.empty()) all = all.empty() ? one : Kappas{std::min(all.low, one.low), std::max(all.high, one.high)};
  }
  return all;
}

}  // namespace stillcut
