#include "models/swept_patches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace stillcut {
namespace {

constexpr std::size_t kBlock = 8;  // points a side
// In points of the map. Neighbouring patches may both claim a point on the line between them, none may miss it.
constexpr double kSlack = 1e-9;

}  // namespace

HeightMap uncut_map(double along, double across, double spacing) {
  if (!(along > 0.0 && across > 0.0 && spacing > 0.0) || !std::isfinite(along) || !std::isfinite(across))
    throw std::invalid_argument("a surface needs a positive size and spacing");
  const auto cells = [spacing](double length) {
    return static_cast<std::size_t>(std::max(1.0, std::ceil(length / spacing * (1.0 - 1e-12))));
  };
  return uncut_map(along, across, cells(along), cells(across));
}

HeightMap uncut_map(double along, double across, std::size_t cells_along, std::size_t cells_across) {
  if (!(along > 0.0 && across > 0.0) || !std::isfinite(along) || !std::isfinite(across) || cells_along == 0 ||
      cells_across == 0)
    throw std::invalid_argument("a surface needs a positive size and cells in both directions");
  HeightMap map;
  map.along = cells_along + 1;
  map.across = cells_across + 1;
  map.spacing_along = along / static_cast<double>(cells_along);
  map.spacing_across = across / static_cast<double>(cells_across);
  map.heights.assign(map.along * map.across, std::numeric_limits<double>::quiet_NaN());
  return map;
}

std::vector<MapTile> map_tiles(const HeightMap& map, std::size_t points) {
  std::vector<MapTile> tiles;
  for (std::size_t j = 0; j < map.across; j += points)
    for (std::size_t i = 0; i < map.along; i += points)
      tiles.push_back({i, std::min(i + points, map.along), j, std::min(j + points, map.across)});
  return tiles;
}

PatchCanvas::PatchCanvas(HeightMap& map, const MapTile& tile)
    : map_{map},
      tile_{tile},
      blocks_along_{(tile.along_end - tile.along_begin + kBlock - 1) / kBlock},
      blocks_across_{(tile.across_end - tile.across_begin + kBlock - 1) / kBlock},
      block_highest_(blocks_along_ * blocks_across_),
      touched_(block_highest_.size(), 1) {
  settle();
}

void PatchCanvas::settle() {
  for (std::size_t block = 0; block < touched_.size(); ++block) {
    if (!touched_[block]) continue;
    touched_[block] = 0;
    const std::size_t from_x = tile_.along_begin + block % blocks_along_ * kBlock,
                      from_y = tile_.across_begin + block / blocks_along_ * kBlock;
    const std::size_t to_x = std::min(from_x + kBlock, tile_.along_end),
                      to_y = std::min(from_y + kBlock, tile_.across_end);
    double highest = -std::numeric_limits<double>::infinity();
    for (std::size_t j = from_y; j < to_y; ++j)
      for (std::size_t i = from_x; i < to_x; ++i) {
        const double height = map_.at(i, j);  // NaN: not cut yet
        highest = height <= highest ? highest : std::isnan(height) ? std::numeric_limits<double>::infinity() : height;
      }
    block_highest_[block] = highest;
  }
}

PatchCanvas::Block PatchCanvas::block(std::size_t number) const {
  const std::size_t from_x = tile_.along_begin + number % blocks_along_ * kBlock,
                    from_y = tile_.across_begin + number / blocks_along_ * kBlock;
  const auto half = [](std::size_t from, std::size_t end) {
    return 0.5 * static_cast<double>(std::min(from + kBlock, end) - 1 - from);
  };
  const double half_x = half(from_x, tile_.along_end), half_y = half(from_y, tile_.across_end);
  return {static_cast<double>(from_x) + half_x, static_cast<double>(from_y) + half_y, half_x, half_y,
          block_highest_[number]};
}

double PatchCanvas::highest() const { return *std::max_element(block_highest_.begin(), block_highest_.end()); }

bool PatchCanvas::hidden(const Box& box, double lowest) const {
  const std::size_t low_x = (box.low_x - tile_.along_begin) / kBlock,
                    high_x = (box.high_x - tile_.along_begin) / kBlock;
  const std::size_t high_y = (box.high_y - tile_.across_begin) / kBlock;
  for (std::size_t y = (box.low_y - tile_.across_begin) / kBlock; y <= high_y; ++y)
    for (std::size_t x = low_x; x <= high_x; ++x)
      if (lowest < block_highest_[y * blocks_along_ + x]) return false;
  return true;
}

