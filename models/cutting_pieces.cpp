#include "models/cutting_pieces.hpp"

#include <algorithm>
#include <cmath>

#include "models/gauss_legendre.hpp"

namespace stillcut {
namespace {

constexpr double kSameAngle = 1e-9;  // rad: breakpoints closer than this are one
constexpr int kHeights = 16;         // quadrature points along a ball end's edge

// How far each tooth leads tooth 0; of teeth of equal pitch one stands for all.
std::vector<double> leads(const LinearCut& cut) {
  std::vector<double> result{0.0};
  for (std::size_t i = 0; i + 1 < cut.pitch.size(); ++i) result.push_back(result.back() + cut.pitch[i]);
  return result;
}

// Means over the depth of w n^T and n n^T, over the part of the edge between two heights.
CuttingMatrices end_mill_matrices(const LinearCut& cut, double tip, double depth) {
  const double lag = cut.lag_per_depth * depth;
  CuttingMatrices result;
  if (lag < kSameAngle) {
    const Eigen::Vector2d normal = chip_normal(tip);
    result.stiffness.leftCols<2>() = cutting_force_direction(cut, tip) * normal.transpose();
    result.radial.topLeftCorner<2, 2>() = normal * normal.transpose();
    return result;
  }
  const double low = std::max(cut.immersion.entry, tip - lag), high = std::min(cut.immersion.exit, tip);
  if (!(high > low)) return result;
  result.stiffness.leftCols<2>() = cutting_stiffness_integral(cut, low, high) / lag;
  result.radial.leftCols<2>() = radial_projection_integral(low, high) / lag;
  return result;
}

// Ball end: at a height z the edge stands at kappa from the axis, cos kappa = 1 - z/R, and its chip is dz / sin kappa
// wide, which is R dkappa: the integral over kappa is smooth down to the pole. Above the ball the edge is a cylinder's.
CuttingMatrices ball_end_matrices(const LinearCut& cut, double tip, double depth) {
  double low = 0.0, high = depth;
  if (cut.lag_per_depth > 0.0) {
    low = std::max(low, (tip - cut.immersion.exit) / cut.lag_per_depth);
    high = std::min(high, (tip - cut.immersion.entry) / cut.lag_per_depth);
  }
  CuttingMatrices sum;
  if (!(high > low)) return sum;
  static const GaussLegendre rule = gauss_legendre(kHeights);
  const auto add = [&](double height, double kappa, double width) {
    const double phi = tip - cut.lag_per_depth * height;
    const double s = std::sin(phi), c = std::cos(phi), sk = std::sin(kappa), ck = std::cos(kappa);
    const Eigen::Vector3d normal(s * sk, c * sk, -ck);
    const Eigen::Vector3d force =
        cut.ktc * Eigen::Vector3d(c, -s, 0.0) + cut.krc * normal + cut.kac * Eigen::Vector3d(s * ck, c * ck, sk);
    sum.stiffness += width / depth * force * normal.transpose();
    sum.radial += width / depth * normal * normal.transpose();
  };
  const double kappa_low = std::acos(1.0 - std::min(low, cut.radius) / cut.radius);
  const double kappa_high = std::acos(1.0 - std::min(high, cut.radius) / cut.radius);
  for (int i = 0; i < kHeights; ++i) {
    const double kappa = kappa_low + (kappa_high - kappa_low) * rule.nodes[i];
    add(cut.radius * (1.0 - std::cos(kappa)), kappa, cut.radius * (kappa_high - kappa_low) * rule.weights[i]);
  }
  const double above = std::max(low, cut.radius);
  for (int i = 0; high > above && i < kHeights; ++i) {
    add(above + (high - above) * rule.nodes[i], 0.5 * std::numbers::pi, (high - above) * rule.weights[i]);
  }
  return sum;
}

}  // namespace

std::vector<CuttingPiece> cutting_pieces(const LinearCut& cut, double lag) {
  const double period = cut.period_angle();
  const double arc = cut.immersion.exit - cut.immersion.entry;
  const std::vector<double> lead = leads(cut);
  std::vector<double> breaks{0.0, period};
  const auto into_period = [&](double angle) { return angle - period * std::floor(angle / period); };
  for (const double by : lead) {
    for (const double event : {0.0, lag, arc, arc + lag}) breaks.push_back(into_period(event - by));
  }
  std::sort(breaks.begin(), breaks.end());

  std::vector<CuttingPiece> pieces;
  double from = 0.0;
  for (const double to : breaks) {
    if (to - from < kSameAngle) continue;
    CuttingPiece piece{from, std::abs(to - period) < kSameAngle ? period : to, {}};
    const double middle = 0.5 * (piece.from + piece.to);
    for (std::size_t tooth = 0; tooth < lead.size(); ++tooth) {
      for (double since = into_period(middle + lead[tooth]); since < arc + lag; since += period) {
        piece.teeth.push_back({static_cast<int>(tooth), cut.immersion.entry + since - (middle - piece.from)});
      }
    }
    from = piece.to;
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

CuttingMatrices cutting_matrices(const LinearCut& cut, double tip, double depth) {
  return cut.shape == ToolShape::ball ? ball_end_matrices(cut, tip, depth) : end_mill_matrices(cut, tip, depth);
}

}  // namespace stillcut
