#include "drivers/files/arc_chords.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <stdexcept>

namespace stillcut {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kCoarsestChord = std::numbers::pi / 4.0;  // small fillets keep a sense of their feed direction

double radius_tolerance(double radius) { return std::max(5e-6, std::min(1e-3 * radius, 1e-4)); }

std::string in_mm(double metres) {
  std::ostringstream out;
  out.precision(7);
  out << metres * 1e3 << " mm";
  return out.str();
}

}  // namespace

PathArc arc_about(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector2d& centre,
                  bool clockwise) {
  const Eigen::Vector2d start = from.head<2>() - centre;
  const Eigen::Vector2d end = to.head<2>() - centre;
  const double first = start.norm();
  const double last = end.norm();
  if (!(first > 0.0)) throw std::invalid_argument("the arc's centre is its start; give I and J from the start");
  if (std::abs(first - last) > radius_tolerance(first))
    throw std::invalid_argument("the arc's radius is " + in_mm(first) + " at its start and " + in_mm(last) +
                                " at its end; give end and centre that fit");
  double sweep = kTurn;
  if ((end - start).norm() > kSameArcPoint) {
    sweep = std::atan2(start.x() * end.y() - start.y() * end.x(), start.dot(end));
    if (clockwise) sweep = -sweep;
    if (sweep <= 0.0) sweep += kTurn;
  }
  return {from, to, centre, clockwise ? -sweep : sweep};
}

PathArc arc_of_radius(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius, bool clockwise) {
  const Eigen::Vector2d chord = to.head<2>() - from.head<2>();
  const double length = chord.norm();
  if (!(length > kSameArcPoint))
    throw std::invalid_argument("an arc by R ends where it began; give a full circle by I and J");
  const double size = std::abs(radius);
  if (0.5 * length - size > radius_tolerance(size))
    throw std::invalid_argument("the arc's ends lie " + in_mm(length) + " apart, more than twice its radius of " +
                                in_mm(size) + "; give ends and radius that fit");
  const double height = std::sqrt(std::max(0.0, size * size - 0.25 * length * length));
  const Eigen::Vector2d left = Eigen::Vector2d(-chord.y(), chord.x()) / length;
  // Of the shorter arc anti-clockwise the centre lies to the left of the chord.
  const double side = clockwise != (radius < 0.0) ? -1.0 : 1.0;
  const Eigen::Vector2d centre = from.head<2>() + 0.5 * chord + side * height * left;
  return arc_about(from, to, centre, clockwise);
}

std::size_t chord_count(const PathArc& arc) {
  const double radius = std::max((arc.from.head<2>() - arc.centre).norm(), (arc.to.head<2>() - arc.centre).norm());
  // A chord over the angle a lies r (1 - cos(a/2)) = 2 r sin^2(a/4) beside its arc: without cancelling at large radii.
  const double sine = std::sqrt(kChordSagitta / (2.0 * radius));
  const double angle = sine < 1.0 ? std::min(kCoarsestChord, 4.0 * std::asin(sine)) : kCoarsestChord;
  const double count = std::ceil(std::abs(arc.sweep) / angle * (1.0 - 1e-12));
  if (count > kMostChords)
    throw std::invalid_argument("the arc needs more than a million chords; check its radius of " + in_mm(radius));
  return static_cast<std::size_t>(std::max(1.0, count));
}

Eigen::Vector3d point_on_arc(const PathArc& arc, double share) {
  if (share <= 0.0) return arc.from;
  if (share >= 1.0) return arc.to;
  const Eigen::Vector2d start = arc.from.head<2>() - arc.centre;
  const double grown = 1.0 + share * ((arc.to.head<2>() - arc.centre).norm() / start.norm() - 1.0);
  const double cosine = grown * std::cos(share * arc.sweep);
  const double sine = grown * std::sin(share * arc.sweep);
  return {arc.centre.x() + cosine * start.x() - sine * start.y(),
          arc.centre.y() + sine * start.x() + cosine * start.y(), arc.from.z() + share * (arc.to.z() - arc.from.z())};
}

}  // namespace stillcut
