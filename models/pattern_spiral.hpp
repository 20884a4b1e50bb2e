// Loops that lie one within the other, joined into a spiral: each is blended into the next over one turn.
#pragma once

#include <vector>

#include "models/plane_pieces.hpp"

namespace stillcut {

// Of a closed contour: the point nearest to another, and how far along the contour it lies.
struct NearestOnContour {
  Eigen::Vector2d point;
  std::size_t edge = 0;  // from the point of this index
  double along = 0.0;    // m, from the contour's first point
};
NearestOnContour nearest_on(const Contour& contour, const Eigen::Vector2d& point);

// Open lines through the loops, all of one sense of turning and `step_over` apart, m; the first begins at the place
// nearest to `start`. One line where each loop can be blended into the next; where it cannot, because an arm of the one
// has nothing beside it in the other or the way would leave `room`, the line ends with that loop and another begins.
// The first and last loop of a line are whole.
std::vector<Contour> blended(const std::vector<Contour>& loops, const Eigen::Vector2d& start, const PlanePiece& room,
                             double step_over);

}  // namespace stillcut
