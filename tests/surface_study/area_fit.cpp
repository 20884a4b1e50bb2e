#include "tests/surface_study/area_fit.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace stillcut::surface_study {

AreaFigures expected_figures(int of_case, const std::vector<Mode>& modes, double noise,
                             std::span<const std::uint64_t> seeds, int jobs) {
  AreaFigures mean;
  const double share = 1.0 / static_cast<double>(seeds.size());
  for (const std::uint64_t seed : seeds) {
    const AreaFigures one = area_surface(cut_of_case(of_case), modes, noise, seed, jobs).figures;
    mean.ra += share * one.ra, mean.rq += share * one.rq;
    mean.ra_along += share * one.ra_along, mean.rq_along += share * one.rq_along;
    mean.sa += share * one.sa, mean.sq += share * one.sq;
    mean.interval_along += share * one.interval_along, mean.width_along += share * one.width_along;
    mean.peak += share * one.peak;
  }
  return mean;
}

double fitted_stiffness(std::span<const FitPoint> points, const PublishedArea& area) {
  if (points.size() < 3) throw std::invalid_argument("a parabola needs three points");
  Eigen::MatrixXd powers(points.size(), 3);
  Eigen::VectorXd off(points.size());  // logarithm of both figures over the measured ones
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = std::log(points[i].stiffness);
    const AreaFigures& figures = points[i].figures;
    powers.row(static_cast<Eigen::Index>(i)) << 1.0, x, x * x;
    off[static_cast<Eigen::Index>(i)] =
        std::log(1e6 * figures.ra / area.ra_measured) + std::log(1e6 * figures.rq / area.rq_measured);
  }
  const Eigen::Vector3d parabola = powers.colPivHouseholderQr().solve(off);
  constexpr int kSteps = 2000;
  const double low = std::log(points.front().stiffness), high = std::log(points.back().stiffness);
  double best = low, least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kSteps; ++i) {
    const double x = low + (high - low) * i / kSteps, value = std::abs(parabola.dot(Eigen::Vector3d(1.0, x, x * x)));
    if (value < least) best = x, least = value;
  }
  return std::exp(best);
}

AreaFigures left_out_figures(std::size_t area, const std::array<double, kAreas>& stiffness,
                             const StudySettings& settings, std::span<const std::uint64_t> seeds, int jobs) {
  return expected_figures(kPublished.at(area).of_case, predicted_modes(area_map(settings.modes, stiffness, area), area),
                          settings.noise, seeds, jobs);
}

}  // namespace stillcut::surface_study
