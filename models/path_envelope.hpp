// The surface that a ball without teeth, runout and vibration leaves as it follows a tool path: what the path itself
// makes, its scallops and chords. What lies above it are the marks of the teeth, runout and vibration.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <vector>

#include "models/ball_stroke.hpp"
#include "models/height_map.hpp"
#include "models/swept_patches.hpp"

namespace stillcut {

struct EnvelopePoint {
  double height = std::numeric_limits<double>::quiet_NaN();  // m; NaN where the path does not come
  double kappa = 0.0;     // rad from the tool's tip; from a right angle on the shank touches there, not the ball
  std::size_t piece = 0;  // of the path
};

class PathEnvelope {
 public:
  // Point (0, 0) of the maps lies at `origin`, m in workpiece X and Y. The path must outlive it.
  PathEnvelope(const CutterPath& path, const Eigen::Vector2d& origin);

  // Over the points of a tile of such a grid, row by row.
  [[nodiscard]] std::vector<EnvelopePoint> over(const HeightMap& grid, const MapTile& tile) const;

 private:
  struct Layer;
  const CutterPath* path_;
  Eigen::Vector2d origin_;
  std::vector<BallStroke> strokes_;
};

// Subtracts the envelope: what is left are the marks of the teeth, runout and vibration, without the path's scallops.
// NaN where either is.
void remove_envelope(HeightMap& map, const HeightMap& envelope);

}  // namespace stillcut
