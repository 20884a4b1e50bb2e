#include "models/paper_projection.hpp"

#include <cmath>

namespace stillcut {

PaperReceptance paper_projection(const Eigen::Matrix3cd& receptance, double feed_direction) {
  const double c = std::cos(feed_direction), s = std::sin(feed_direction);
  const std::complex<double> xx = receptance(0, 0), yy = receptance(1, 1);
  return {xx * c + yy * s, -xx * s + yy * c};
}

}  // namespace stillcut
