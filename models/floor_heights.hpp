// The floor that a simulated cut of a ball end leaves along its track: the edges swept (models/surface_sweep) with the
// motion that the simulation gave the tool. The line is a quarter of the step-over beside the middle, on the left seen
// along the feed, at most a fortieth of the diameter: in the very middle the tip of an upright ball draws its own
// motion without any feed marks, and the ridge is the neighbour's as well.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "models/machining.hpp"

namespace stillcut {

// Where the tool was, and how it cut, at one sample of its motion.
struct TrackMark {
  std::size_t sample = 0;
  double along = 0.0;           // m along the track, rising
  double angle = 0.0;           // rad, tooth 0 from the cross-feed axis, turns counted on
  double feed_rate = 0.0;       // m/s
  double feed_direction = 0.0;  // rad
  double axial_depth = 0.0;     // m; 0: out of the part
};

struct CutTrack {
  double step = 0.0;                          // s between two samples
  std::vector<Eigen::Vector3f> displacement;  // m, workpiece axes, of every sample: floats, there are many
  std::vector<TrackMark> marks;               // rising, some twenty micrometres of way apart
};

// How far below the programmed surface the floor lies at `count` points, `spacing` apart from `from` on, m. All NaN
// where the track does not cover them, where the tool was out of the part, and where the feed stood or changed by half.
// Of feed and spindle speed the mean over the points counts; where they change, the marks are a little off before and
// behind the middle. Throws std::invalid_argument for contact that the sweep does not have (tilted onto the shank).
[[nodiscard]] std::vector<double> floor_heights(const Tool& tool, const Cut& cut, const CutTrack& track, double from,
                                                double spacing, std::size_t count);

}  // namespace stillcut
