// A machine's sensors as the CAN bus sees them: accelerometers that sample, quantize and saturate, a drive that reports
// its speed, in the frames that the cell's DBC file lays out. The decoder's counterpart, for simulated cuts.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "drivers/can/decode_plan.hpp"
#include "drivers/files/scenario.hpp"
#include "rt/can_frame.hpp"

namespace stillcut {

struct SensorNoise {
  double rms = 0.0;  // m/s^2, white, on every axis
  std::uint64_t seed = 1;
};

// What is wrong with the sensors just now.
struct SensorFaults {
  std::array<std::optional<SensorFault>, kMaxAxes> axis;  // of every accelerometer, its own axes
  bool silent = false;                                    // they send nothing
};

class CanEncoder {
 public:
  // The machine starts at rest at time 0, stamped `origin_ns`. Throws InputError, see compile_decode_plan.
  CanEncoder(const Dbc& dbc, const CanSettings& can, const std::string& cell_file, SensorNoise noise,
             std::int64_t origin_ns);

  // Where the motion has got to at a later time (s): velocity of the tool point in the tool frame (m/s) and spindle
  // speed (rad/s), straight lines in between. Returns the frames that fell due, in the order of their stamps; valid
  // until the next call. A frame's stamp is the time of its last sample.
  //
  // A sample is the mean acceleration over its sample interval, the change of velocity by its length: like a real
  // sensor's filter this keeps what is far above the sample rate out of the signal.
  std::span<const CanFrame> advance(double time, const Eigen::Vector3d& velocity, double spindle_speed);

  // From now on.
  void set_faults(const SensorFaults& faults) { faults_ = faults; }

  // Whether all samples are floating-point numbers, so that a sensor could send "not a number".
  [[nodiscard]] bool can_send_nan() const;
  // Whether a frame is a sensor's and not the spindle's.
  [[nodiscard]] bool is_sensor_frame(const CanFrame& frame) const;

  // Samples that stood at the end of the sensor's range.
  [[nodiscard]] std::int64_t saturated() const { return saturated_; }

 private:
  struct Sensor {
    SensorPlan plan;
    std::size_t message = 0;  // index of the frame it fills
    double sample_rate_hz = 0.0;
    std::int64_t samples = 0;                            // taken so far
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // at the last sample
    std::uint64_t counter = 0;
    std::array<double, kMaxAxes> last{};  // what it sent, in its unit
  };

  std::size_t frame_of(const Dbc& dbc, std::uint32_t id);
  void sample(Sensor& sensor, const Eigen::Vector3d& velocity);
  void send(std::size_t message, double time);
  void put(CanFrame& frame, const SignalPlan& signal, double value);

  DecodePlan plan_;
  std::vector<Sensor> sensors_;
  std::vector<CanFrame> frames_;  // one a message, filled and sent again and again
  std::size_t spindle_frame_ = 0;
  double spindle_period_ = 0.0;  // s
  std::int64_t spindle_sent_ = 0;
  std::vector<CanFrame> due_;

  SensorFaults faults_;
  SensorNoise noise_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::int64_t origin_ns_;
  std::int64_t saturated_ = 0;
  double time_ = 0.0;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  double speed_ = 0.0;
  bool started_ = false;
};

}  // namespace stillcut
