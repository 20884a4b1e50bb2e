#include "drivers/dds/samples.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace stillcut {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr double kSlowest_hz = 1e-3;  // a rate below it is none

std::uint8_t byte(auto value) { return static_cast<std::uint8_t>(value); }

std::string text(const ShortText& text) { return std::string(text.data()); }

}  // namespace

TimeSample time_sample(std::int64_t stamp_ns) {
  std::int64_t seconds = stamp_ns / kSecond_ns, rest = stamp_ns % kSecond_ns;
  if (rest < 0) {
    --seconds;
    rest += kSecond_ns;
  }
  using Seconds = std::numeric_limits<std::int32_t>;
  TimeSample time;
  time.sec(static_cast<std::int32_t>(std::clamp<std::int64_t>(seconds, Seconds::min(), Seconds::max())));
  time.nanosec(static_cast<std::uint32_t>(rest));
  return time;
}

HeaderSample header_sample(std::int64_t stamp_ns, const char* frame_id) {
  HeaderSample header;
  header.stamp(time_sample(stamp_ns));
  header.frame_id(frame_id);
  return header;
}

StatusSample sample_of(const Status& status) {
  StatusSample sample;
  sample.header(header_sample(status.stamp_ns));
  sample.state(byte(status.state));
  sample.mode(byte(status.mode));
  sample.spindle_speed_rpm(status.spindle_speed_rpm);
  sample.indicator(status.indicator);
  sample.margin(status.margin);
  sample.chatter_frequency_hz(status.chatter_frequency_hz);
  sample.frames(status.frames);
  sample.frames_lost(status.frames_lost);
  sample.lobes_stamp(time_sample(status.lobes_stamp_ns));
  return sample;
}

IndicatorSample sample_of(const MonitorReport& report) {
  IndicatorSample sample;
  sample.header(header_sample(report.stamp_ns));
  sample.state(byte(report.state));
  sample.mode(byte(report.mode));
  sample.chatter(report.chatter);
  sample.kind(byte(report.kind));
  sample.doubts(report.doubts);
  sample.indicator(report.indicator);
  sample.spindle_speed_rpm(report.spindle_speed_rpm);
  sample.chatter_frequency_hz(report.chatter_frequency_hz);
  sample.chatter_amplitude_m_per_s2(report.chatter_amplitude);
  sample.chatter_mode(report.chatter_mode);
  sample.chatter_mode_hz(report.chatter_mode_hz);
  sample.structural_frequency_hz(report.structural_frequency_hz);
  sample.decay_per_s(report.decay_per_s);
  sample.decay_frequency_hz(report.decay_frequency_hz);
  sample.axial_depth_m(report.axial_depth);
  sample.feed_direction_rad(report.feed_direction);
  sample.depth_limit_m(report.depth_limit);
  sample.margin(report.margin);
  sample.predicted_chatter_hz(report.predicted_chatter_hz);
  return sample;
}

SpectrumSample sample_of(const SpectrumReport& report) {
  SpectrumSample sample;
  sample.header(header_sample(report.stamp_ns));
  sample.sensor(byte(report.sensor));
  sample.teeth(byte(report.teeth));
  sample.window_s(report.window_s);
  sample.bin_hz(report.bin_hz);
  sample.spindle_hz(report.spindle_hz);
  std::vector<float> amplitudes(report.levels.size());
  std::transform(report.levels.begin(), report.levels.end(), amplitudes.begin(), [&](std::uint8_t level) {
    return static_cast<float>(std::pow(10.0, (report.low_db + level * report.step_db) / 20.0));
  });
  sample.amplitude_m_per_s2(std::move(amplitudes));
  return sample;
}

CorrectionSample sample_of(const Correction& correction) {
  CorrectionSample sample;
  sample.header(header_sample(correction.stamp_ns));
  sample.sequence_number(correction.sequence);
  sample.valid_for_ms(correction.valid_for_ms);
  sample.mode(byte(correction.mode));
  sample.kind(byte(correction.kind));
  sample.spindle_speed_rpm(correction.spindle_speed_rpm);
  sample.spindle_speed_target_rpm(correction.spindle_speed_target_rpm);
  sample.speed_variation_ratio(correction.speed_variation_ratio);
  sample.speed_variation_hz(correction.speed_variation_hz);
  sample.feed_override(correction.feed_override);
  sample.feed_direction_rad(correction.feed_direction);
  sample.chatter_frequency_hz(correction.chatter_frequency_hz);
  sample.predicted_margin_before(correction.predicted_margin_before);
  sample.predicted_margin_after(correction.predicted_margin_after);
  sample.limited_by(static_cast<std::uint32_t>(correction.limited_by));
  sample.confidence_percent(byte(correction.confidence_percent));
  sample.reason(text(correction.reason));
  return sample;
}

EventSample sample_of(const Event& event) {
  EventSample sample;
  sample.header(header_sample(event.stamp_ns));
  sample.event(byte(event.type));
  sample.kind(byte(event.kind));
  sample.frequency_hz(event.frequency_hz);
  sample.indicator(event.indicator);
  sample.spindle_speed_rpm(event.spindle_speed_rpm);
  sample.note(text(event.note));
  return sample;
}

LobesSample sample_of(const DiagramReport& report) {
  LobesSample sample;
  sample.header(header_sample(report.stamp_ns));
  sample.posture_stamp(time_sample(report.posture_stamp_ns));
  sample.valid(report.valid);
  sample.min_rpm(report.min_rpm);
  sample.max_rpm(report.max_rpm);
  sample.speed_scatter(report.speed_scatter);
  sample.depth_scatter(report.depth_scatter);
  sample.mode_hz(report.mode_hz);
  sample.mode_damping(report.mode_damping);
  sample.depth_limit_mm(report.depth_limit_mm);
  return sample;
}

std::vector<ImuSample> samples_of(const VibrationReport& report) {
  const std::string frame = report.sensor == 0 ? "tool" : "tool_" + std::to_string(report.sensor);
  const bool timed = report.rate_hz >= kSlowest_hz;  // false for NaN
  const std::size_t count = report.samples.size(), first = timed || count == 0 ? 0 : count - 1;
  std::vector<ImuSample> samples(count - first);
  for (std::size_t i = first; i < count; ++i) {
    const double before_s = timed ? static_cast<double>(count - 1 - i) / report.rate_hz : 0.0;
    ImuSample& sample = samples[i - first];
    sample.header(header_sample(report.stamp_ns - std::llround(1e9 * before_s), frame.c_str()));
    sample.orientation_covariance()[0] = sample.angular_velocity_covariance()[0] = -1.0;
    const auto& [x, y, z] = report.samples[i];
    sample.linear_acceleration().x(x);
    sample.linear_acceleration().y(y);
    sample.linear_acceleration().z(z);
  }
  return samples;
}

}  // namespace stillcut
