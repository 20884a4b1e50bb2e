// A horizontal slice of the workpiece as milling leaves it: its contour is made of straight segments, whatever an edge
// sweeps over is cut away, and an edge's chip is what of the slice still stands between the tool's axis and the edge.
// Slices on top of each other are the multibody paper's workpiece (Huynh et al. 2017, section 2.2, after the "eraser of
// matter" of Peigne et al. 2003); models/part_milling mills in them.
//
// A slice is kept as square tiles, each with its own contours, so that a cut costs what lies near the tool and not what
// the part is long. The lines between tiles are no contour: a length of material along a line is the sum over its
// tiles.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "models/contour.hpp"

namespace stillcut {

class PartSlice {
 public:
  // Material is what an odd number of the contours enclose, so that a contour within another is a hole. Points are
  // rounded to 0.1 nm. `tile` in m. Throws std::invalid_argument for contours of fewer than three points or none,
  // points that are not finite, a part larger than 10 m or than a million tiles, or a tile outside 10 um to 100 mm.
  explicit PartSlice(std::span<const Contour> contours, double tile = 1e-3);

  // Takes away what a polygon covers (m, either sense of turning; it may cross itself, both lobes then count). Pieces
  // below 0.01 um^2 that rounding leaves behind go too.
  void erase(std::span<const Eigen::Vector2d> swept);

  // How much of the straight line between two points lies in material, m.
  [[nodiscard]] double material_along(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;

  // How far from the first point the line meets material, m: 0 where it begins there, infinite where it meets none.
  [[nodiscard]] double free_way(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;

  [[nodiscard]] double area() const;  // m^2

  // What is left, tiles joined: outer contours counter-clockwise, holes clockwise. For pictures: what meets along a
  // line between tiles only is not always joined.
  [[nodiscard]] std::vector<Contour> contours() const;

 private:
  // 0.1 nm each, from the slice's corner of smallest x and y.
  struct GridPoint {
    std::int64_t x = 0, y = 0;
  };
  using Path = std::vector<GridPoint>;
  struct Bounds {
    std::int64_t left = 0, bottom = 0, right = -1, top = -1;  // nothing in it
  };
  struct Tile {
    std::vector<Path> paths;
    Bounds bounds;  // of what is left
  };
  friend struct SliceClipping;  // all that knows Clipper, in the .cpp

  [[nodiscard]] GridPoint grid_point(const Eigen::Vector2d& point) const;
  [[nodiscard]] Bounds tiles_in(const Bounds& bounds) const;  // first and last column and row
  [[nodiscard]] Tile& tile(std::int64_t column, std::int64_t row);

  template <typename Cross>
  void cross_tiles(const Eigen::Vector2d& from, const Eigen::Vector2d& to, Cross cross) const;

  Eigen::Vector2d corner_ = Eigen::Vector2d::Zero();
  std::int64_t tile_size_ = 0, columns_ = 0, rows_ = 0;
  std::vector<Tile> tiles_;
};

}  // namespace stillcut
