// Writes WAV files of 32-bit floating-point samples, so that a vibration can be heard and any sound editor opens it.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace stillcut {

class WavWriter {
 public:
  // Makes the file, or makes it anew. From 4 GiB on it becomes RF64, the long WAV. Throws InputError.
  WavWriter(std::filesystem::path file, int channels, int sample_rate_hz);
  ~WavWriter();
  WavWriter(const WavWriter&) = delete;
  WavWriter& operator=(const WavWriter&) = delete;

  // Interleaved samples, as many as there are channels or a multiple, finite, in any unit; they go to the file as they
  // are. Throws InputError when that fails.
  void write(std::span<const float> samples);

  [[nodiscard]] float largest() const { return largest_; }  // of the values so far, without sign

  // Goes through the file once more and divides all by `full_scale` (above 0), so that this value is 1, what a sound
  // card can give at most; `comment` stands in the file for the reader. Throws InputError.
  void finish(float full_scale, const std::string& comment);

 private:
  [[noreturn]] void fail() const;

  struct Close {
    void operator()(void* sound) const;
  };
  std::filesystem::path file_;
  int channels_;
  float largest_ = 0.0F;
  std::unique_ptr<void, Close> sound_;  // SNDFILE
};

}  // namespace stillcut
