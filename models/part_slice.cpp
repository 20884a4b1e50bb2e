#include "models/part_slice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <polyclipping/clipper.hpp>
#include <stdexcept>

namespace stillcut {
namespace {

constexpr double kGrain = 1e-10;       // m, of the grid that contours stand on
constexpr double kLargestPart = 10.0;  // m
constexpr double kSliverArea = 1e6;    // grains^2, 0.01 um^2: less is what rounding left between two cuts
constexpr std::int64_t kMostTiles = 1'000'000;

}  // namespace

struct SliceClipping {
  using Path = PartSlice::Path;
  using Bounds = PartSlice::Bounds;
  using Tile = PartSlice::Tile;

  static ClipperLib::Path to_clipper(const Path& path) {
    ClipperLib::Path result;
    result.reserve(path.size());
    for (const auto& point : path) result.emplace_back(point.x, point.y);
    return result;
  }

  static void add(ClipperLib::Clipper& clipper, const std::vector<Path>& paths, ClipperLib::PolyType type) {
    for (const Path& path : paths) clipper.AddPath(to_clipper(path), type, true);
  }

  static Bounds bounds_of(const std::vector<Path>& paths) {
    constexpr std::int64_t kFar = std::numeric_limits<std::int64_t>::max();
    Bounds bounds{kFar, kFar, -kFar, -kFar};
    for (const Path& path : paths)
      for (const auto& [x, y] : path) {
        bounds.left = std::min(bounds.left, x);
        bounds.right = std::max(bounds.right, x);
        bounds.bottom = std::min(bounds.bottom, y);
        bounds.top = std::max(bounds.top, y);
      }
    return bounds;
  }

  static bool meet(const Bounds& a, const Bounds& b) {
    return a.left <= b.right && b.left <= a.right && a.bottom <= b.top && b.bottom <= a.top;
  }

  static std::vector<Path> solve(ClipperLib::Clipper& clipper, ClipperLib::ClipType type,
                                 ClipperLib::PolyFillType fill) {
    ClipperLib::Paths solution;
    clipper.Execute(type, solution, fill, ClipperLib::pftNonZero);
    std::vector<Path> paths;
    for (const ClipperLib::Path& found : solution) {
      if (!(std::abs(ClipperLib::Area(found)) > kSliverArea)) continue;
      Path& path = paths.emplace_back();
      path.reserve(found.size());
      for (const ClipperLib::IntPoint& point : found) path.push_back({point.X, point.Y});
    }
    return paths;
  }

  static Path rectangle(const Bounds& b) {
    return {{b.left, b.bottom}, {b.right, b.bottom}, {b.right, b.top}, {b.left, b.top}};
  }

  static void fill(Tile& tile, const std::vector<Path>& part, const Bounds& square) {
    ClipperLib::Clipper clipper;
    add(clipper, part, ClipperLib::ptSubject);
    add(clipper, {rectangle(square)}, ClipperLib::ptClip);
    set(tile, solve(clipper, ClipperLib::ctIntersection, ClipperLib::pftEvenOdd));
  }

  static void subtract(Tile& tile, const Path& swept) {
    ClipperLib::Clipper clipper;
    add(clipper, tile.paths, ClipperLib::ptSubject);
    clipper.AddPath(to_clipper(swept), ClipperLib::ptClip, true);
    set(tile, solve(clipper, ClipperLib::ctDifference, ClipperLib::pftNonZero));
  }

  static void set(Tile& tile, std::vector<Path> paths) {
    tile.paths = std::move(paths);
    tile.bounds = tile.paths.empty() ? Bounds{} : bounds_of(tile.paths);
  }

