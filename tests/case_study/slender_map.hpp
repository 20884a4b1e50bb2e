// The paper's other tool, 16 mm wide and 160 mm long, at thirty positions: reconstructed dynamics for its figures 4
// to 6. Six numbers, set by hand so that what can be had of the figures comes out; no measurement.
//
// With s from 0 to 1 along X (five columns) and t from 0 to 1 along Y to position 21 (five of six rows), modes along X
// and along Y:
//   tool       k_y, k_x = k_y z_y / (z_x R), R = 2 (3/2)^t e^(-h s) = |G_xx|/|G_yy| at the peaks,
//              f_x = 500/sqrt(q), f_y = 500 sqrt(q) Hz, damping z_x, z_y
//   structure  f_1 = 50 + 10 s, f_2 = 120 + 8 t Hz (the ranges printed), damping 0.04, stiffness 8 k_y both
#pragma once

#include <span>
#include <vector>

#include "models/dynamics_map.hpp"

namespace stillcut::case_study {

struct SlenderParameters {
  double k_y = 6.8e6;         // N/m: 0.6 mm at position 1
  double q = 0.955, h = 1.1;  // h: the least peak of G_f at position 25
  double z_x = 0.025, z_y = 0.02;
  double structure = 8.0;  // its stiffness over k_y
};

// Positions 1 to 30, row by row along X, over 300 x 300 mm; without joints.
DynamicsMap slender_map(const SlenderParameters& parameters = {});

// The largest |G_xx| over the largest |G_yy| where the tool's modes are.
double peak_ratio(std::span<const Mode> modes);

// The feed direction from 0 to 90 degrees, to 5, at which the largest |G_f| there is least, by the paper's projection.
double least_peak_deg(std::span<const Mode> modes);

}  // namespace stillcut::case_study
