// What a measured dynamics map still lacks: where the next tap test would help most, and what its makers should know
// before they trust it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "models/leave_one_out.hpp"
#include "models/mode_tracking.hpp"

namespace stillcut {

struct NextTap {
  Posture place;                       // joints (rad) where the map has them, otherwise position (m); no modes, no id
  std::array<std::string, 2> between;  // of a map with joints: the place is half way between these postures
  std::string nearest;                 // measured posture
  double nearest_distance = 0.0;       // rad or m
  double half_widths = 0.0;            // expected error of the map there; unit as of MethodErrors::score
};

// The candidate at which the map is expected to be most in error. How fast errors grow follows from leaving out: of
// each posture the error of the best way, as MethodErrors::score has it, over the distance to its nearest neighbour. At
// a place x these rates r_i, weighed by 1/d_i(x)^2, times the distance to the nearest posture give the expected error.
// Candidates: with joints, half the way (each joint the shorter way round) between any two postures, since nothing else
// is known to be in reach; without, nine places along every axis of the box that the postures fill. Nothing for a map
// of fewer than two postures; `report` is of this map.
std::optional<NextTap> next_tap(const DynamicsMap& map, const LeaveOneOut& report);

// Whole sentences: too few postures, postures beyond what the others span, predictions no better than the mean or off
// by more than a resonance is wide, modes that few postures have. `report`: nothing where the map has one posture.
std::vector<std::string> map_doubts(const DynamicsMap& map, const ModeTracks& tracks,
                                    const std::optional<LeaveOneOut>& report);

}  // namespace stillcut
