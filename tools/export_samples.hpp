// What `stillcut export` writes of the samples: CSV for spreadsheets and scripts, WAV to hear the cut, universal files
// (UFF 58) for modal analysis. Each is given stretch after stretch and keeps time: missing samples are empty or
// silence.
#pragma once

#include <array>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "drivers/files/wav_writer.hpp"
#include "tools/sample_window.hpp"

namespace stillcut {

// time_s,sensor,x_m_per_s2,y_m_per_s2,z_m_per_s2,spindle_speed_rpm; sensors count from 1, what is missing, not measured
// or no number is empty. Nothing is held.
class SampleCsv {
 public:
  explicit SampleCsv(std::ostream& out);
  void add(const SampleStretch& stretch, double spindle_speed_rpm);  // NaN: not known

 private:
  std::ostream& out_;
  std::string row_;
};

// One sensor, its measured axes as channels. The scale is found when all has been written; nothing is held.
class SampleWav {
 public:
  // Throws InputError where the file cannot be written.
  SampleWav(const std::string& file, const AccelerometerSettings& sensor);
  void add(const SampleStretch& stretch);
  // `full_scale` (m/s²) becomes the loudest that a WAV file holds; 0: the loudest sample. Gives what it was.
  double finish(double full_scale);

  [[nodiscard]] int sample_rate_hz() const { return sample_rate_hz_; }  // a whole number, as the format asks

 private:
  std::array<bool, kMaxAxes> measured_{};
  std::vector<int> axes_;  // those measured, in the order of the channels
  int sample_rate_hz_;
  double begin_s_ = 0.0;
  bool begun_ = false;
  WavWriter wav_;
  std::vector<float> frames_;
};

inline constexpr std::int64_t kMostUffSamples = 10'000'000;  // of an axis; what the file's readers hold as well

// Time histories (function type 1) in binary (58b), one a measured axis, all sensors, the sensor's number the node.
// They are held: 12 bytes a sample, and 32 for the axis that is being written.
class SampleUff {
 public:
  explicit SampleUff(std::span<const AccelerometerSettings> sensors);
  // Throws std::length_error, in words for the user, for more than kMostUffSamples.
  void add(const SampleStretch& stretch);
  void write(std::ostream& out) const;

 private:
  struct Sensor {
    double sample_rate_hz = 0.0, begin_s = 0.0;
    std::int64_t missing = 0;
    std::array<std::vector<float>, kMaxAxes> axis;
  };
  std::vector<Sensor> sensors_;
};

}  // namespace stillcut
