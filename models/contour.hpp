// A closed contour in the workpiece's plane, m; the last point joins the first.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace stillcut {

using Contour = std::vector<Eigen::Vector2d>;

}  // namespace stillcut
