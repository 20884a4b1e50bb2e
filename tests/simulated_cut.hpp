// The demo cell's cut as the sensors would send it: air, entry, sound, deeper until it chatters, exit. For tests and
// benchmarks that need a whole chain's input without a file.
#pragma once

#include <algorithm>
#include <vector>

#include "drivers/can/dbc.hpp"
#include "drivers/files/cell.hpp"
#include "drivers/files/dynamics_map_file.hpp"
#include "models/cut_schedule.hpp"
#include "models/posture.hpp"
#include "tools/can_encoder.hpp"

namespace stillcut {

inline Cell demo_cell() { return read_cell(EXAMPLES "/demo-cell/cell.toml", {.bus = false}); }

inline std::vector<CanFrame> simulate_cut(const Cell& cell, const Schedule& axial_depth, double duration_s,
                                          std::uint64_t seed = 1) {
  MillingSetup setup;
  setup.tool = *cell.tool;
  setup.material = *cell.material;
  setup.cut = *cell.cut;
  setup.modes = find_posture(read_dynamics_map(cell.dynamics->map), cell.dynamics->posture).modes;
  setup.force_noise = 0.02;
  setup.seed = seed;
  const double rate_hz = std::max(lowest_sample_rate_hz(setup.modes), cell.can->accelerometers.front().sample_rate_hz);
  const CutSchedule schedule{axial_depth, {}};
  setup = scheduled(setup, schedule);
  MillingSimulation milling{setup, rate_hz};
  CanEncoder encoder{read_dbc(cell.can->dbc), *cell.can, cell.file.string(), {0.2, seed}, 1'500'000'000'000'000'000};
  std::vector<CanFrame> frames;
  for (int i = 0; i < static_cast<int>(duration_s * rate_hz); ++i) {
    const MillingState& state = milling.advance(conditions_at(setup, schedule, (i + 1) / rate_hz));
    const auto due = encoder.advance(state.time, state.velocity, state.spindle_speed);
    frames.insert(frames.end(), due.begin(), due.end());
  }
  return frames;
}

// Chatters from 2.7 s on at 757 Hz: the depth limit of the demo cell at its speed is 2.96 mm.
inline const Schedule kDemoDepth = {{0.0, 0.0},    {0.7, 0.0},    {0.8, 1.5e-3}, {2.0, 1.5e-3},
                                    {3.0, 3.6e-3}, {5.3, 3.6e-3}, {5.4, 0.0}};

}  // namespace stillcut
