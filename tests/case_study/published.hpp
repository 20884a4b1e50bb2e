// What Tunc and Stoddart (2017) print of their case study, and nothing of ours: Table 1, Table 2 and figures of the
// text.
#pragma once

#include <array>

#include "models/cut_stability.hpp"

namespace stillcut::case_study {

// How a plate is milled, in the order of Table 1's columns.
enum class Pattern { optimized, zig_0, zig_90, follow_periphery };
inline constexpr int kPatterns = 4;
inline constexpr std::array<const char*, kPatterns> kPatternNames{"Optimized", "ZIG0", "ZIG90", "Follow periphery"};

struct PatternFigures {
  double min_mm = 0.0, max_mm = 0.0;  // absolute limit over the plate
  double asi_percent = 0.0;           // mean over the plate of the limit over that of the best direction
};
using Table1 = std::array<PatternFigures, kPatterns>;
inline constexpr Table1 kTable1{
    {{0.158, 0.358, 100.0}, {0.147, 0.295, 89.0}, {0.105, 0.229, 69.0}, {0.119, 0.295, 79.0}}};

struct CutOfTable2 {
  double feed_direction_deg, depth_mm, speed_rpm;
  Verdict verdict;  // near_limit: the paper's "marginal"
};
inline constexpr std::array<CutOfTable2, 7> kTable2{{{0, 0.15, 3330, Verdict::stable},
                                                     {0, 0.30, 3330, Verdict::near_limit},
                                                     {0, 0.40, 3330, Verdict::unstable},
                                                     {0, 0.40, 3800, Verdict::stable},
                                                     {90, 0.15, 3000, Verdict::unstable},
                                                     {90, 0.40, 3420, Verdict::unstable},
                                                     {90, 0.20, 3420, Verdict::stable}}};

inline constexpr double kChatterLow_hz = 500.0, kChatterHigh_hz = 511.0;  // Fig. 13
inline constexpr double kBestZigLow_deg = 45.0, kBestZigHigh_deg = 55.0;  // Fig. 9b

}  // namespace stillcut::case_study
