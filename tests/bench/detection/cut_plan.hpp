// The cuts of the detection benchmark, drawn from a seed: tool, structure, depths, speed and what goes wrong with the
// sensors. How fast the chatter grows is drawn, and the depth chosen for it by Floquet theory. A plan is a plain value:
// the same list and index give the same cut to the bit.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "dsp/line_watch.hpp"
#include "models/cut_schedule.hpp"

namespace stillcut::detection {

enum class SeedList : std::uint8_t { tuning, judging };

enum class CutKind : std::uint8_t {
  tool_chatter,
  structural_chatter,  // of a robot mode at 8-20 Hz
  both_kinds,
  forced_near_mode,  // a tooth harmonic swept across a mode, or held within 3 Hz of it
  steady,
  speed_ramp,
  entries,  // and exits
  knocks,
  interrupted,
  deeper,  // to a depth that is sound as well, and back
};
std::string_view name(CutKind kind);
constexpr bool chatters(CutKind kind) { return kind <= CutKind::both_kinds; }

struct CutPlan {
  CutKind kind = CutKind::steady;
  std::uint64_t seed = 1;
  MillingSetup setup;
  CutSchedule schedule;
  double duration = 0.0;        // s
  double sensor_rate_hz = 0.0;  // per axis
  double snr_db = 0.0;          // of chatter at half the forced displacement, in 100 Hz .. 0.4 of the rate
  double slow_heard_at = 0.0;   // m, of the robot's chatter: where three times the noise in 2-100 Hz is reached

  double growth = 0.0;      // spectral radius per tooth period at the last depth
  double chatter_hz = 0.0;  // that theory predicts, of the faster kind; a stable cut: of its tool mode
  double slow_hz = 0.0;     // of the robot mode that chatters; 0: none
  double slow_growth_per_s = 0.0, growth_per_s = 0.0;
  double limit = 0.0;                                   // m, depth limit
  double unstable_from = 0.0, unstable_depth_at = 0.0;  // s, the depth leaves its stable value and has got there
  double reference_from = 0.0, reference_to = 0.0;      // s: sound, settled cutting, for the forced amplitude
  double reference_scale = 1.0;                         // last depth over the depth then

  std::vector<double> knocks;  // s
  double knock = 0.0;          // N s
  bool frames_lost = false;
  double speed_jitter = 0.0;            // s, of the speed messages
  bool speed_gaps = false;              // of 50 ms
  std::vector<ExpectedMode> map_modes;  // what a measured map knows of the structure: 2 % off
  double map_limit = 0.0;               // m, and of the limit: 20 % off
};

// What the benchmark mills: of every kind in turn, the most of tool chatter; or sound cuts only.
CutKind mixed_kind(int index);
CutKind sound_kind(int index);
// How long a sound cut lasts at least, s.
inline constexpr double kSoundCut = 4.0;

CutPlan draw_cut(SeedList list, int index, CutKind kind);

}  // namespace stillcut::detection
