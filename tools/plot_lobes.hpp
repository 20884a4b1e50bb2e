// The picture of a stability lobe diagram: limit depth over spindle speed, the chatter frequency below, the cell's own
// cut as a point.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "models/depth_limit.hpp"
#include "tools/plot.hpp"

namespace stillcut {

struct LobePicture {
  std::string title, subtitle;
  std::span<const double> speeds;  // rad/s
  std::span<const DepthLimit> limits;
  double max_depth = 0.0;  // m, drawn where there is no limit
  double cut_speed = 0.0;  // rad/s, the cell's cut
  double cut_depth = 0.0;  // m
};

plot::Figure lobe_figure(const LobePicture& picture);

}  // namespace stillcut
