#include "models/surface_form.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <stdexcept>

#include "models/surface_profiles.hpp"

namespace stillcut {
namespace {

// Coefficients of the basis functions, by the normal equations: with coordinates from -1 to 1 and heights less their
// mean they are well conditioned.
template <int N, class Basis>
Eigen::Matrix<double, N, 1> fitted_form(std::span<const double> heights, Basis basis_at) {
  double sum = 0.0;
  std::size_t known = 0;
  for (const double height : heights) {
    if (std::isnan(height)) continue;
    if (std::isinf(height)) throw std::invalid_argument("a height is infinite");
    sum += height;
    ++known;
  }
  if (known <= N) throw std::invalid_argument("too few points are known for a form; measure or cut more of them");
  const double mean = sum / static_cast<double>(known);
  Eigen::Matrix<double, N, N> products = Eigen::Matrix<double, N, N>::Zero();
  Eigen::Matrix<double, N, 1> moments = Eigen::Matrix<double, N, 1>::Zero();
  for (std::size_t k = 0; k < heights.size(); ++k) {
    if (std::isnan(heights[k])) continue;
    const Eigen::Matrix<double, N, 1> basis = basis_at(k);
    products.noalias() += basis * basis.transpose();
    moments += (heights[k] - mean) * basis;
  }
  Eigen::FullPivLU<Eigen::Matrix<double, N, N>> solver(products);
  solver.setThreshold(1e-10);
  if (solver.rank() < N) throw std::invalid_argument("the known points lie on a line; the form of the surface is open");
  Eigen::Matrix<double, N, 1> form = solver.solve(moments);
  form[0] += mean;
  return form;
}

template <int N, class Basis>
void take_off(std::span<double> heights, Basis basis_at) {
  const Eigen::Matrix<double, N, 1> form = fitted_form<N>(heights, basis_at);
  for (std::size_t k = 0; k < heights.size(); ++k) heights[k] -= form.dot(basis_at(k));
}

// From -1 at the first to 1 at the last of `count` points.
double centred(std::size_t index, std::size_t count) {
  return count > 1 ? 2.0 * static_cast<double>(index) / static_cast<double>(count - 1) - 1.0 : 0.0;
}

}  // namespace

void remove_form(std::span<double> profile, SurfaceForm form) {
  const auto u = [&](std::size_t k) { return centred(k, profile.size()); };
  if (form == SurfaceForm::linear) {
    take_off<2>(profile, [&](std::size_t k) { return Eigen::Vector2d(1.0, u(k)); });
    return;
  }
  take_off<3>(profile, [&](std::size_t k) { return Eigen::Vector3d(1.0, u(k), u(k) * u(k)); });
}

void remove_form(HeightMap& map, SurfaceForm form) {
  require_sound_map(map);
  const auto u = [&](std::size_t k) { return centred(k % map.along, map.along); };
  const auto v = [&](std::size_t k) { return centred(k / map.along, map.across); };
  if (form == SurfaceForm::linear) {
    take_off<3>(map.heights, [&](std::size_t k) { return Eigen::Vector3d(1.0, u(k), v(k)); });
    return;
  }
  take_off<6>(map.heights, [&](std::size_t k) {
    Eigen::Matrix<double, 6, 1> basis;
    basis << 1.0, u(k), v(k), u(k) * u(k), u(k) * v(k), v(k) * v(k);
    return basis;
  });
}

}  // namespace stillcut
