// Recordings of taps for the tests of their files, and WAV files byte by byte.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "models/tap_hits.hpp"

namespace stillcut {

inline TapRecording random_taps(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  TapRecording recording;
  recording.sample_rate_hz = std::vector{1000.0, 4096.0, 25600.0, 51200.0, 48000.0}[random() % 5];
  const std::size_t samples = 2 + random() % 300;
  const auto channel = [&] {
    std::vector<double> values(samples);
    for (double& value : values) value = 100.0 * normal(random);
    return values;
  };
  recording.force = channel();
  for (std::vector<double>& axis : recording.acceleration)
    if (random() % 2 == 0) axis = channel();
  if (recording.acceleration[1].empty()) recording.acceleration[1] = channel();
  return recording;
}

// Of the published format (Microsoft and IBM, "Multimedia Programming Interface and Data Specifications 1.0", 1991):
// samples interleaved, -1 to 1.
class WavBytes {
 public:
  enum class Form : std::uint16_t { pcm16 = 1, float32 = 3 };

  static std::string of(Form form, std::uint32_t rate, std::uint16_t channels, const std::vector<float>& samples) {
    const std::uint16_t size = form == Form::pcm16 ? 2 : 4;
    WavBytes data, file;
    for (const float sample : samples) {
      if (form == Form::pcm16)
        data.put(static_cast<std::uint16_t>(std::lround(std::min(32767.0F, 32768.0F * sample))), 2);
      else
        data.put(std::bit_cast<std::uint32_t>(sample), 4);
    }
    file.bytes_ += "WAVEfmt ";
    file.put(16, 4);
    file.put(static_cast<std::uint16_t>(form), 2);
    file.put(channels, 2);
    file.put(rate, 4);
    file.put(rate * channels * size, 4);
    file.put(channels * size, 2);
    file.put(8U * size, 2);
    file.bytes_ += "data";
    file.put(data.bytes_.size(), 4);
    file.bytes_ += data.bytes_;
    WavBytes head;
    head.bytes_ = "RIFF";
    head.put(file.bytes_.size(), 4);
    return head.bytes_ + file.bytes_;
  }

 private:
  void put(std::uint64_t value, int size) {
    for (int i = 0; i < size; ++i) bytes_ += static_cast<char>(value >> (8 * i) & 0xFF);
  }
  std::string bytes_;
};

}  // namespace stillcut
