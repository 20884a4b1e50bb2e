#include "models/paper_projection.hpp"

#include <cmath>

namespace stillcut {

PaperReceptance paper_projection(const Eigen::Matrix3cd& receptance, double feed_direction) {
  const double c = std::cos(feed_direction), s = std::sin(feed_direction);
  const std::complex<double> xx = receptance(0, 0), yy = receptance(1, 1);
  return {xx * c + yy * s, -xx * s + yy * c};
}

Eigen::Matrix2cd paper_feed_plane(const Eigen::Matrix3cd& receptance, double feed_direction) {
  const PaperReceptance receptances = paper_projection(receptance, feed_direction);
  Eigen::Matrix2cd feed_plane = Eigen::Matrix2cd::Zero();
  feed_plane(0, 0) = receptances.feed;
  feed_plane(1, 1) = receptances.cross_feed;
  return feed_plane;
}

}  // namespace stillcut
