#include "models/edge_rows.hpp"

#include <cmath>

#include "models/multiversion.hpp"

namespace stillcut {
namespace {

STILLCUT_MULTIVERSION void combine_axis(const double* fixed, const double* sine, const double* cosine, double s,
                                        double c, double beside, double* out, int begin, int end) {
  for (int i = begin; i < end; ++i) out[i] = (fixed[i] + sine[i] * s) + (cosine[i] * c + beside);
}

}  // namespace

EdgeRows edge_rows(const CutterMotion& motion, std::span<const EdgePoint> points, double spacing_along,
                   double spacing_across) {
  EdgeRows rows;
  const Eigen::Vector3d scale(1.0 / spacing_along, 1.0 / spacing_across, 1.0);
  for (const EdgePoint& point : points) {
    const double s = std::sin(point.lag), c = std::cos(point.lag);
    const Eigen::Vector3d fixed = motion.orientation.col(2) * point.height + motion.height * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d sine = motion.orientation * (point.radius * Eigen::Vector3d(c, s, 0.0));
    const Eigen::Vector3d cosine = motion.orientation * (point.radius * Eigen::Vector3d(-s, c, 0.0));
    for (int i = 0; i < 3; ++i) {
      EdgeAxis& axis = rows[static_cast<std::size_t>(i)];
      axis.fixed.push_back(fixed[i] * scale[i]);
      axis.sine.push_back(sine[i] * scale[i]);
      axis.cosine.push_back(cosine[i] * scale[i]);
    }
  }
  return rows;
}

void place_row(const EdgeRows& rows, double sine, double cosine, const Eigen::Vector3d& beside, EdgeRow& row) {
  const auto place = [&](const EdgeAxis& axis, double by, std::vector<double>& out) {
    combine_axis(axis.fixed.data(), axis.sine.data(), axis.cosine.data(), sine, cosine, by, out.data(), row.begin,
                 row.end);
  };
  place(rows[0], beside.x(), row.x);
  place(rows[1], beside.y(), row.y);
  place(rows[2], beside.z(), row.z);
}

}  // namespace stillcut
