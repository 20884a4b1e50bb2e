// A stability lobe diagram as the real-time thread reads it: fixed size, dated, complete. The model thread computes it
// for a posture; the core looks up margin and pockets in constant time.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace stillcut {

struct LobePoint {
  double speed = 0.0;                 // spindle speed, rad/s
  double depth_limit = 0.0;           // m; +inf: stable to the largest depth asked; NaN: unstable at every depth
  double chatter_frequency_hz = 0.0;  // NaN where depth_limit is not finite
};

// The depth limit at one feed direction, at the speed that the diagram was asked for.
struct DirectionLimit {
  double direction = 0.0;    // rad, workpiece; a direction and its opposite have the same limit
  double depth_limit = 0.0;  // m, as in LobePoint
};

struct ModeSummary {
  double frequency_hz = 0.0;
  double damping_ratio = 0.0;
};

struct LobeDiagram {
  static constexpr int kMaxPoints = 256;
  static constexpr int kMaxModes = 16;
  static constexpr int kMaxDirections = 24;

  bool valid = false;
  std::int64_t posture_stamp_ns = 0;  // stamp of the robot state it was computed for; 0: the cell file's posture
  std::int64_t usable_from_ns = 0;    // data time at which the core may start to use it
  bool ahead = false;                 // the least limits along the announced path; false: of the present posture
  std::int64_t usable_until_ns = 0;   // of one ahead: the end of what was announced
  int point_count = 0;
  int mode_count = 0;
  int direction_count = 0;
  double direction_speed = 0.0;  // rad/s, that the limits over direction are for
  // rad, either sense: where the feed map would have the feed go at this place; NaN: it says nothing
  double planned_direction = std::numeric_limits<double>::quiet_NaN();
  double speed_scatter = 0.0;                  // relative standard deviation of the speeds at which the lobes lie
  double depth_scatter = 0.0;                  // relative standard deviation of the limits
  std::array<LobePoint, kMaxPoints> points{};  // equally spaced over the spindle's range, rising speed
  std::array<ModeSummary, kMaxModes> modes{};  // of the posture, rising frequency
  std::array<DirectionLimit, kMaxDirections> directions{};  // rising, equally spaced over half a turn
};

static_assert(std::is_trivially_copyable_v<LobeDiagram>);

// Where a speed (rad/s) lies among the points of a diagram, in spacings from the first one on: the whole part is the
// index of the point below, the rest how far it is on the way to the next. NaN outside, or without a diagram.
double place_among_points(const LobeDiagram& diagram, double speed) noexcept;

// Depth limit at a speed (rad/s): the smaller of the two points beside it, 0 where every depth is unstable, +inf where
// none is, NaN outside the diagram or without one. Constant time, fit for the loop.
double depth_limit_at(const LobeDiagram& diagram, double speed) noexcept;

// Margin a_lim/a - 1 of a cut of axial depth a (m) at a speed; NaN unknown. Constant time, fit for the loop.
double margin_at(const LobeDiagram& diagram, double speed, double axial_depth) noexcept;

}  // namespace stillcut
