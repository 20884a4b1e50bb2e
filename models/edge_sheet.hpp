// The sheet that a tooth's edge sweeps in many time steps, laid under a map without placing what cannot matter: it is
// looked at in pieces of so many steps by so many edge points, each between four knots; a piece whose box lies above
// the surface, or beside the tile, is passed over. What is left is placed point by point. Nothing that could lower the
// map is passed over, so heights do not depend on the pieces.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "models/cutter_motion.hpp"
#include "models/swept_patches.hpp"

namespace stillcut {

inline constexpr int kSheetSteps = 8, kSheetPoints = 8;  // of a piece

struct EdgeRange {
  int begin = 0, end = 0;  // edge points
};

// Knots are every kSheetPoints-th point of an edge of at least two, and the last.
[[nodiscard]] inline std::size_t knot_count(std::size_t points) {
  return (points + kSheetPoints - 2) / kSheetPoints + 1;
}
[[nodiscard]] inline std::size_t knot_point(std::size_t knot, std::size_t points) {
  return std::min(knot * kSheetPoints, points - 1);
}

// How far an edge point of a piece can be from the straight lines between its knots, m, across the tool's axis and
// along it.
struct SheetSag {
  double across = 0.0, along = 0.0;
  // In a direction of unit length in tool axes.
  [[nodiscard]] double in(const Eigen::Vector3d& direction) const {
    return direction.head<2>().norm() * across + std::abs(direction.z()) * along;
  }
};

// Of all pieces, while the tool turns by `turn` rad: the edge is curved, its way is a circle's. `runout` counts as
// radius.
[[nodiscard]] std::vector<SheetSag> sheet_sag(std::span<const EdgePoint> points, double turn, double runout);

struct SheetRows {
  explicit SheetRows(std::size_t points)
      : before{std::vector<double>(points), std::vector<double>(points), std::vector<double>(points)},
        after{before},
        knots_before{before},
        knots_after{before} {}
  EdgeRow before, after, knots_before, knots_after;
};

// A Sheet places rows: `place(step, begin, end, row)` edge points, `place_knots` knots; `range(first, last)` are the
// points that matter between two steps, `sag(knot, axis)` is how far points can be beside the lines between the knots,
// in the row's units; `points()` counts.
template <typename Sheet>
void sweep_sheet(const Sheet& sheet, std::int64_t first, std::int64_t last, double highest, PatchCanvas& canvas,
                 SheetRows& rows) {
  const auto points = static_cast<int>(sheet.points());
  std::int64_t knots_at = first - 1;  // the step that knots_before holds
  for (std::int64_t from = first; from < last; from += kSheetSteps) {
    const std::int64_t to = std::min<std::int64_t>(from + kSheetSteps, last);
    const EdgeRange range = sheet.range(from, to);
    if (range.end - range.begin < 2) continue;
    const int low = range.begin / kSheetPoints, high = (range.end - 2) / kSheetPoints + 2;  // knots
    EdgeRow &a = rows.knots_before, &b = rows.knots_after;
    if (knots_at != from || a.begin > low || a.end < high) sheet.place_knots(from, low, high, a);
    sheet.place_knots(to, low, high, b);
    int seen = high, seen_end = low;
    for (int k = low; k + 1 < high; ++k) {
      const auto n = static_cast<std::size_t>(k);
      const auto least = [&](const std::vector<double>& p, const std::vector<double>& q) {
        return std::min(std::min(p[n], p[n + 1]), std::min(q[n], q[n + 1]));
      };
      const auto most = [&](const std::vector<double>& p, const std::vector<double>& q) {
        return std::max(std::max(p[n], p[n + 1]), std::max(q[n], q[n + 1]));
      };
      const double lowest = least(a.z, b.z) - sheet.sag(k, 2);
      if (lowest > highest) continue;
      const double x = sheet.sag(k, 0), y = sheet.sag(k, 1);
      if (!canvas.may_lower(least(a.x, b.x) - x, most(a.x, b.x) + x, least(a.y, b.y) - y, most(a.y, b.y) + y, lowest))
        continue;
      seen = std::min(seen, k);
      seen_end = k + 1;
    }
    std::swap(a, b);
    knots_at = to;
    if (seen >= seen_end) continue;
    const int begin = std::max(range.begin, seen * kSheetPoints),
              end = std::min({range.end, seen_end * kSheetPoints + 1, points});
    sheet.place(from, begin, end, rows.before);
    for (std::int64_t step = from + 1; step <= to; ++step) {
      sheet.place(step, begin, end, rows.after);
      canvas.sweep(rows.before, rows.after, highest);
      std::swap(rows.before, rows.after);
    }
  }
}

}  // namespace stillcut