void PatchCanvas::touch(const Box& box) {
  const std::size_t low_x = (box.low_x - tile_.along_begin) / kBlock,
                    high_x = (box.high_x - tile_.along_begin) / kBlock;
  const std::size_t high_y = (box.high_y - tile_.across_begin) / kBlock;
  for (std::size_t y = (box.low_y - tile_.across_begin) / kBlock; y <= high_y; ++y)
    for (std::size_t x = low_x; x <= high_x; ++x) touched_[y * blocks_along_ + x] = 1;
}

void PatchCanvas::lower(const Corner& a, const Corner& b, const Corner& c, const Box& box) {
  const double bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
  const double twice_area = bx * cy - cx * by;
  if (twice_area == 0.0) return;  // seen edge-on: its neighbours have its points
  const double sign = twice_area > 0.0 ? 1.0 : -1.0, area = std::abs(twice_area);
  const double lowest = std::min({a.z, b.z, c.z});
  for (std::size_t j = box.low_y; j <= box.high_y; ++j) {
    const double y = static_cast<double>(j) - a.y;
    double* row = &map_.heights[j * map_.along];
    for (std::size_t i = box.low_x; i <= box.high_x; ++i) {
      const double x = static_cast<double>(i) - a.x;
      const double to_b = sign * (x * cy - cx * y), to_c = sign * (bx * y - x * by);
      if (to_b < -kSlack || to_c < -kSlack || to_b + to_c > area + kSlack) continue;
      // A sliver's slack may reach beyond its corners.
      const double height = std::max(lowest, a.z + (to_b * (b.z - a.z) + to_c * (c.z - a.z)) / area);
      ++count_.heights;
      if (!(row[i] <= height)) row[i] = height;
    }
  }
}

// The points of the tile in a box; none: false.
inline bool PatchCanvas::box_of(double low_x, double high_x, double low_y, double high_y, Box& box) const {
  const auto first_x = static_cast<double>(tile_.along_begin), last_x = static_cast<double>(tile_.along_end - 1);
  const auto first_y = static_cast<double>(tile_.across_begin), last_y = static_cast<double>(tile_.across_end - 1);
  if (!(high_x >= first_x && low_x <= last_x && high_y >= first_y && low_y <= last_y)) return false;
  const auto up = [](double from, double v) {
    v = std::max(from, v);
    const auto whole = static_cast<std::int64_t>(v);
    return static_cast<std::size_t>(whole + (static_cast<double>(whole) < v));
  };
  const auto down = [](double to, double v) {
    return static_cast<std::size_t>(static_cast<std::int64_t>(std::min(to, v)));
  };
  box = {up(first_x, low_x), down(last_x, high_x), up(first_y, low_y), down(last_y, high_y)};
  return box.low_x <= box.high_x && box.low_y <= box.high_y;
}

bool PatchCanvas::may_lower(double low_x, double high_x, double low_y, double high_y, double lowest) const {
  Box box{};
  return box_of(low_x - kSlack, high_x + kSlack, low_y - kSlack, high_y + kSlack, box) && !hidden(box, lowest);
}

void PatchCanvas::sweep(const EdgeRow& before, const EdgeRow& after, double highest) {
  const int begin = std::max(before.begin, after.begin), end = std::min(before.end, after.end);
  for (int i = begin; i + 1 < end; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const double lowest = std::min(std::min(before.z[n], before.z[n + 1]), std::min(after.z[n], after.z[n + 1]));
    if (lowest > highest) continue;
    const double low_x =
        std::min(std::min(before.x[n], before.x[n + 1]), std::min(after.x[n], after.x[n + 1])) - kSlack;
    const double high_x =
        std::max(std::max(before.x[n], before.x[n + 1]), std::max(after.x[n], after.x[n + 1])) + kSlack;
    const double low_y =
        std::min(std::min(before.y[n], before.y[n + 1]), std::min(after.y[n], after.y[n + 1])) - kSlack;
    const double high_y =
        std::max(std::max(before.y[n], before.y[n + 1]), std::max(after.y[n], after.y[n + 1])) + kSlack;
    ++count_.patches;
    Box box{};
    if (!box_of(low_x, high_x, low_y, high_y, box) || hidden(box, lowest)) continue;
    const Corner a{before.x[n], before.y[n], before.z[n]}, b{before.x[n + 1], before.y[n + 1], before.z[n + 1]};
    const Corner c{after.x[n + 1], after.y[n + 1], after.z[n + 1]}, d{after.x[n], after.y[n], after.z[n]};
    lower(a, b, c, box);
    lower(a, c, d, box);
    touch(box);
  }
}

}  // namespace stillcut
