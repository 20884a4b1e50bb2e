// Taps in WAV files: parse_wav_channels and read_tap_wav of tap_recording_file.hpp. A WAV knows no units: what its full
// scale is, the user says.
#include <sndfile.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <memory>
#include <stdexcept>

#include "drivers/files/input_error.hpp"
#include "drivers/files/measured_units.hpp"
#include "drivers/files/tap_recording_file.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kMostWavSamples = 100'000'000;  // a quarter of an hour of four channels at 25.6 kHz
constexpr std::array<std::string_view, 4> kWavSignals{"force", "x", "y", "z"};

WavChannel parse_wav_channel(std::string_view text) {
  if (text == "-") return {};
  const auto refuse = [&](const char* why) {
    return std::invalid_argument(
        "'" + std::string(text) + "' " + why +
        ": give force:2000N or x:500m/s^2, the value at digital full scale, or - for a channel "
        "that is not used");
  };
  const std::size_t colon = text.find(':');
  const auto name = std::find(kWavSignals.begin(), kWavSignals.end(), text.substr(0, colon));
  if (colon == std::string_view::npos || name == kWavSignals.end()) throw refuse("is no channel");
  WavChannel channel{static_cast<WavSignal>(name - kWavSignals.begin() + 1), 0.0};
  const std::string_view value = text.substr(colon + 1);
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), channel.full_scale);
  if (error != std::errc{} || !std::isfinite(channel.full_scale) || channel.full_scale == 0.0)
    throw refuse("has no full scale");
  const std::string_view unit(end, static_cast<std::size_t>(value.data() + value.size() - end));
  const std::optional<double> si = channel.signal == WavSignal::force ? force_unit(unit) : acceleration_unit(unit);
  if (!si) throw refuse(channel.signal == WavSignal::force ? "has no unit of force" : "has no unit of acceleration");
  channel.full_scale *= *si;
  return channel;
}

// libsndfile reads what is there of a file that was cut off, without a word.
void check_whole(const std::string& file) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  const std::int64_t bytes = in.tellg();
  std::array<char, 8> head{};
  in.seekg(0);
  if (!in.read(head.data(), head.size())) throw InputError(file, 0, "is no WAV file; check the path");
  std::uint32_t told = 0;
  for (std::size_t i = 4; i-- > 0;) told = told << 8 | static_cast<unsigned char>(head.at(4 + i));
  // Recorders that stream leave 0 or all ones.
  if (std::string_view(head.data(), 4) != "RIFF" || told == 0 || told == UINT32_MAX) return;
  if (bytes < std::int64_t{told} + 8)
    throw InputError(file, 0,
                     "is cut off: its head tells of " + std::to_string(std::int64_t{told} + 8) + " bytes, there are " +
                         std::to_string(bytes) + "; copy it again");
}

struct CloseSound {
  void operator()(SNDFILE* sound) const { sf_close(sound); }
};

}  // namespace

std::vector<WavChannel> parse_wav_channels(std::string_view text) {
  std::vector<WavChannel> channels;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    channels.push_back(parse_wav_channel(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  std::array<int, 5> count{};
  for (const WavChannel& channel : channels) ++count.at(static_cast<std::size_t>(channel.signal));
  for (std::size_t signal = 1; signal < count.size(); ++signal)
    if (count.at(signal) > 1)
      throw std::invalid_argument("'" + std::string(kWavSignals.at(signal - 1)) + "' is named twice: name it once");
  if (count[1] == 0) throw std::invalid_argument("no channel is the force: name one, such as force:2000N");
  if (count[2] + count[3] + count[4] == 0)
    throw std::invalid_argument("no channel is an acceleration: name one, such as x:500m/s^2");
  return channels;
}

TapRecording read_tap_wav(const std::filesystem::path& path, std::span<const WavChannel> channels) {
  const std::string file = path.string();
  if (channels.empty())
    throw InputError(file, 0, "a WAV file tells no units; name its channels: --channels force:2000N,x:500m/s^2");
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw InputError(file, 0, "no such file; check the path");
  SF_INFO info{};
  const std::unique_ptr<SNDFILE, CloseSound> sound(sf_open(file.c_str(), SFM_READ, &info));
  if (!sound) throw InputError(file, 0, std::string("cannot be read: ") + sf_strerror(nullptr));
  check_whole(file);
  if (info.channels != static_cast<int>(channels.size()))
    throw InputError(file, 0,
                     "has " + std::to_string(info.channels) + " channels, but " + std::to_string(channels.size()) +
                         " are named; name each, in order");
  if (info.frames < 2 || info.frames > kMostWavSamples)
    throw InputError(
        file, 0,
        "has " + std::to_string(info.frames) + " samples; must be from 2 to " + std::to_string(kMostWavSamples));
  TapRecording recording;
  recording.sample_rate_hz = info.samplerate;
  constexpr std::size_t kFrames = 4096;
  std::vector<double> frames(kFrames * channels.size());
  std::size_t sample = 0;
  for (sf_count_t read = 0; (read = sf_readf_double(sound.get(), frames.data(), kFrames)) > 0;) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(read); ++i, ++sample) {
      bool force_overload = false, response_overload = false;
      for (std::size_t c = 0; c < channels.size(); ++c) {
        const WavChannel& channel = channels[c];
        if (channel.signal == WavSignal::unused) continue;
        const double value = frames[i * channels.size() + c];
        if (!std::isfinite(value))
          throw InputError(file, 0,
                           "channel " + std::to_string(c + 1) + " is not finite at sample " + std::to_string(sample) +
                               "; record again");
        const bool overload = std::abs(value) >= kEndOfRange;
        if (channel.signal == WavSignal::force) {
          recording.force.push_back(value * channel.full_scale);
          force_overload = overload;
        } else {
          const auto axis = static_cast<std::size_t>(channel.signal) - static_cast<std::size_t>(WavSignal::x);
          recording.acceleration.at(axis).push_back(value * channel.full_scale);
          response_overload = response_overload || overload;
        }
      }
      if (force_overload) recording.force_overloads.push_back(sample);
      if (response_overload) recording.response_overloads.push_back(sample);
    }
  }
  if (sample != static_cast<std::size_t>(info.frames))
    throw InputError(
        file, 0,
        "ends after " + std::to_string(sample) + " of " + std::to_string(info.frames) + " samples; copy it again");
  return recording;
}

}  // namespace stillcut
