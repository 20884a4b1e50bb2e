#include "tools/simulated_taps.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>

#include "drivers/can/candump_log.hpp"
#include "drivers/can/dbc.hpp"
#include "models/machining.hpp"
#include "models/modal_structure.hpp"
#include "tools/can_encoder.hpp"
#include "tools/cell_posture.hpp"
#include "tools/tap_listener.hpp"

namespace stillcut {
namespace {

constexpr double kSteps = 8.0;  // of the simulation, a sample
constexpr double kReboundAfter_s = 0.03;

double pulse(double time, double peak, double duration) {
  if (time <= 0.0 || time >= duration) return 0.0;
  const double sine = std::sin(0.5 * kTwoPi * time / duration);
  return peak * sine * sine;
}

// What it is given as velocity is the impulse, N s.
CanSettings hammer_alone(const CanSettings& can) {
  CanSettings alone = can;
  alone.accelerometers = {hammer_as_sensor(*can.hammer)};
  alone.spindle_speed.clear();
  return alone;
}

}  // namespace

void simulate_taps(const Cell& cell, std::span<const Mode> modes, std::span<const SimulatedTap> taps,
                   const SimulatedTapping& tapping, const std::function<void(const CanFrame&)>& send) {
  const CanSettings& can = require(cell, cell.can, "can");
  require_hammer(cell);
  const Dbc dbc = read_dbc(can.dbc);
  CanEncoder sensors(dbc, can, cell.file.string(), {tapping.acceleration_noise_m_per_s2, tapping.seed},
                     tapping.origin_ns);
  CanEncoder hammer(dbc, hammer_alone(can), cell.file.string(), {tapping.force_noise_n, tapping.seed + 1},
                    tapping.origin_ns);
  const double step = 1.0 / (kSteps * can.hammer->sample_rate_hz);
  const double seconds = tapping.spacing_s * static_cast<double>(taps.size());
  const auto steps = static_cast<std::int64_t>(std::ceil(seconds / step));
  ModalStructure structure(modes, step);
  Eigen::Vector3d begin = Eigen::Vector3d::Zero(), end = begin;
  double impulse = 0.0, pressed = 0.0;  // N s; N
  for (std::int64_t n = 1; n <= steps; ++n) {
    const double time = static_cast<double>(n) * step;
    const auto at = std::min(static_cast<std::size_t>(time / tapping.spacing_s), taps.size() - 1);
    const SimulatedTap& tap = taps[at];
    const double since = time - (static_cast<double>(at) + 0.5) * tapping.spacing_s;
    const double force =
        pulse(since, tap.peak_n, tap.duration_s) + pulse(since - kReboundAfter_s, tap.rebound_n, tap.duration_s);
    end = Eigen::Vector3d::Zero();
    end[tap.hammer.axis] = tap.hammer.sense * force;
    structure.advance(begin, end);
    begin = end;
    impulse += 0.5 * step * (pressed + force);
    pressed = force;
    for (const CanFrame& frame : sensors.advance(time, structure.velocity(), 0.0)) send(frame);
    for (const CanFrame& frame : hammer.advance(time, {impulse, 0.0, 0.0}, 0.0)) {
      if (sensors.is_sensor_frame(frame))
        throw InputError(cell.file.string(), can.hammer->line,
                         "can.hammer.force_n: is in the accelerometer's message, which cannot be simulated");
      send(frame);
    }
  }
}

std::int64_t write_simulated_taps(const Cell& cell, std::span<const std::string> postures,
                                  std::span<const SimulatedTap> taps, SimulatedTapping tapping, std::ostream& out,
                                  const std::function<void(double)>& progress) {
  const CellDynamics dynamics = read_cell_dynamics(cell);
  const double seconds = tapping.spacing_s * static_cast<double>(taps.size());
  const std::int64_t first_ns = tapping.origin_ns;
  std::int64_t frames = 0;
  for (const std::string& posture : postures) {
    const std::vector<Mode> modes = predicted_posture(cell, dynamics, posture).posture.modes;
    std::array<char, kMaxCandumpLine> line{};
    simulate_taps(cell, modes, taps, tapping, [&](const CanFrame& frame) {
      out.write(line.data(), static_cast<std::streamsize>(format_candump_line(frame, "can0", line)));
      if ((++frames & 0x3FF) == 0)
        progress(1e-9 * static_cast<double>(frame.stamp_ns - first_ns) /
                 (seconds * static_cast<double>(postures.size())));
    });
    tapping.origin_ns += static_cast<std::int64_t>(1e9 * seconds);
    ++tapping.seed;
  }
  return frames;
}

}  // namespace stillcut
