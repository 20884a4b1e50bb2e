// Random machining cells for a campaign in closed loop: tool, structure, material, spindle and controller are drawn
// from a seed, the depth is chosen by the stability lobes so that the cut is what its class says. A cell is a plain
// value: the same class, seed and index give the same cell to the bit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "drivers/files/scenario.hpp"
#include "models/dynamics_map.hpp"
#include "models/lobe_diagram.hpp"
#include "models/machining.hpp"

namespace stillcut::campaign {

// pocket: chatters at the programmed speed, and another speed, which the chatter's frequency points to, is stable;
// none: chatters at every speed of the spindle; stable: does not chatter at the programmed speed, through entries,
// exits and steps of depth.
enum class CellClass : std::uint8_t { pocket, none, stable };
std::string_view name(CellClass kind);

// How far the map that the monitor knows is from the machine: each number is drawn within this share of the full
// errors, 1 % of frequency, 10 % of stiffness, 20 % of damping; 0: the map is exact.
struct MapError {
  double share = 0.0;
};

struct RandomCell {
  CellClass kind = CellClass::pocket;
  Tool tool;
  Material material;
  Cut cut;  // as programmed; its axial depth is the deepest
  SpindleLimits spindle;
  std::vector<Mode> modes, map_modes;  // of the machine, and as the monitor knows them
  ControllerScript controller;
  double free_turn =
      0.0;  // rad, that the path leaves the feed direction to both sides; 0: none, as in half of the cells
  Schedule axial_depth;
  double duration = 0.0;                      // s
  double deeper_from = 0.0, deep_from = 0.0;  // s: the sound depth is left, the deepest reached
  std::uint64_t seed = 1;                     // of the noise

  // By the lobes of the machine.
  double depth_limit = 0.0;    // m, at the programmed speed
  double chatter_hz = 0.0;     // there
  double pocket_speed = 0.0;   // rad/s, the best that the chatter's frequency points to; 0: none
  double pocket_margin = 0.0;  // worst within 2 % of it
};

// Throws std::runtime_error where no cell of the class can be found (thousands of draws).
RandomCell random_cell(CellClass kind, std::uint64_t seed, std::uint64_t index, double duration, MapError error = {});

// Smallest depth limit within a relative distance of a speed, m; 0 where every depth is unstable.
double worst_limit(const LobeDiagram& diagram, double speed, double within);

// Writes cell.toml (what the monitor knows), machine.toml (what is milled with; the same but for its map),
// scenario.toml, maps and cell.dbc, for the campaign and for `stillcut hil` by hand.
void write_cell(const RandomCell& cell, const std::filesystem::path& folder);

}  // namespace stillcut::campaign
