#include "tests/surface_study/area_fit.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace stillcut::surface_study {
namespace {

constexpr std::uint64_t kFitSeed = 1, kPredictionSeed = 101;  // and the area's number

}  // namespace

double misfit(const AreaFigures& figures, const PublishedArea& area) {
  return 0.5 * (std::log(1e6 * figures.ra / area.ra_measured) + std::log(1e6 * figures.rq / area.rq_measured));
}

double fitted_stiffness(std::span<const FitPoint> points) {
  std::vector<const FitPoint*> known;
  for (const FitPoint& point : points)
    if (std::isfinite(point.misfit)) known.push_back(&point);
  if (known.size() < 3) throw std::invalid_argument("a parabola needs three points whose cut is held");
  Eigen::MatrixXd powers(known.size(), 3);
  Eigen::VectorXd values(known.size());
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t i = 0; i < known.size(); ++i) {
    const double x = std::log(known[i]->stiffness);
    const auto row = static_cast<Eigen::Index>(i);
    powers.row(row) << 1.0, x, x * x;
    values[row] = known[i]->misfit;
    low = std::min(low, x), high = std::max(high, x);
  }
  const Eigen::Vector3d parabola = powers.colPivHouseholderQr().solve(values);
  constexpr int kSteps = 2000;
  double best = low, least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kSteps; ++i) {
    const double x = low + (high - low) * i / kSteps, off = std::abs(parabola.dot(Eigen::Vector3d(1.0, x, x * x)));
    if (off < least) best = x, least = off;
  }
  return std::exp(best);
}

std::vector<FitPoint> fit_points(std::size_t area, std::span<const double> stiffness, const StudySettings& settings,
                                 int jobs, const std::function<void(const FitPoint&, const AreaFigures&)>& done) {
  std::vector<FitPoint> points;
  for (const double value : stiffness) {
    FitPoint point{value, std::numeric_limits<double>::infinity()};
    AreaFigures figures;
    try {
      figures = area_surface(cut_of_case(kPublished.at(area).of_case), modes_of(settings.modes, value), settings.noise,
                             kFitSeed + area, jobs)
                    .figures;
      point.misfit = misfit(figures, kPublished.at(area));
    } catch (const std::runtime_error&) {  // this soft, nothing holds it
    }
    done(point, figures);
    points.push_back(point);
  }
  return points;
}

AreaSurface left_out_surface(std::size_t area, const std::array<double, kAreas>& stiffness,
                             const StudySettings& settings, int jobs) {
  return area_surface(cut_of_case(kPublished.at(area).of_case),
                      predicted_modes(area_map(settings.modes, stiffness, area), area), settings.noise,
                      kPredictionSeed + area, jobs);
}

}  // namespace stillcut::surface_study
