// A scenario: one TOML file that tells a simulated machine what to cut and what goes wrong meanwhile (docs/scenarios.md
// lists the keys). It names its cell, scripts depths, speed, feed direction and postures over time, and the faults of
// sensors, bus and controller. Reading it checks every key, and that the parts do not contradict one another or the
// cell: InputErrors with file, line and key.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "drivers/files/cell.hpp"
#include "models/schedule.hpp"

namespace stillcut {

// From start to end, s since the scenario's beginning.
struct TimeSpan {
  double start = 0.0, end = 0.0;

  [[nodiscard]] bool contains(double time) const noexcept { return time >= start && time < end; }
};

struct PostureMove {
  TimeSpan span;
  std::string to;  // a posture's id
};

// The tool leaves the part and comes back, again and again.
struct InterruptedCut {
  TimeSpan span;
  double in_cut = 0.0, in_air = 0.0;  // s, in turn
};

struct Knock {
  double time = 0.0;
  std::array<double, 3> impulse{};  // N s, workpiece axes
};

// A force from outside at the tool point: another machine, an unbalanced fan.
struct OutsideForce {
  TimeSpan span;
  double frequency_hz = 0.0;
  std::array<double, 3> force{};  // N, amplitude, workpiece axes
};

// stuck: repeats its last sample; saturated: stands at the end of its range; offset: adds; nan: no number; dead: reads
// zero; silent: the sensor sends no frames at all.
enum class SensorFaultKind { stuck, saturated, offset, nan, dead, silent };

struct SensorFault {
  TimeSpan span;
  SensorFaultKind kind = SensorFaultKind::stuck;
  int axis = -1;        // 0 x, 1 y, 2 z; -1: all
  double offset = 0.0;  // m/s^2
  int line = 0;
};

struct FrameLoss {
  TimeSpan span;
  double rate = 0.0;  // share of the sensors' frames
};

// silent: neither sends nor hears; refuses: answers "no"; mute: obeys, but never answers.
enum class ControllerFaultKind { silent, refuses, mute };

struct ControllerFault {
  TimeSpan span;
  ControllerFaultKind kind = ControllerFaultKind::silent;
};

struct ControllerScript {
  double cycle = 0.008;                 // s
  double lag = 0.015;                   // s, from hearing a correction to acting on it
  double spindle_time_constant = 0.3;   // s, first order
  double spindle_acceleration = 0.0;    // rad/s^2, the most that the drive gives; 0: the cell's
  double turn_rate = deg_to_rad(60.0);  // rad/s, of the feed direction where a correction turns it
  std::vector<CorrectionKind> accepts{CorrectionKind::spindle_speed, CorrectionKind::speed_variation,
                                      CorrectionKind::feed_direction, CorrectionKind::feed_override,
                                      CorrectionKind::stop_request};
  std::vector<ControllerFault> faults;  // in time
};

struct Scenario {
  std::filesystem::path file;
  std::filesystem::path cell;  // absolute
  std::string title;
  double duration = 0.0;  // s
  std::uint64_t seed = 1;
  double sensor_noise = 0.2;    // m/s^2 rms
  double force_noise = 0.02;    // rms, relative
  std::optional<bool> chatter;  // what the physics is expected to do without corrections

  std::optional<Milling> milling;  // empty, as the schedules: the cell's
  Schedule axial_depth;            // m
  Schedule radial_depth;           // m
  Schedule spindle_speed;          // rad/s, as programmed
  Schedule feed_direction;         // rad
  std::string posture;             // at the start; empty: the cell's
  std::vector<PostureMove> moves;  // in time, one at once
  std::vector<InterruptedCut> interrupted;
  std::vector<Knock> knocks;
  std::vector<OutsideForce> forces;
  std::vector<SensorFault> sensor_faults;
  std::vector<FrameLoss> losses;
  ControllerScript controller;
};

// Reads a scenario for `cell`, or for the cell that it names. Throws InputError.
Scenario read_scenario(const std::filesystem::path& file, const Cell& cell);
Scenario read_scenario(const std::filesystem::path& file);

}  // namespace stillcut
