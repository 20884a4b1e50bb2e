// A stability lobe diagram as the real-time thread reads it: fixed size, dated, complete. The model thread computes it
// for a posture; the core looks up margin and pockets in constant time.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

namespace stillcut {

struct LobePoint {
  double speed = 0.0;                 // spindle speed, rad/s
  double depth_limit = 0.0;           // m; +inf: stable to the largest depth asked; NaN: unstable at every depth
  double chatter_frequency_hz = 0.0;  // NaN where depth_limit is not finite
};

struct ModeSummary {
  double frequency_hz = 0.0;
  double damping_ratio = 0.0;
};

struct LobeDiagram {
  static constexpr int kMaxPoints = 256;
  static constexpr int kMaxModes = 16;

  bool valid = false;
  std::int64_t posture_stamp_ns = 0;  // stamp of the robot state it was computed for; 0: the cell file's posture
  std::int64_t usable_from_ns = 0;    // data time at which the core may start to use it
  int point_count = 0;
  int mode_count = 0;
  std::array<LobePoint, kMaxPoints> points{};  // equally spaced over the spindle's range, rising speed
  std::array<ModeSummary, kMaxModes> modes{};  // of the posture, rising frequency
};

static_assert(std::is_trivially_copyable_v<LobeDiagram>);

// Depth limit at a speed (rad/s): the smaller of the two points beside it, 0 where every depth is unstable, +inf where
// none is, NaN outside the diagram or without one. Constant time, fit for the loop.
double depth_limit_at(const LobeDiagram& diagram, double speed) noexcept;

// Margin a_lim/a - 1 of a cut of axial depth a (m) at a speed; NaN unknown. Constant time, fit for the loop.
double margin_at(const LobeDiagram& diagram, double speed, double axial_depth) noexcept;

}  // namespace stillcut
