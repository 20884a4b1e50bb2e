#include "models/ball_stroke.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stillcut {
namespace {

constexpr double kNotUnder = std::numeric_limits<double>::infinity();

}  // namespace

BallStroke ball_stroke(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius) {
  BallStroke stroke;
  stroke.from = from;
  stroke.way = to - from;
  stroke.radius = radius;
  stroke.length = stroke.way.head<2>().norm();
  const double whole = stroke.way.norm();
  if (stroke.length > 0.0) {
    stroke.ux = stroke.way.x() / stroke.length;
    stroke.uy = stroke.way.y() / stroke.length;
    stroke.sine = stroke.way.z() / whole;
  }
  return stroke;
}

StrokeLow lowest_over(const BallStroke& s, double x, double y) {
  const double px = x - s.from.x(), py = y - s.from.y();
  const double along = px * s.ux + py * s.uy, aside = px * s.uy - py * s.ux;
  const double room = s.radius * s.radius - aside * aside;
  if (!(room > 0.0)) return {.height = kNotUnder};
  // Lowest where the lower side is as steep along the way as the way itself.
  double share = s.way.z() < 0.0 ? 1.0 : 0.0;
  if (s.length > 0.0) share = std::clamp((along - std::sqrt(room) * s.sine) / s.length, 0.0, 1.0);
  const Eigen::Vector2d away(px - share * s.way.x(), py - share * s.way.y());
  const double below = s.radius * s.radius - away.squaredNorm();
  if (!(below > 0.0)) return {.height = kNotUnder};
  return {s.from.z() + share * s.way.z() - std::sqrt(below), away, share};
}

double lowest_in_box(const BallStroke& s, double x, double y, double half_x, double half_y) {
  const StrokeLow low = lowest_over(s, x, y);
  if (low.height < kNotUnder) {
    const double steep = std::sqrt(s.radius * s.radius - low.away.squaredNorm());
    return low.height - (std::abs(low.away.x()) * half_x + std::abs(low.away.y()) * half_y) / steep;
  }
  // The box reaches in from beside: the nearest that it can be to the way.
  const double px = x - s.from.x(), py = y - s.from.y();
  const double share = s.length > 0.0 ? std::clamp((px * s.ux + py * s.uy) / s.length, 0.0, 1.0) : 0.0;
  const double away = std::hypot(px - share * s.way.x(), py - share * s.way.y());
  const double nearest = std::max(0.0, away - std::hypot(half_x, half_y));
  if (!(nearest < s.radius)) return kNotUnder;
  return s.from.z() + std::min(0.0, s.way.z()) - std::sqrt(s.radius * s.radius - nearest * nearest);
}

std::vector<BallStroke> path_strokes(const CutterPath& path, bool feeding, double tolerance) {
  const double radius = 0.5 * path.tool.diameter;
  std::vector<BallStroke> strokes;
  for (std::size_t n = 0; n < path.pieces.size(); ++n) {
    const PathPiece& piece = path.pieces[n];
    if (piece.feeds != feeding) continue;
    // An arc of the centre, R wide, lies R turn^2/8 beside its chord.
    const double parts = std::max(1.0, std::ceil(piece.axis_turn * std::sqrt(radius / (8.0 * tolerance))));
    Eigen::Vector3d from = ball_pose(path, piece, 0.0).centre;
    for (double i = 1.0; i <= parts; ++i) {
      const Eigen::Vector3d to = ball_pose(path, piece, piece.duration * i / parts).centre;
      strokes.push_back(ball_stroke(from, to, radius));
      strokes.back().piece = n;
      strokes.back().begin = (i - 1.0) / parts;
      strokes.back().end = i / parts;
      from = to;
    }
  }
  return strokes;
}

}  // namespace stillcut
