// The dynamics map: modes measured at postures, and the modes predicted between them by inverse distance weighting
// (surface paper, eqs 16-18; docs/stability.md).
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace stillcut {

// One mode of the structure at the tool point: receptance u u^T / (k (1 - (w/wn)^2 + 2 i zeta w/wn)).
struct Mode {
  double natural_frequency = 0.0;  // rad/s
  double damping_ratio = 0.0;
  double stiffness = 0.0;                    // N/m
  std::array<double, 3> direction{1, 0, 0};  // unit vector, workpiece axes
};

// Into rising frequency.
inline void sort_modes(std::vector<Mode>& modes) {
  std::stable_sort(modes.begin(), modes.end(),
                   [](const Mode& a, const Mode& b) { return a.natural_frequency < b.natural_frequency; });
}

struct Posture {
  std::string id;
  std::array<double, 6> joints{};    // rad; meaningless where the map has no joints
  std::array<double, 3> position{};  // m, workpiece frame
  std::vector<Mode> modes;           // rising frequency
};

struct DynamicsMap {
  bool has_joints = false;
  std::vector<Posture> postures;
};

}  // namespace stillcut
