// The machine behind a simulated controller: a tool that mills lane beside lane, back and forth, at the programmed feed
// times its override, and a spindle that follows its setpoint with a lag.
#pragma once

#include <array>
#include <cstdint>

namespace stillcut {

struct SimulatedProgramSettings {
  double feed_m_per_s = 0.025;
  double spindle_speed_rpm = 8500.0;
  double lane_length = 0.2, lane_distance = 0.01;  // m
  double spindle_time_constant_s = 0.1;
};

// What the controller was asked for; as it stands here: nothing beside the program.
struct MachineInputs {
  double spindle_change_rpm = 0.0;
  double feed_override = 1.0;
  double path_offset = 0.0;  // m, to the left of the feed
  bool stop = false;
};

class SimulatedProgram {
 public:
  explicit SimulatedProgram(const SimulatedProgramSettings& settings)
      : settings_{settings}, spindle_rpm_{settings.spindle_speed_rpm} {}

  void step(double seconds, const MachineInputs& inputs);

  [[nodiscard]] const SimulatedProgramSettings& settings() const { return settings_; }
  [[nodiscard]] std::array<double, 3> position() const;
  [[nodiscard]] double spindle_speed_rpm() const { return spindle_rpm_; }  // actual
  [[nodiscard]] std::int32_t block() const { return lane_ + 1; }
  [[nodiscard]] bool stopped() const { return stopped_; }  // until a person starts it again
  void start_again() { stopped_ = false; }

 private:
  SimulatedProgramSettings settings_;
  double spindle_rpm_, along_ = 0.0, aside_ = 0.0;  // m within the lane
  std::int32_t lane_ = 0;
  bool stopped_ = false;
};

}  // namespace stillcut
