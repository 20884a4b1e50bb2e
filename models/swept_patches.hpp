// Patches that an edge sweeps from one time step to the next, laid under the heights of a tile.
#pragma once

#include <cstdint>
#include <vector>

#include "models/height_map.hpp"

namespace stillcut {

// Points of a map: [begin, end) along and across.
struct MapTile {
  std::size_t along_begin = 0, along_end = 0, across_begin = 0, across_end = 0;
};

// Heights not cut yet over `along` x `across` m, the corners included, points at most `spacing` apart. Throws
// std::invalid_argument for sizes that are not positive.
[[nodiscard]] HeightMap uncut_map(double along, double across, double spacing);
// The same with so many cells in each direction, one point more than that.
[[nodiscard]] HeightMap uncut_map(double along, double across, std::size_t cells_along, std::size_t cells_across);

// A map cut into tiles of at most `points` x `points`.
[[nodiscard]] std::vector<MapTile> map_tiles(const HeightMap& map, std::size_t points = 256);

// Neighbouring points of an edge at one time: x and y counted in points of the map, z in m. Of the arrays, indexed by
// the edge's point, [begin, end) holds.
struct EdgeRow {
  std::vector<double> x, y, z;
  int begin = 0, end = 0;
};

struct SweepCount {
  std::int64_t patches = 0;  // swept
  std::int64_t heights = 0;  // of patches at grid points, compared with the map
};

// A tile of a map that is being cut. So that patches above the surface cost little, it knows the highest point of each
// block of the tile, as it was when settle() was last called: heights only sink, so nothing is missed.
class PatchCanvas {
 public:
  PatchCanvas(HeightMap& map, const MapTile& tile);

  // Lowers the tile to the patches between two rows, as far as they are below `highest`.
  void sweep(const EdgeRow& before, const EdgeRow& after, double highest);
  // Whether anything in a box (points of the map, m) could: it may then still lie above each point.
  [[nodiscard]] bool may_lower(double low_x, double high_x, double low_y, double high_y, double lowest) const;
  // Looks again at the blocks that patches have touched.
  void settle();

  // Blocks of the tile: middle and half size in points of the map, and as high as their highest point; infinite while
  // one is not cut.
  struct Block {
    double x, y, half_x, half_y, highest;
  };
  [[nodiscard]] std::size_t blocks() const { return block_highest_.size(); }
  [[nodiscard]] Block block(std::size_t number) const;
  [[nodiscard]] double highest() const;

  [[nodiscard]] const MapTile& tile() const { return tile_; }
  [[nodiscard]] const SweepCount& count() const { return count_; }

 private:
  struct Corner {
    double x, y, z;
  };
  struct Box {
    std::size_t low_x, high_x, low_y, high_y;  // points, inclusive
  };
  [[nodiscard]] bool box_of(double low_x, double high_x, double low_y, double high_y, Box& box) const;
  [[nodiscard]] bool hidden(const Box& box, double lowest) const;
  void touch(const Box& box);
  void lower(const Corner& a, const Corner& b, const Corner& c, const Box& box);

  HeightMap& map_;
  MapTile tile_;
  std::size_t blocks_along_ = 0, blocks_across_ = 0;
  std::vector<double> block_highest_;
  std::vector<std::uint8_t> touched_;
  SweepCount count_;
};

}  // namespace stillcut
