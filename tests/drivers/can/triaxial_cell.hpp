// The [can] section that goes with tests/data/triaxial.dbc, for tests.
#pragma once

#include "drivers/files/cell.hpp"

namespace stillcut {

inline CanSettings triaxial_cell() {
  AccelerometerSettings accelerometer;
  accelerometer.sample_rate_hz = 25'600.0;
  accelerometer.axis = {"Vibration.X{0..9}", "Vibration.Y{0..9}", "Vibration.Z{0..9}"};
  accelerometer.counter = "Vibration.Counter";
  accelerometer.line = 40;
  CanSettings can;
  can.accelerometers = {accelerometer};
  can.spindle_speed = "Spindle.Speed";
  can.line = 37;
  return can;
}

}  // namespace stillcut
