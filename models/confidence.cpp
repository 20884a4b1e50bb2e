#include "models/confidence.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>

#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

// The standard normal quantile: Newton's method on erfc, from the tail's logarithm. Good to rounding.
double normal_quantile(double share) {
  if (share > 0.5) return -normal_quantile(1.0 - share);
  double x = -std::sqrt(-2.0 * std::log(2.0 * share));  // below the root, so that Newton climbs to it without a leap
  for (int step = 0; step < 60; ++step) {
    const double below = 0.5 * std::erfc(-x / std::numbers::sqrt2);
    const double density = std::exp(-0.5 * x * x) / std::sqrt(kTwoPi);
    // Newton on log(below), which is concave: from the left it never passes the root.
    const double change = (std::log(share) - std::log(below)) * below / density;
    x += change;
    if (std::abs(change) < 1e-15 * std::max(1.0, std::abs(x))) break;
  }
  return x;
}

void check_deviation(double deviation) {
  if (!(deviation >= 0.0 && deviation < 1.0)) {
    throw std::invalid_argument("tolerance: relative standard deviations lie between 0 and 1");
  }
}

// Factors of one figure over the samples, in random order.
class Stratified {
 public:
  Stratified(int count, std::uint64_t seed) : random_{seed} {
    for (int i = 0; i < count; ++i) quantile_.push_back(normal_quantile((i + 0.5) / count));
  }

  std::vector<double> factors(double deviation) {
    shuffle();
    const double sigma = std::sqrt(std::log1p(deviation * deviation));  // of the logarithm
    std::vector<double> result;
    for (const double z : quantile_) result.push_back(std::exp(sigma * z));
    return result;
  }

 private:
  void shuffle() {  // std::shuffle may differ from one standard library to the next
    for (std::size_t i = quantile_.size(); i > 1; --i) std::swap(quantile_[i - 1], quantile_[random_() % i]);
  }

  std::mt19937_64 random_;
  std::vector<double> quantile_;
};

}  // namespace

std::vector<UncertainCell> sample_cells(const Material& material, std::span<const Mode> modes,
                                        const Tolerance& tolerance, int count, std::uint64_t seed) {
  if (count < 1) throw std::invalid_argument("samples: must be at least 1");
  const double deviations[] = {tolerance.modes.frequency, tolerance.modes.damping, tolerance.modes.stiffness,
                               tolerance.ktc};
  for (const double deviation : deviations) check_deviation(deviation);
  Stratified stratified(count, seed);
  std::vector<UncertainCell> cells(static_cast<std::size_t>(count), {material, {modes.begin(), modes.end()}});
  const auto vary = [&](double deviation, auto&& apply) {
    const std::vector<double> factors = stratified.factors(deviation);
    for (std::size_t i = 0; i < cells.size(); ++i) apply(cells[i], factors[i]);
  };
  vary(tolerance.ktc, [](UncertainCell& cell, double factor) {
    cell.material.ktc *= factor, cell.material.krc *= factor, cell.material.kac *= factor;
  });
  static constexpr double kMostDamping = 0.999;  // a sample must stay a vibration
  for (std::size_t m = 0; m < modes.size(); ++m) {
    vary(tolerance.modes.frequency, [m](UncertainCell& c, double factor) { c.modes[m].natural_frequency *= factor; });
    vary(tolerance.modes.stiffness, [m](UncertainCell& c, double factor) { c.modes[m].stiffness *= factor; });
    vary(tolerance.modes.damping, [m](UncertainCell& c, double factor) {
      c.modes[m].damping_ratio = std::min(kMostDamping, factor * c.modes[m].damping_ratio);
    });
  }
  return cells;
}

double depth_quantile(std::vector<double> limits, double share) {
  if (limits.empty()) return kNaN;
  for (double& limit : limits) limit = std::isnan(limit) ? 0.0 : limit;
  std::sort(limits.begin(), limits.end());
  const double last = static_cast<double>(limits.size()) - 1.0;
  const double place = std::clamp(share * static_cast<double>(limits.size()) - 0.5, 0.0, last);
  const auto below = static_cast<std::size_t>(std::floor(place));
  const double low = limits[below], high = limits[std::min(below + 1, limits.size() - 1)];
  const double part = place - std::floor(place);
  if (part == 0.0) return low;
  if (low == 0.0 || std::isinf(high)) return low;  // the safe one: there is nothing to interpolate with
  return low * std::pow(high / low, part);
}

std::vector<DepthBand> depth_bands(const Tool& tool, const Material& material, const Cut& cut,
                                   std::span<const Mode> modes, std::span<const double> speeds,
                                   const LobeSettings& settings, const Tolerance& tolerance,
                                   const Confidence& confidence, const std::function<void(double)>& progress) {
  if (!(confidence.probability >= 0.5 && confidence.probability <= 0.99)) {
    throw std::invalid_argument("confidence: must lie between 0.5 and 0.99");
  }
  if (confidence.samples * (1.0 - confidence.probability) < 0.5) {
    throw std::invalid_argument("samples: too few for this confidence");
  }
  const auto cells = sample_cells(material, modes, tolerance, confidence.samples, confidence.seed);
  std::vector<std::vector<double>> depths(speeds.size());  // by speed, a sample each
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto limits = traced_limits(tool, cells[i].material, cut, cells[i].modes, speeds, settings);
    for (std::size_t s = 0; s < speeds.size(); ++s) depths[s].push_back(limits[s].depth);
    if (progress) progress(static_cast<double>(i + 1) / static_cast<double>(cells.size()));
  }
  std::vector<DepthBand> bands;
  bands.reserve(depths.size());
  for (const std::vector<double>& at_speed : depths) {
    bands.push_back(
        {depth_quantile(at_speed, 1.0 - confidence.probability), depth_quantile(at_speed, confidence.probability)});
  }
  return bands;
}

}  // namespace stillcut
