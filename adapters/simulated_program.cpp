#include "adapters/simulated_program.hpp"

#include <cmath>

namespace stillcut {

void SimulatedProgram::step(double seconds, const MachineInputs& inputs) {
  stopped_ = stopped_ || inputs.stop;
  const double wanted = settings_.spindle_speed_rpm + inputs.spindle_change_rpm;
  spindle_rpm_ += (wanted - spindle_rpm_) * -std::expm1(-seconds / settings_.spindle_time_constant_s);
  aside_ = inputs.path_offset;
  if (stopped_) return;
  along_ += settings_.feed_m_per_s * inputs.feed_override * seconds;
  while (along_ >= settings_.lane_length) {
    along_ -= settings_.lane_length;
    ++lane_;
  }
}

std::array<double, 3> SimulatedProgram::position() const {
  const bool there = lane_ % 2 == 0;  // and back in the next lane
  return {there ? along_ : settings_.lane_length - along_, lane_ * settings_.lane_distance + (there ? aside_ : -aside_),
          0.0};
}

}  // namespace stillcut
