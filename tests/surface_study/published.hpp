// What Liu et al. 2024 print of their cuts and surfaces: figures only.
#pragma once

#include <array>

#include "models/machining.hpp"

namespace stillcut::surface_study {

struct PublishedCase {
  double spindle_speed_rpm, feed_mm_per_min, axial_depth_mm, step_over_mm, tilt_deg, lead_deg, redundancy_deg;
};
// Table 2, cases 1 to 9.
inline constexpr std::array<PublishedCase, 9> kCases{{{3000, 300, 0.2, 0.1, 5, 10, -40},
                                                      {3000, 300, 0.5, 0.1, 5, 10, -30},
                                                      {3000, 300, 0.8, 0.1, 5, 10, -20},
                                                      {6000, 300, 0.2, 0.1, 5, 10, -10},
                                                      {6000, 300, 0.5, 0.1, 5, 10, 0},
                                                      {6000, 300, 0.8, 0.1, 5, 10, 10},
                                                      {7000, 300, 0.2, 0.1, 5, 10, 20},
                                                      {7000, 300, 0.5, 0.1, 5, 10, 30},
                                                      {7000, 300, 0.8, 0.1, 5, 10, 40}}};

// Table 3, um: areas of 2 x 2 mm; the paper's own simulation beside what was measured.
struct PublishedArea {
  char name;
  int of_case;
  double ra_measured, ra_simulated, rq_measured, rq_simulated;
};
inline constexpr std::size_t kAreas = 6;
inline constexpr std::array<PublishedArea, kAreas> kPublished{{{'A', 5, 0.908, 0.878, 1.132, 1.103},
                                                               {'B', 5, 1.064, 0.976, 1.371, 1.407},
                                                               {'C', 5, 1.055, 0.914, 1.485, 1.357},
                                                               {'D', 7, 0.813, 0.835, 1.081, 1.187},
                                                               {'E', 7, 1.125, 1.066, 1.418, 1.527},
                                                               {'F', 7, 0.999, 0.938, 1.369, 1.465}}};

// Table 1 and section 3.2: the tool and the material.
inline Tool paper_tool() {
  return {.shape = ToolShape::ball,
          .diameter = 8e-3,
          .teeth = 2,
          .pitch = {0.5 * kTwoPi, 0.5 * kTwoPi},
          .helix = deg_to_rad(45),
          .runout = 20e-6,
          .axial_runout = 5e-6};
}

inline Material paper_material() {
  return {
      .name = "AL7075-T6", .ktc = 1661.8e6, .krc = 1240.8e6, .kac = 19.1e6, .kte = 7.1e3, .kre = 15.9e3, .kae = 2.3e3};
}

// Which side the stock was on is not printed: down-milling.
inline Cut cut_of_case(int number) {
  const PublishedCase& c = kCases.at(static_cast<std::size_t>(number) - 1);
  const double turns_per_min = c.spindle_speed_rpm;
  return {.milling = Milling::down,
          .radial_depth = 1e-3 * c.step_over_mm,
          .axial_depth = 1e-3 * c.axial_depth_mm,
          .feed_per_tooth = 1e-3 * c.feed_mm_per_min / (turns_per_min * 2.0),
          .spindle_speed = rpm_to_rad_s(c.spindle_speed_rpm),
          .tilt = deg_to_rad(c.tilt_deg),
          .lead = deg_to_rad(c.lead_deg),
          .redundancy = deg_to_rad(c.redundancy_deg)};
}

}  // namespace stillcut::surface_study
