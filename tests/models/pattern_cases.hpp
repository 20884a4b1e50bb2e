// Patterns of random tools in random regions.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "models/path_patterns.hpp"
#include "tests/models/machined_regions.hpp"

namespace stillcut::test {

inline constexpr std::array kAllPatterns{PatternKind::zig,           PatternKind::zig_zag,   PatternKind::periphery_in,
                                         PatternKind::periphery_out, PatternKind::spiral_in, PatternKind::spiral_out};
inline constexpr double kChord = 12e-6;  // m, by which chords may leave their arc, and what is no gap
inline constexpr double kHeight = 2e-3, kClearance = 4e-3;

inline PatternSettings tool(double diameter_mm, double step_over_mm, Milling milling = Milling::down) {
  PatternSettings settings;
  settings.tool_radius = 0.5e-3 * diameter_mm;
  settings.step_over = 1e-3 * step_over_mm;
  settings.z = kHeight;
  settings.clearance = kClearance;
  settings.milling = milling;
  return settings;
}

inline Region square() { return {box_mm(0, 0, 300, 300), {}}; }
inline bool of_lines(PatternKind kind) { return kind == PatternKind::zig || kind == PatternKind::zig_zag; }
inline Eigen::Vector2d direction(const PathMove& move) { return (move.to - move.from).head<2>().normalized(); }

// Calls with every pattern of random tools and steps in random regions.
template <typename Check>
void in_random_regions(int regions, bool face, double largest_step, Check check) {
  std::mt19937 random(2017);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int i = 0; i < regions; ++i) {
    const Region region = random_region(random, i);
    PatternSettings settings = tool(14.0 + 14.0 * share(random), 1.0, i % 3 == 0 ? Milling::up : Milling::down);
    settings.step_over = settings.tool_radius * std::lerp(0.5, largest_step, share(random));
    settings.face = face;
    const double angle = 2.0 * std::numbers::pi * share(random);
    for (const PatternKind kind : kAllPatterns) {
      SCOPED_TRACE("region " + std::to_string(i) + ", " + pattern_name(kind, angle));
      check(region, kind, angle, settings, make_pattern(region, kind, angle, settings), random);
    }
  }
}

}  // namespace stillcut::test
