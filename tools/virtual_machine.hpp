// The simulated machine: milling, structure, spindle, controller, sensors and their faults, as a scenario scripts them.
// A function of the corrections it is given: time advances one sample at a time and no clock is asked, so that a run in
// data time repeats to the bit; real time paces the same code (tools/plant).
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "drivers/files/cell.hpp"
#include "drivers/files/scenario.hpp"
#include "models/chatter_truth.hpp"
#include "models/interpolation.hpp"
#include "models/milling_simulation.hpp"
#include "tools/can_encoder.hpp"
#include "tools/cell_posture.hpp"
#include "tools/surface_recorder.hpp"
#include "tools/virtual_controller.hpp"

namespace stillcut {

// What the machine sends in one sample of time; valid until the next advance.
struct MachineOutput {
  std::span<const CanFrame> frames;
  std::span<const ControllerMessage> messages;
};

// The machine at one moment, once a millisecond, for pictures and scores.
struct MachineMoment {
  double time = 0.0, axial_depth = 0.0;                // s, m
  double spindle_speed = 0.0, programmed_speed = 0.0;  // rad/s
  double feed_rate = 0.0, feed_direction = 0.0;        // m/s, rad, as they are
  double removal_rate = 0.0;                           // m^3/s
  double displacement = 0.0;                           // m, largest of the millisecond
};

class VirtualMachine {
 public:
  // Frames and messages are stamped from `origin_ns` on. Throws InputError for a cell that lacks a section or a
  // scenario that the cell cannot play.
  VirtualMachine(const Cell& cell, const Scenario& scenario, std::int64_t origin_ns);

  // One sample on; throws std::runtime_error, see MillingSimulation.
  MachineOutput advance();
  void receive(const Correction& correction) { controller_.receive(correction, time()); }

  [[nodiscard]] double time() const { return milling_.state().time; }   // s
  [[nodiscard]] double duration() const { return scenario_.duration; }  // s
  [[nodiscard]] bool ended() const { return time() >= scenario_.duration; }
  [[nodiscard]] const MillingState& state() const { return milling_.state(); }
  [[nodiscard]] const VirtualController& controller() const { return controller_; }
  [[nodiscard]] std::int64_t origin_ns() const { return origin_ns_; }

  // What happened so far.
  [[nodiscard]] const ChatterTruth& truth() const { return truth_; }
  [[nodiscard]] const std::vector<MachineMoment>& moments() const { return moments_; }
  [[nodiscard]] const std::vector<float>& vibration() const { return vibration_; }  // m/s^2, x, one a sample
  [[nodiscard]] double sample_rate_hz() const { return sample_rate_hz_; }
  [[nodiscard]] double peak_displacement() const { return peak_displacement_; }  // m
  [[nodiscard]] const SurfaceRecorder& surface() const { return surface_; }
  [[nodiscard]] double removed_volume() const { return removed_; }     // m^3
  [[nodiscard]] double cutting_time() const { return cutting_time_; }  // s with the tool in the part
  [[nodiscard]] std::int64_t frames_sent() const { return frames_sent_; }
  [[nodiscard]] std::int64_t frames_lost() const { return frames_lost_; }

  // What the program commands at a time.
  [[nodiscard]] RobotState program_at(double time) const;

 private:
  [[nodiscard]] MillingConditions conditions_at(double time, const RobotState& program) const;
  [[nodiscard]] Posture posture_at(double time) const;
  [[nodiscard]] bool strike(double time);
  [[nodiscard]] bool changes_abruptly(const MillingConditions& next) const;
  void move_structure(double time);
  void set_sensor_faults(double time);
  void record(const RobotState& program, bool disturbed);
  void count_removed(MachineMoment& moment);

  Scenario scenario_;
  Tool tool_;
  Cut cut_;                        // the cell's, with the scenario's milling kind
  CellDynamics dynamics_;          // interpolated by modes: superposed ones (frf) would change their number on the way
  std::vector<Posture> stations_;  // at the start, and after each move
  std::int64_t origin_ns_;
  double sample_rate_hz_;
  std::vector<Mode> modes_;  // of the structure now
  MillingSimulation milling_;
  CanEncoder encoder_;
  VirtualController controller_;
  double program_time_ = 0.0;  // s; stands still where a stop request holds the program
  double next_posture_s_ = 0.0;
  std::size_t next_knock_ = 0;
  std::mt19937_64 random_;

  std::vector<CanFrame> frames_;
  std::int64_t samples_ = 0, frames_sent_ = 0, frames_lost_ = 0;
  double peak_displacement_ = 0.0;             // m
  double removed_ = 0.0, cutting_time_ = 0.0;  // m^3, s
  SurfaceRecorder surface_;
  ChatterTruth truth_;
  std::vector<MachineMoment> moments_;
  std::vector<float> vibration_;
};

}  // namespace stillcut
