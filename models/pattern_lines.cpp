#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "models/pattern_passes.hpp"

namespace stillcut {
namespace {

constexpr double kLineInset = 5e-6;  // m, of the outermost lines: one along an edge would be lost by rounding
// Shorter ones, m, are left to fill_gaps: the outermost line at a corner is none.
constexpr double kShortestLine = 1e-4;
constexpr int kMostGapRounds = 1000;

// In axes turned by the lines' angle: x along the lines, y to their left.
struct PatternLine {
  double y = 0.0, begin = 0.0, end = 0.0;
};

PlanePiece turned_by(const PlanePiece& piece, const Eigen::Rotation2D<double>& rotation) {
  PlanePiece result = piece;
  for (Eigen::Vector2d& point : result.outer) point = rotation * point;
  for (Contour& hole : result.holes)
    for (Eigen::Vector2d& point : hole) point = rotation * point;
  return result;
}

std::vector<PatternLine> lines_at(const PlanePiece& piece, double y, double shortest = kLeastWidth) {
  std::vector<double> crossings;
  for (const Contour& contour : contours_of(piece)) {
    Eigen::Vector2d a = contour.back();
    for (const Eigen::Vector2d& b : contour) {
      if ((a.y() > y) != (b.y() > y)) crossings.push_back(a.x() + (b.x() - a.x()) * (y - a.y()) / (b.y() - a.y()));
      a = b;
    }
  }
  std::sort(crossings.begin(), crossings.end());
  std::vector<PatternLine> lines;
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
    if (crossings[i + 1] - crossings[i] > shortest) lines.push_back({y, crossings[i], crossings[i + 1]});
  return lines;
}

std::pair<double, double> range_of_y(const PlanePiece& piece) {
  const auto [low, high] = std::minmax_element(piece.outer.begin(), piece.outer.end(),
                                               [](const auto& a, const auto& b) { return a.y() < b.y(); });
  return {low->y(), high->y()};
}

// A line through the middle of what others leave farther away than the tool's radius.
void add_line_through(const PlanePiece& gap, const PlanePiece& piece, std::vector<PatternLine>& lines) {
  const auto [low, high] = range_of_y(gap);
  const double y = std::midpoint(low, high);
  const std::vector<PatternLine> through_gap = lines_at(gap, y);
  for (const PatternLine& line : lines_at(piece, y))
    if (std::any_of(through_gap.begin(), through_gap.end(), [&](const PatternLine& in_gap) {
          const double middle = std::midpoint(in_gap.begin, in_gap.end);
          return line.begin < middle && middle < line.end;
        }))
      lines.push_back(line);
}

// Where a piece narrows between two lines, or is a band that crosses them at a small angle, equal spacing leaves places
// that no line comes near.
void fill_gaps(const PlanePiece& piece, double radius, std::vector<PatternLine>& lines) {
  for (int round = 0; round < kMostGapRounds; ++round) {
    std::vector<Contour> ways;
    ways.reserve(lines.size());
    for (const PatternLine& line : lines) ways.push_back({{line.begin, line.y}, {line.end, line.y}});
    const PlanePieces gaps = subtracted(std::span(&piece, 1), swept_by_disc(ways, radius + 2.0 * kLeastWidth));
    const std::size_t before = lines.size();
    for (const PlanePiece& gap : gaps) add_line_through(gap, piece, lines);
    if (lines.size() == before) return;
  }
}

}  // namespace

std::vector<PatternPass> line_passes(const PlanePiece& piece, bool zig_zag, double angle,
                                     const PatternSettings& settings) {
  const PlanePiece turned = turned_by(piece, Eigen::Rotation2D<double>(-angle));
  const auto [low, high] = range_of_y(turned);
  const int steps = std::max(1, static_cast<int>(std::ceil((high - low - kLeastWidth) / settings.step_over)));
  std::vector<PatternLine> lines;
  for (int i = 0; i <= steps; ++i) {
    const double y = std::lerp(low + kLineInset, high - kLineInset, static_cast<double>(i) / steps);
    const std::vector<PatternLine> more = lines_at(turned, y, kShortestLine);
    lines.insert(lines.end(), more.begin(), more.end());
  }
  fill_gaps(turned, settings.tool_radius, lines);

  // The first line's sense is along the angle; in down milling the next one lies to its right.
  const bool from_left = settings.milling == Milling::down;
  std::sort(lines.begin(), lines.end(), [&](const PatternLine& a, const PatternLine& b) {
    return a.y != b.y ? (a.y > b.y) == from_left : a.begin < b.begin;
  });
  std::vector<PatternPass> passes;
  const Eigen::Rotation2D<double> back(angle);
  for (std::size_t first = 0, row = 0; first < lines.size(); ++row) {
    std::size_t end = first;
    while (end < lines.size() && lines[end].y == lines[first].y) ++end;
    const bool backward = zig_zag && row % 2 == 1;
    Milling milling = settings.milling;
    if (backward) milling = opposite(milling);
    for (std::size_t i = 0; i < end - first; ++i) {
      const PatternLine& line = lines[backward ? end - 1 - i : first + i];
      Contour points{back * Eigen::Vector2d(line.begin, line.y), back * Eigen::Vector2d(line.end, line.y)};
      if (backward) std::swap(points[0], points[1]);
      passes.push_back({std::move(points), milling});
    }
    first = end;
  }
  return passes;
}

}  // namespace stillcut