  static std::vector<Path> joined(const std::vector<Tile>& tiles) {
    ClipperLib::Clipper clipper;
    for (const Tile& tile : tiles) add(clipper, tile.paths, ClipperLib::ptSubject);
    return solve(clipper, ClipperLib::ctUnion, ClipperLib::pftNonZero);
  }
};

PartSlice::PartSlice(std::span<const Contour> contours, double tile) {
  if (contours.empty()) throw std::invalid_argument("a part needs a contour");
  if (!(tile >= 1e-5 && tile <= 0.1)) throw std::invalid_argument("a tile must measure between 10 um and 100 mm");
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Contour& contour : contours) {
    if (contour.size() < 3) throw std::invalid_argument("a contour needs at least three points");
    for (const Eigen::Vector2d& point : contour) {
      if (!point.allFinite()) throw std::invalid_argument("a contour has a point that is not finite");
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
  }
  if ((high - low).maxCoeff() > kLargestPart) throw std::invalid_argument("a part larger than 10 m");
  corner_ = low;
  tile_size_ = std::llround(tile / kGrain);
  const GridPoint far = grid_point(high);
  columns_ = far.x / tile_size_ + 1;
  rows_ = far.y / tile_size_ + 1;
  if (columns_ * rows_ > kMostTiles)
    throw std::invalid_argument("a part of more than a million tiles; make them larger");

  std::vector<Path> part;
  for (const Contour& contour : contours) {
    Path& path = part.emplace_back();
    for (const Eigen::Vector2d& point : contour) path.push_back(grid_point(point));
  }
  tiles_.resize(static_cast<std::size_t>(columns_ * rows_));
  for (std::int64_t row = 0; row < rows_; ++row)
    for (std::int64_t column = 0; column < columns_; ++column)
      SliceClipping::fill(this->tile(column, row), part,
                          {column * tile_size_, row * tile_size_, (column + 1) * tile_size_, (row + 1) * tile_size_});
}

PartSlice::GridPoint PartSlice::grid_point(const Eigen::Vector2d& point) const {
  const Eigen::Vector2d from_corner = (point - corner_) / kGrain;
  return {std::llround(from_corner.x()), std::llround(from_corner.y())};
}

PartSlice::Tile& PartSlice::tile(std::int64_t column, std::int64_t row) {
  return tiles_[static_cast<std::size_t>(row * columns_ + column)];
}

PartSlice::Bounds PartSlice::tiles_in(const Bounds& bounds) const {
  const auto index = [&](std::int64_t at) { return at >= 0 ? at / tile_size_ : -1; };
  return {std::max<std::int64_t>(0, index(bounds.left)), std::max<std::int64_t>(0, index(bounds.bottom)),
          std::min(columns_ - 1, index(bounds.right)), std::min(rows_ - 1, index(bounds.top))};
}

void PartSlice::erase(std::span<const Eigen::Vector2d> swept) {
  Path path;
  path.reserve(swept.size());
  for (const Eigen::Vector2d& point : swept) path.push_back(grid_point(point));
  const Bounds bounds = SliceClipping::bounds_of({path});
  const Bounds range = tiles_in(bounds);
  for (std::int64_t row = range.bottom; row <= range.top; ++row)
    for (std::int64_t column = range.left; column <= range.right; ++column) {
      Tile& at = tile(column, row);
      if (!at.paths.empty() && SliceClipping::meet(at.bounds, bounds)) SliceClipping::subtract(at, path);
    }
}

// Tells `cross` of every contour that the line through two points crosses, in tiles near them: where, as a share of the
// way between the points, and whether the line enters material there. Before, between and behind the points count, so
// that the crossings before the first one tell whether it stands in material. Material lies to the left of every path:
// one that passes from the line's left to its right has it ahead.
template <typename Cross>
void PartSlice::cross_tiles(const Eigen::Vector2d& from, const Eigen::Vector2d& to, Cross cross) const {
  const Eigen::Vector2d begin = (from - corner_) / kGrain, way = (to - from) / kGrain, end = begin + way;
  const auto below = [](double value) { return static_cast<std::int64_t>(std::floor(value)); };
  const Bounds bounds{below(std::min(begin.x(), end.x())) - 1, below(std::min(begin.y(), end.y())) - 1,
                      below(std::max(begin.x(), end.x())) + 1, below(std::max(begin.y(), end.y())) + 1};
  const Bounds range = tiles_in(bounds);
  const double length_squared = way.squaredNorm();
  const auto relative = [&](const GridPoint& point) {
    return Eigen::Vector2d(static_cast<double>(point.x) - begin.x(), static_cast<double>(point.y) - begin.y());
  };
  for (std::int64_t row = range.bottom; row <= range.top; ++row)
    for (std::int64_t column = range.left; column <= range.right; ++column) {
      const Tile& at = tiles_[static_cast<std::size_t>(row * columns_ + column)];
      if (at.paths.empty() || !SliceClipping::meet(at.bounds, bounds)) continue;
      for (const Path& path : at.paths) {
        Eigen::Vector2d last = relative(path.back());
        double last_side = way.x() * last.y() - way.y() * last.x();
        for (const GridPoint& point : path) {
          const Eigen::Vector2d now = relative(point);
          const double side = way.x() * now.y() - way.y() * now.x();
          if ((last_side > 0.0) != (side > 0.0)) {
            const double part = last_side / (last_side - side);
            cross(way.dot(last + part * (now - last)) / length_squared, last_side > 0.0);
          }
          last = now;
          last_side = side;
        }
      }
    }
}

double PartSlice::material_along(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
  double share = 0.0;
  if (from == to) return 0.0;
  cross_tiles(from, to, [&](double at, bool enters) {
    const double behind = 1.0 - std::clamp(at, 0.0, 1.0);
    share += enters ? behind : -behind;
  });
  return std::max(0.0, share) * (to - from).norm();
}

double PartSlice::free_way(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
  double share = std::numeric_limits<double>::infinity();
  int depth = 0;
  if (from == to) throw std::invalid_argument("a line needs two points");
  cross_tiles(from, to, [&](double at, bool enters) {
    if (at <= 0.0) depth += enters ? 1 : -1;
    if (at > 0.0 && at <= 1.0 && enters) share = std::min(share, at);
  });
  return depth > 0 ? 0.0 : share * (to - from).norm();
}

double PartSlice::area() const {
  double sum = 0.0;
  for (const Tile& tile : tiles_)
    for (const Path& path : tile.paths) sum += ClipperLib::Area(SliceClipping::to_clipper(path));
  return sum * kGrain * kGrain;
}

std::vector<Contour> PartSlice::contours() const {
  std::vector<Contour> result;
  for (const Path& path : SliceClipping::joined(tiles_)) {
    Contour& contour = result.emplace_back();
    for (const auto& [x, y] : path)
      contour.push_back(corner_ + kGrain * Eigen::Vector2d(static_cast<double>(x), static_cast<double>(y)));
  }
  return result;
}

}  // namespace stillcut
