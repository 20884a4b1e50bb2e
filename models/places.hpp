// Places in the plane that each stand for what is nearer to them than to any other.
#pragma once

#include <Eigen/Core>
#include <span>

namespace stillcut {

// How far a place speaks for its surroundings, m: the longest edge of the shortest tree that joins them all, which on a
// grid is the spacing of its columns or rows, the wider one. Infinite for a single one, which speaks for everything.
double reach_of(std::span<const Eigen::Vector2d> places);

// The place that stands for a point: the nearest, of equally near ones the first.
std::size_t nearest_place(const Eigen::Vector2d& point, std::span<const Eigen::Vector2d> places);

}  // namespace stillcut
