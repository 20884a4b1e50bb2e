#include "models/plane_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <polyclipping/clipper.hpp>

namespace stillcut {
namespace {

constexpr double kPieceGrain = 1e-9;  // m, of Clipper's whole numbers
// Clipper's last chord of an arc may be half as long again as the others, and so leaves the arc by 2.25 times as much.
constexpr double kClipperTolerance = kChordTolerance / 2.25;
constexpr double kBesidePiece = 1e-6;  // m, outside but counted as on the edge

ClipperLib::Path on_piece_grid(const Contour& contour) {
  ClipperLib::Path path;
  path.reserve(contour.size());
  for (const Eigen::Vector2d& point : contour)
    path.emplace_back(std::llround(point.x() / kPieceGrain), std::llround(point.y() / kPieceGrain));
  return path;
}

Contour from_piece_grid(const ClipperLib::Path& path) {
  Contour contour;
  contour.reserve(path.size());
  for (const auto& point : path)
    contour.emplace_back(kPieceGrain * static_cast<double>(point.X), kPieceGrain * static_cast<double>(point.Y));
  return contour;
}

Contour turned(Contour contour, bool counter_clockwise) {
  if (ClipperLib::Orientation(on_piece_grid(contour)) != counter_clockwise)
    std::reverse(contour.begin(), contour.end());
  return contour;
}

double circumference(const Contour& contour) {
  double length = 0.0;
  for (std::size_t i = 0; i < contour.size(); ++i) length += (contour[(i + 1) % contour.size()] - contour[i]).norm();
  return length;
}

// Clipper's tree has outer contours and, one below each, its holes; what lies in a hole is one below that.
void gather(const ClipperLib::PolyNode& parent, PlanePieces& pieces) {
  for (const ClipperLib::PolyNode* outer : parent.Childs) {
    PlanePiece piece{turned(from_piece_grid(outer->Contour), true), {}};
    double area = std::abs(ClipperLib::Area(outer->Contour)), length = circumference(piece.outer);
    for (const ClipperLib::PolyNode* hole : outer->Childs) {
      piece.holes.push_back(turned(from_piece_grid(hole->Contour), false));
      area -= std::abs(ClipperLib::Area(hole->Contour));
      length += circumference(piece.holes.back());
      gather(*hole, pieces);
    }
    if (2.0 * area * kPieceGrain * kPieceGrain > kLeastWidth * length) pieces.push_back(std::move(piece));
  }
}

PlanePieces gathered(const ClipperLib::PolyTree& tree) {
  PlanePieces pieces;
  gather(tree, pieces);
  return pieces;
}

PlanePieces offset(std::span<const Contour> contours, double distance, ClipperLib::EndType end) {
  ClipperLib::ClipperOffset clipper(2.0, kClipperTolerance / kPieceGrain);
  for (const Contour& contour : contours) clipper.AddPath(on_piece_grid(contour), ClipperLib::jtRound, end);
  ClipperLib::PolyTree tree;
  clipper.Execute(tree, distance / kPieceGrain);
  return gathered(tree);
}

std::vector<Contour> all_contours(std::span<const PlanePiece> pieces) {
  std::vector<Contour> all;
  for (const PlanePiece& piece : pieces)
    for (Contour& contour : contours_of(piece)) all.push_back(std::move(contour));
  return all;
}

PlanePieces clipped(ClipperLib::ClipType kind, std::span<const PlanePiece> pieces, std::span<const PlanePiece> by) {
  ClipperLib::Clipper clipper;
  for (const Contour& contour : all_contours(pieces))
    clipper.AddPath(on_piece_grid(contour), ClipperLib::ptSubject, true);
  for (const Contour& contour : all_contours(by)) clipper.AddPath(on_piece_grid(contour), ClipperLib::ptClip, true);
  ClipperLib::PolyTree tree;
  clipper.Execute(kind, tree, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
  return gathered(tree);
}

template <typename Each>
void for_each_edge_of(const PlanePiece& piece, Each each) {
  const auto edges = [&](const Contour& contour) {
    for (std::size_t i = 0; i < contour.size(); ++i) each(contour[i], contour[i + 1 == contour.size() ? 0 : i + 1]);
  };
  edges(piece.outer);
  for (const Contour& hole : piece.holes) edges(hole);
}

double distance_to_edge(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& point) {
  const Eigen::Vector2d way = b - a;
  const double squared = way.squaredNorm();
  const double part = squared > 0.0 ? std::clamp((point - a).dot(way) / squared, 0.0, 1.0) : 0.0;
  return (a + part * way - point).norm();
}

}  // namespace

std::vector<Contour> contours_of(const PlanePiece& piece) {
  std::vector<Contour> contours{piece.outer};
  contours.insert(contours.end(), piece.holes.begin(), piece.holes.end());
  return contours;
}

PlanePieces shrunk(std::span<const PlanePiece> pieces, double distance) {
  return offset(all_contours(pieces), -distance, ClipperLib::etClosedPolygon);
}

PlanePieces grown(std::span<const PlanePiece> pieces, double distance) {
  return offset(all_contours(pieces), distance, ClipperLib::etClosedPolygon);
}

PlanePieces swept_by_disc(std::span<const Contour> lines, double radius) {
  return offset(lines, radius, ClipperLib::etOpenRound);
}

PlanePieces subtracted(std::span<const PlanePiece> pieces, std::span<const PlanePiece> taken) {
  return clipped(ClipperLib::ctDifference, pieces, taken);
}

PlanePieces common_to(std::span<const PlanePiece> pieces, std::span<const PlanePiece> others) {
  return clipped(ClipperLib::ctIntersection, pieces, others);
}

PlanePieces tool_centre_pieces(const Region& region, double radius, bool overhang) {
  const double inward = overhang ? 0.0 : -radius;
  const PlanePieces inside = offset(std::span(&region.polygon, 1), inward, ClipperLib::etClosedPolygon);
  PlanePieces islands;
  for (const Contour& island : region.islands)
    for (PlanePiece& piece : offset(std::span(&island, 1), radius, ClipperLib::etClosedPolygon))
      islands.push_back({std::move(piece.outer), {}});  // what an island encloses is its own
  return subtracted(inside, islands);
}

bool encloses(const PlanePiece& piece, const Eigen::Vector2d& point) {
  bool inside = false;
  for_each_edge_of(piece, [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    if ((a.y() > point.y()) != (b.y() > point.y()) &&
        point.x() < a.x() + (b.x() - a.x()) * (point.y() - a.y()) / (b.y() - a.y()))
      inside = !inside;
  });
  return inside;
}

// Between two crossings of the edge a line is on one side all along: its middle tells which.
bool stays_inside(const PlanePiece& piece, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const Eigen::Vector2d way = to - from, across(-way.y(), way.x());
  std::vector<double> crossings{0.0, 1.0};
  for_each_edge_of(piece, [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    const double side_a = across.dot(a - from), side_b = across.dot(b - from);
    if ((side_a > 0.0) == (side_b > 0.0)) return;
    const double part = way.dot(a + side_a / (side_a - side_b) * (b - a) - from) / way.squaredNorm();
    if (part > 0.0 && part < 1.0) crossings.push_back(part);
  });
  std::sort(crossings.begin(), crossings.end());
  for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
    const Eigen::Vector2d middle = from + 0.5 * (crossings[i] + crossings[i + 1]) * way;
    if (encloses(piece, middle)) continue;
    double nearest = std::numeric_limits<double>::infinity();
    for_each_edge_of(piece, [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
      nearest = std::min(nearest, distance_to_edge(a, b, middle));
    });
    if (nearest > kBesidePiece) return false;
  }
  return true;
}

}  // namespace stillcut
