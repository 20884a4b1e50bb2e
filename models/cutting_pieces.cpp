#include "models/cutting_pieces.hpp"

#include <algorithm>
#include <cmath>

namespace stillcut {
namespace {

constexpr double kSameAngle = 1e-9;  // rad: breakpoints closer than this are one

}  // namespace

std::vector<CuttingPiece> cutting_pieces(const LinearCut& cut, double lag) {
  const double pitch = kTwoPi / cut.teeth;
  const double arc = cut.immersion.exit - cut.immersion.entry;
  std::vector<double> breaks{0.0, pitch};
  for (const double event : {lag, arc, arc + lag}) breaks.push_back(std::fmod(event, pitch));
  std::sort(breaks.begin(), breaks.end());

  std::vector<CuttingPiece> pieces;
  double from = 0.0;
  for (const double to : breaks) {
    if (to - from < kSameAngle) continue;
    CuttingPiece piece{from, std::abs(to - pitch) < kSameAngle ? pitch : to, {}};
    const double middle = 0.5 * (piece.from + piece.to);
    for (int tooth = 0; middle + tooth * pitch < arc + lag; ++tooth) {
      piece.tooth_angle.push_back(cut.immersion.entry + piece.from + tooth * pitch);
    }
    from = piece.to;
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

CuttingMatrices cutting_matrices(const LinearCut& cut, const CuttingPiece& piece, double angle, double lag) {
  CuttingMatrices sum;
  for (const double start : piece.tooth_angle) {
    const double tip = start + angle - piece.from;
    if (lag < kSameAngle) {
      const Eigen::Vector2d normal = chip_normal(tip);
      sum.stiffness += cutting_force_direction(cut, tip) * normal.transpose();
      sum.radial.topRows<2>() += normal * normal.transpose();
    } else {
      const double low = std::max(cut.immersion.entry, tip - lag);
      const double high = std::min(cut.immersion.exit, tip);
      sum.stiffness += cutting_stiffness_integral(cut, low, high) / lag;
      sum.radial += radial_projection_integral(low, high) / lag;
    }
  }
  return sum;
}

}  // namespace stillcut
