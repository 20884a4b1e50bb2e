#include "drivers/files/wav_writer.hpp"

#include <sndfile.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

constexpr std::size_t kFramesAtOnce = 16384;

SNDFILE* sound_file(void* sound) { return static_cast<SNDFILE*>(sound); }

}  // namespace

void WavWriter::Close::operator()(void* sound) const { sf_close(sound_file(sound)); }

WavWriter::WavWriter(std::filesystem::path file, int channels, int sample_rate_hz)
    : file_{std::move(file)}, channels_{channels} {
  std::error_code none_there;
  if (std::filesystem::is_regular_file(file_, none_there)) std::filesystem::remove(file_, none_there);
  SF_INFO info{};
  info.samplerate = sample_rate_hz;
  info.channels = channels;
  info.format = SF_FORMAT_RF64 | SF_FORMAT_FLOAT;
  sound_.reset(sf_open(file_.c_str(), SFM_RDWR, &info));
  if (!sound_) throw InputError(file_.string(), 0, "cannot be written; check the folder and its rights");
  (void)sf_command(sound_file(sound_.get()), SFC_RF64_AUTO_DOWNGRADE, nullptr,
                   SF_TRUE);  // plain WAV where it is short enough
}

WavWriter::~WavWriter() = default;

void WavWriter::fail() const { throw InputError(file_.string(), 0, "cannot be written to its end; is the disk full?"); }

void WavWriter::write(std::span<const float> samples) {
  for (const float sample : samples) largest_ = std::max(largest_, std::abs(sample));
  const auto count = static_cast<sf_count_t>(samples.size());
  if (sf_write_float(sound_file(sound_.get()), samples.data(), count) != count) fail();
}

void WavWriter::finish(float full_scale, const std::string& comment) {
  std::vector<float> part(kFramesAtOnce * static_cast<std::size_t>(channels_));
  const sf_count_t frames = sf_seek(sound_file(sound_.get()), 0, SEEK_END | SFM_WRITE);
  for (sf_count_t at = 0; at < frames;) {
    const sf_count_t count = std::min<sf_count_t>(frames - at, kFramesAtOnce);
    if (sf_seek(sound_file(sound_.get()), at, SEEK_SET | SFM_READ) != at ||
        sf_readf_float(sound_file(sound_.get()), part.data(), count) != count)
      fail();
    for (float& sample : part) sample /= full_scale;
    if (sf_seek(sound_file(sound_.get()), at, SEEK_SET | SFM_WRITE) != at ||
        sf_writef_float(sound_file(sound_.get()), part.data(), count) != count)
      fail();
    at += count;
  }
  if (sf_set_string(sound_file(sound_.get()), SF_STR_COMMENT, comment.c_str()) != 0) fail();
  sf_write_sync(sound_file(sound_.get()));
  if (sf_close(sound_file(sound_.release())) != 0) fail();
}

}  // namespace stillcut
