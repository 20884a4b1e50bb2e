#include "models/path_envelope.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>

namespace stillcut {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();
constexpr std::size_t kFinest = 8;  // points a side of a tile that is not divided further

}  // namespace

PathEnvelope::PathEnvelope(const CutterPath& path, const Eigen::Vector2d& origin)
    : path_{&path}, origin_{origin}, strokes_{path_strokes(path, true)} {}

// A tile is divided until few strokes can be lowest in it: those whose lower bound over it is below the least of all
// upper bounds.
struct PathEnvelope::Layer {
  const PathEnvelope& envelope;
  const HeightMap& grid;
  const MapTile& whole;
  std::vector<EnvelopePoint>& points;

  [[nodiscard]] double x(std::size_t i) const {
    return envelope.origin_.x() + static_cast<double>(i) * grid.spacing_along;
  }
  [[nodiscard]] double y(std::size_t j) const {
    return envelope.origin_.y() + static_cast<double>(j) * grid.spacing_across;
  }

  void lay(const MapTile& tile, std::span<const std::uint32_t> among) const {
    const double low_x = x(tile.along_begin), high_x = x(tile.along_end - 1), low_y = y(tile.across_begin),
                 high_y = y(tile.across_end - 1);
    const double middle_x = 0.5 * (low_x + high_x), middle_y = 0.5 * (low_y + high_y);
    std::vector<double> lows(among.size());
    double least = kNowhere;
    for (std::size_t n = 0; n < among.size(); ++n) {
      const BallStroke& stroke = envelope.strokes_[among[n]];
      lows[n] = lowest_in_box(stroke, middle_x, middle_y, 0.5 * (high_x - low_x), 0.5 * (high_y - low_y));
      if (!(lows[n] < least)) continue;
      double highest = -kNowhere;
      for (const double corner_x : {low_x, high_x})
        for (const double corner_y : {low_y, high_y})
          highest = std::max(highest, lowest_over(stroke, corner_x, corner_y).height);
      least = std::min(least, highest);
    }
    std::vector<std::uint32_t> left;
    for (std::size_t n = 0; n < among.size(); ++n)
      if (lows[n] < kNowhere && lows[n] <= least) left.push_back(among[n]);
    const std::size_t along = tile.along_end - tile.along_begin, across = tile.across_end - tile.across_begin;
    if (left.size() < 4 || (along <= kFinest && across <= kFinest)) return lay_points(tile, left);
    const std::size_t at_x = tile.along_begin + (along > kFinest ? (along + 1) / 2 : along),
                      at_y = tile.across_begin + (across > kFinest ? (across + 1) / 2 : across);
    for (const auto& [from_x, to_x] : {std::pair{tile.along_begin, at_x}, std::pair{at_x, tile.along_end}})
      for (const auto& [from_y, to_y] : {std::pair{tile.across_begin, at_y}, std::pair{at_y, tile.across_end}})
        if (from_x < to_x && from_y < to_y) lay({from_x, to_x, from_y, to_y}, left);
  }

  void lay_points(const MapTile& tile, std::span<const std::uint32_t> among) const {
    for (std::size_t j = tile.across_begin; j < tile.across_end; ++j)
      for (std::size_t i = tile.along_begin; i < tile.along_end; ++i) {
        StrokeLow best{.height = kNowhere};
        const BallStroke* stroke = nullptr;
        for (const std::uint32_t n : among) {
          const StrokeLow low = lowest_over(envelope.strokes_[n], x(i), y(j));
          if (low.height < best.height) best = low, stroke = &envelope.strokes_[n];
        }
        if (stroke == nullptr) continue;
        const Eigen::Vector3d centre = stroke->from + best.share * stroke->way;
        const PathPiece& piece = envelope.path_->pieces[stroke->piece];
        const double share = stroke->begin + best.share * (stroke->end - stroke->begin);
        const Eigen::Vector3d axis = ball_pose(*envelope.path_, piece, share * piece.duration).orientation.col(2);
        const Eigen::Vector3d outward =
            Eigen::Vector3d(best.away.x(), best.away.y(), best.height - centre.z()) / stroke->radius;
        const std::size_t row = (j - whole.across_begin) * (whole.along_end - whole.along_begin);
        points[row + i - whole.along_begin] = {best.height, std::acos(std::clamp(-outward.dot(axis), -1.0, 1.0)),
                                               stroke->piece};
      }
  }
};

std::vector<EnvelopePoint> PathEnvelope::over(const HeightMap& grid, const MapTile& tile) const {
  std::vector<EnvelopePoint> points((tile.along_end - tile.along_begin) * (tile.across_end - tile.across_begin));
  std::vector<std::uint32_t> all(strokes_.size());
  std::iota(all.begin(), all.end(), 0U);
  Layer{*this, grid, tile, points}.lay(tile, all);
  return points;
}

void remove_envelope(HeightMap& map, const HeightMap& envelope) {
  if (map.heights.size() != envelope.heights.size())
    throw std::invalid_argument("the envelope must have as many points as the map");
  for (std::size_t i = 0; i < map.heights.size(); ++i) map.heights[i] -= envelope.heights[i];
}

}  // namespace stillcut
