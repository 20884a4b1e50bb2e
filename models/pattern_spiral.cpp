#include "models/pattern_spiral.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace stillcut {
namespace {

// A loop's point and the one of the loop before that it is blended with may be so many steps apart: s / sin(a/2) at a
// corner of angle a, here down to 23 degrees.
constexpr double kFarthestBlend = 5.0;
constexpr double kBesideCorner = 1e-3;  // of an edge: where what lies beside it is looked up, clear of its corners

constexpr double kRoundedBack = 1e-6;  // m: about a corner, what lies beside is the corner, but for rounding

// The loop from the place nearest to a point, back to there.
Contour loop_from(const Contour& loop, const Eigen::Vector2d& start) {
  const NearestOnContour at = nearest_on(loop, start);
  Contour points{at.point};
  for (std::size_t i = 1; i <= loop.size(); ++i) {
    const Eigen::Vector2d& point = loop[(at.edge + i) % loop.size()];
    if (point != points.back()) points.push_back(point);
  }
  if (points.back() != at.point) points.push_back(at.point);
  return points;
}

// Points of two loops that belong together, once round.
class LoopPairs {
 public:
  // `outer` closed; both begin at their shared start.
  LoopPairs(Contour outer, const Eigen::Vector2d& inner_start) : outer_(std::move(outer)) {
    along_.push_back(0.0);
    for (std::size_t i = 1; i < outer_.size(); ++i)
      along_.push_back(along_.back() + (outer_[i] - outer_[i - 1]).norm());
    pairs.emplace_back(outer_.front(), inner_start);
  }

  // The next point of the inner loop. Corners of the outer loop that have nothing beside them in the inner one go with
  // its corner before. What lies behind the last pair is left out: so rounding has it near the start.
  void add(const Eigen::Vector2d& inner, const Eigen::Vector2d& corner) {
    const NearestOnContour beside = nearest_on(outer_, inner);
    if (beside.along < last_ - kRoundedBack || beside.along > last_ + 0.5 * along_.back()) return;
    add_corners(beside.along, corner);
    pairs.emplace_back(beside.point, inner);
    last_ = std::max(last_, beside.along);
  }

  void close(const Eigen::Vector2d& inner) {
    add_corners(along_.back(), inner);
    pairs.emplace_back(outer_.back(), inner);
  }

  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> pairs;

 private:
  void add_corners(double until, const Eigen::Vector2d& inner) {
    for (; corner_ < outer_.size() && along_[corner_] < until; ++corner_)
      if (along_[corner_] > last_) pairs.emplace_back(outer_[corner_], inner);
  }

  Contour outer_;
  std::vector<double> along_;  // m, of each point
  double last_ = 0.0;
  std::size_t corner_ = 1;  // the next one
};

// One turn from a point of the outer loop to the inner loop.
std::optional<Contour> turn_between(const Contour& outer, const Contour& inner, const Eigen::Vector2d& start,
                                    const PlanePiece& room, double step_over) {
  const Contour loop = loop_from(inner, start);
  LoopPairs paired(loop_from(outer, start), loop.front());
  for (std::size_t i = 0; i + 1 < loop.size(); ++i) {
    const Eigen::Vector2d edge = loop[i + 1] - loop[i];
    paired.add(loop[i] + kBesideCorner * edge, loop[i]);
    paired.add(loop[i + 1] - kBesideCorner * edge, loop[i]);
  }
  paired.close(loop.back());

  std::vector<double> along{0.0};
  for (std::size_t i = 1; i < paired.pairs.size(); ++i) {
    const auto& [outer_a, inner_a] = paired.pairs[i - 1];
    const auto& [outer_b, inner_b] = paired.pairs[i];
    along.push_back(along.back() + 0.5 * ((outer_b - outer_a).norm() + (inner_b - inner_a).norm()));
  }
  Contour turn;
  for (std::size_t i = 0; i < along.size(); ++i) {
    const auto& [from, to] = paired.pairs[i];
    if ((to - from).norm() > kFarthestBlend * step_over) return std::nullopt;
    turn.push_back(from + along[i] / along.back() * (to - from));
    if (i > 0 && !stays_inside(room, turn[i - 1], turn[i])) return std::nullopt;
  }
  return turn;
}

void append(Contour& line, const Contour& more) { line.insert(line.end(), more.begin(), more.end()); }

}  // namespace

NearestOnContour nearest_on(const Contour& contour, const Eigen::Vector2d& point) {
  NearestOnContour nearest;
  double least = std::numeric_limits<double>::infinity(), along = 0.0;
  for (std::size_t i = 0; i < contour.size(); ++i) {
    const Eigen::Vector2d way = contour[(i + 1) % contour.size()] - contour[i];
    const double squared = way.squaredNorm();
    const double part = squared > 0.0 ? std::clamp((point - contour[i]).dot(way) / squared, 0.0, 1.0) : 0.0;
    const Eigen::Vector2d at = contour[i] + part * way;
    if (const double distance = (at - point).norm(); distance < least) {
      least = distance;
      nearest = {at, i, along + part * std::sqrt(squared)};
    }
    along += std::sqrt(squared);
  }
  return nearest;
}

std::vector<Contour> blended(const std::vector<Contour>& loops, const Eigen::Vector2d& start, const PlanePiece& room,
                             double step_over) {
  std::vector<Contour> lines{loop_from(loops.front(), start)};
  bool whole = true;  // the line ends with all of a loop
  for (std::size_t i = 1; i < loops.size(); ++i) {
    Contour& line = lines.back();
    if (const auto turn = turn_between(loops[i - 1], loops[i], line.back(), room, step_over)) {
      append(line, *turn);
      whole = false;
      continue;
    }
    if (!whole) append(line, loop_from(loops[i - 1], line.back()));
    const Eigen::Vector2d end = line.back();
    lines.push_back(loop_from(loops[i], end));
    whole = true;
  }
  if (!whole) append(lines.back(), loop_from(loops.back(), lines.back().back()));
  return lines;
}

}  // namespace stillcut
