// A ball along a straight way: the body that it sweeps has a lower side in closed form, a sphere's at both ends and a
// cylinder's between. Over the plane the lower side is convex, so that one tangent bounds it from below and the corners
// of a box from above.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/cutter_path.hpp"

namespace stillcut {

struct BallStroke {
  Eigen::Vector3d from, way;  // m, of the centre
  double radius = 0.0;        // m
  // Of the way: horizontal length and direction, and the sine of its slope.
  double length = 0.0, ux = 0.0, uy = 0.0, sine = 0.0;
  // What of a path it is: shares of a piece that are gone at its begin and end.
  std::size_t piece = 0;
  double begin = 0.0, end = 1.0;
};

[[nodiscard]] BallStroke ball_stroke(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius);

// The lowest that the body is over a point; infinite beside it. `away` is the point from the centre that is lowest
// there, horizontally, `share` how much of the way that centre has gone.
struct StrokeLow {
  double height = 0.0;
  Eigen::Vector2d away = Eigen::Vector2d::Zero();
  double share = 0.0;
};
[[nodiscard]] StrokeLow lowest_over(const BallStroke& stroke, double x, double y);

// Never above lowest_over() of any point within `half_x` and `half_y` of (x, y).
[[nodiscard]] double lowest_in_box(const BallStroke& stroke, double x, double y, double half_x, double half_y);

// Pieces of the path that feed (or those that do not) as strokes, straight to within `tolerance` where the axis turns.
[[nodiscard]] std::vector<BallStroke> path_strokes(const CutterPath& path, bool feeding, double tolerance = 1e-9);

}  // namespace stillcut
