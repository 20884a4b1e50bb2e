#include "tests/case_study/plate.hpp"

#include <cstdlib>

namespace stillcut::case_study {

std::vector<PlatePoint> plate_points() {
  constexpr int kHalf = kPointsASide / 2;
  std::vector<PlatePoint> points;
  for (int row = -kHalf; row <= kHalf; ++row) {
    for (int column = -kHalf; column <= kHalf; ++column) {
      PlatePoint point;
      point.id = std::to_string(points.size() + 1);
      point.u = static_cast<double>(column) / kHalf;
      point.v = static_cast<double>(row) / kHalf;
      point.x = 0.5 * kSide * (1.0 + point.u);
      point.y = 0.5 * kSide * (1.0 + point.v);
      const bool beside = std::abs(column) > std::abs(row) || (column == -row && column != 0);
      point.periphery_deg = beside ? 90.0 : 0.0;
      points.push_back(point);
    }
  }
  return points;
}

}  // namespace stillcut::case_study
