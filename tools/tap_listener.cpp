#include "tools/tap_listener.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "drivers/can/dbc.hpp"
#include "models/sentence.hpp"

namespace stillcut {
namespace {

// The cell's sensors as a decoder takes them.
CanSettings tapped_sensors(const Cell& cell, std::size_t sensor) {
  const HammerSettings& hammer = require_hammer(cell);
  CanSettings can = *cell.can;
  if (sensor >= can.accelerometers.size())
    throw InputError(cell.file.string(), can.line,
                     sentence("can.accelerometer: there are ", can.accelerometers.size(), ", number ", sensor + 1,
                              " is asked for; choose another --sensor"));
  const AccelerometerSettings accelerometer = can.accelerometers[sensor];
  if (hammer.sample_rate_hz != accelerometer.sample_rate_hz)
    throw InputError(cell.file.string(), hammer.line,
                     sentence("can.hammer.sample_rate_hz: ", hammer.sample_rate_hz, ", but the accelerometer's is ",
                              accelerometer.sample_rate_hz, "; they must be sampled together"));
  can.accelerometers = {accelerometer, hammer_as_sensor(hammer)};
  can.spindle_speed.clear();
  return can;
}

}  // namespace

const HammerSettings& require_hammer(const Cell& cell) {
  const CanSettings& can = require(cell, cell.can, "can");
  if (!can.hammer)
    throw InputError(cell.file.string(), can.line,
                     "can.hammer: is missing; add [can.hammer] with sample_rate_hz and force_n = \"Message.Signal\"");
  return *can.hammer;
}

AccelerometerSettings hammer_as_sensor(const HammerSettings& hammer) {
  AccelerometerSettings force;
  force.sample_rate_hz = hammer.sample_rate_hz;
  force.axis = {hammer.force, "", ""};
  force.counter = hammer.counter;
  force.line = hammer.line;
  force.table = "can.hammer";
  force.axis_keys = {"force_n", "", ""};
  return force;
}

TapListener::TapListener(const Cell& cell, std::size_t sensor, const TapSettings& settings)
    : settings_{settings},
      decoder_{read_dbc(require(cell, cell.can, "can").dbc), tapped_sensors(cell, sensor), cell.file.string()} {
  const AccelerometerSettings& accelerometer = cell.can->accelerometers[sensor];
  rate_hz_ = accelerometer.sample_rate_hz;
  settings_.force_full_scale_n = std::min(settings_.force_full_scale_n, cell.can->hammer->full_scale_n);
  settings_.acceleration_full_scale_m_per_s2 =
      std::min(settings_.acceleration_full_scale_m_per_s2, accelerometer.full_scale_m_per_s2);
  require_tap_settings(settings_);
  length_ = static_cast<std::int64_t>(record_samples(settings_, rate_hz_));
  before_ = static_cast<std::int64_t>(samples_before(settings_, rate_hz_));
  for (const SensorPlan& plan : decoder_.plan().sensors) {
    step_ = std::gcd(step_, plan.samples);
    if (plan.sensor == kResponse)
      for (std::size_t axis = 0; axis < kMaxAxes; ++axis) measured_.at(axis) = (plan.axes_present >> axis & 1U) != 0;
  }
}

void TapListener::set_direction(int axis, double sense) {
  settings_.force_axis = axis;
  settings_.force_sense = sense;
}

void TapListener::restart() {
  streams_ = {};
  hit_.reset();
  scanned_ = 0;
}

void TapListener::append(Side side, const SampleBlock& block) {
  Stream& stream = streams_.at(side);
  for (std::size_t i = 0; i < block.samples; ++i) {
    bool overload = false;
    for (std::size_t axis = 0; axis < kMaxAxes; ++axis) {
      if ((block.axes_present >> axis & 1U) == 0) continue;
      stream.values.at(axis).push_back(block.acceleration.at(axis).at(i));
      overload = overload || (block.full_scale.at(axis) >> i & 1U) != 0;
    }
    if (overload) stream.overloads.push_back(stream.end);
    ++stream.end;
  }
  stream.blocks.push_back({stream.end, block.stamp_ns});
  ++blocks_.at(side);
}

// By how many samples the response's index of a moment is above the force's. Frames of both are filled in step, so this
// is a whole number of frames; the median over many ignores the single late one.
std::int64_t TapListener::response_lead() const {
  const auto epoch_ns = streams_[kForce].blocks.front().stamp_ns;
  const auto begin_of = [&](const Stream& stream) {
    std::vector<double> begins;
    for (const Block& block : stream.blocks)
      begins.push_back(1e-9 * static_cast<double>(block.stamp_ns - epoch_ns) -
                       static_cast<double>(block.end) / rate_hz_);
    const auto middle = begins.begin() + static_cast<std::ptrdiff_t>(begins.size() / 2);
    std::ranges::nth_element(begins, middle);
    return *middle;
  };
  const double samples = (begin_of(streams_[kForce]) - begin_of(streams_[kResponse])) * rate_hz_;
  return step_ * std::llround(samples / step_);
}

TapRecording TapListener::cut_out(std::int64_t force_begin, std::int64_t length, std::int64_t lead) const {
  TapRecording recording;
  recording.sample_rate_hz = rate_hz_;
  const auto part = [&](Side side, std::size_t axis, std::int64_t begin) {
    const Stream& stream = streams_.at(side);
    const auto from = stream.values.at(axis).begin() + (begin - stream.begin);
    return std::vector<double>(from, from + length);
  };
  const auto overloads = [&](Side side, std::int64_t begin) {
    std::vector<std::size_t> at;
    for (const std::int64_t sample : streams_.at(side).overloads)
      if (sample >= begin && sample < begin + length) at.push_back(static_cast<std::size_t>(sample - begin));
    return at;
  };
  recording.force = part(kForce, 0, force_begin);
  recording.force_overloads = overloads(kForce, force_begin);
  for (std::size_t axis = 0; axis < kMaxAxes; ++axis)
    if (measured_.at(axis)) recording.acceleration.at(axis) = part(kResponse, axis, force_begin + lead);
  recording.response_overloads = overloads(kResponse, force_begin + lead);
  return recording;
}

std::optional<HeardTap> TapListener::next_hit() {
  const Stream& force = streams_[kForce];
  const Stream& response = streams_[kResponse];
  if (force.blocks.empty() || response.blocks.empty()) return {};
  const auto force_at = [&](std::int64_t i) { return force.values[0][static_cast<std::size_t>(i - force.begin)]; };
  for (; !hit_ && scanned_ < force.end; ++scanned_) {
    // A pulse towards minus is heard too: its sign is turned, which is said of it.
    const double value = force_at(scanned_);
    if (value >= settings_.trigger_n || value <= -settings_.least_peak_n || std::isnan(value)) hit_ = scanned_;
  }
  if (!hit_) return {};
  const std::int64_t begin = *hit_ - before_, end = begin + length_;
  if (force.end < end) return {};
  const std::int64_t lead = response_lead();
  if (response.end < end + lead) return {};
  HeardTap heard;
  if (begin < force.begin || begin + lead < response.begin) {
    heard.refusal = describe(TapFault::cut_off);
  } else {
    heard.recording = cut_out(begin, length_, lead);
    try {
      require_sound_taps(heard.recording, settings_);
      const std::vector<TapHit> hits = find_hits(heard.recording, settings_);
      if (hits.empty()) throw std::invalid_argument("the force was no pulse: hit again");
      heard.peak_n = hits.front().peak_n;
      if (hits.front().fault != TapFault::none) heard.refusal = describe(hits.front().fault);
    } catch (const std::invalid_argument& error) {
      heard.refusal = error.what();
    }
  }
  scanned_ = end;
  while (scanned_ < force.end && std::abs(force_at(scanned_)) >= 0.5 * settings_.trigger_n) ++scanned_;
  hit_.reset();
  return heard;
}

void TapListener::drop_before(Stream& stream, std::int64_t index) {
  index = std::min(index, stream.end);
  if (index <= stream.begin) return;
  for (std::deque<double>& values : stream.values)
    if (!values.empty()) values.erase(values.begin(), values.begin() + (index - stream.begin));
  while (!stream.overloads.empty() && stream.overloads.front() < index) stream.overloads.pop_front();
  while (stream.blocks.size() > 1 && stream.blocks.front().end <= index) stream.blocks.pop_front();
  stream.begin = index;
}

// Keeps the record before the next hit, whose frames tell how the two streams lie; and of a stream whose other one is
// silent some records, not all that ever comes.
void TapListener::forget_old() {
  Stream& force = streams_[kForce];
  Stream& response = streams_[kResponse];
  const std::int64_t kept = 2 * length_, most = 8 * length_;
  const std::int64_t oldest = (hit_ ? *hit_ : scanned_) - kept;
  if (oldest > force.begin + kept && !response.blocks.empty()) {
    const std::int64_t lead = response_lead();
    drop_before(force, oldest);
    drop_before(response, oldest + lead);
  }
  for (Stream& stream : streams_)
    if (stream.end - stream.begin > most) drop_before(stream, stream.end - most / 2);
  scanned_ = std::max(scanned_, force.begin);
  if (hit_ && *hit_ < force.begin) hit_.reset();
}

std::optional<HeardTap> TapListener::add(const CanFrame& frame) {
  if (!decoder_.decode(frame, decoded_)) return {};
  bool in_lost_hit = false;
  for (int b = 0; b < decoded_.blocks; ++b) {
    const SampleBlock& block = decoded_.block.at(static_cast<std::size_t>(b));
    if (block.frames_lost > 0) {
      in_lost_hit = in_lost_hit || hit_.has_value();
      restart();
    }
    append(block.sensor == kForce ? kForce : kResponse, block);
  }
  if (in_lost_hit) return HeardTap{{}, 0.0, "frames were lost on the bus: hit again"};
  std::optional<HeardTap> heard = next_hit();
  forget_old();
  return heard;
}

}  // namespace stillcut
