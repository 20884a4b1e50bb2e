#include "tools/export_samples.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "drivers/files/csv.hpp"
#include "drivers/files/uff58_file.hpp"
#include "tools/number_text.hpp"

namespace stillcut {
namespace {

constexpr int kTimeDecimals = 9;  // ns
constexpr std::string_view kAxisNames = "xyz";

std::vector<int> measured_axes(const AccelerometerSettings& sensor) {
  std::vector<int> axes;
  for (int a = 0; a < kMaxAxes; ++a)
    if (!sensor.axis[static_cast<std::size_t>(a)].empty()) axes.push_back(a);
  return axes;
}

float finite_or_silent(float value) { return std::isfinite(value) ? value : 0.0F; }

double in_six_digits(double value) {
  std::array<char, 32> text{};
  (void)std::snprintf(text.data(), text.size(), "%.5E", value);
  return std::strtod(text.data(), nullptr);
}

}  // namespace

SampleCsv::SampleCsv(std::ostream& out) : out_{out} {
  out_ << "time_s,sensor,x_m_per_s2,y_m_per_s2,z_m_per_s2,spindle_speed_rpm\n";
}

void SampleCsv::add(const SampleStretch& stretch, double spindle_speed_rpm) {
  row_.clear();
  std::string sensor(1, ','), end(1, ',');
  sensor.append(std::to_string(stretch.sensor + 1)).append(1, ',');
  append_number(end, spindle_speed_rpm);
  end += '\n';
  const auto begin_row = [&](std::int64_t i) {
    append_fixed(row_, stretch.begin_s + static_cast<double>(i) * stretch.step_s, kTimeDecimals);
    row_ += sensor;
  };
  for (std::int64_t i = 0; i < stretch.missing; ++i) {
    begin_row(i);
    row_ += ",,";
    row_ += end;
    if ((i & 0xFFF) == 0xFFF) {  // a long gap is not held either
      out_ << row_;
      row_.clear();
    }
  }
  for (int i = 0; i < stretch.samples; ++i) {
    begin_row(stretch.missing + i);
    for (std::size_t a = 0; a < kMaxAxes; ++a) {
      if (a > 0) row_ += ',';
      if (!stretch.axis[a].empty()) append_number(row_, stretch.axis[a][static_cast<std::size_t>(i)]);
    }
    row_ += end;
  }
  out_ << row_;
}

SampleWav::SampleWav(const std::string& file, const AccelerometerSettings& sensor)
    : axes_{measured_axes(sensor)},
      sample_rate_hz_{static_cast<int>(std::lround(sensor.sample_rate_hz))},
      wav_{file, static_cast<int>(axes_.size()), sample_rate_hz_} {}

void SampleWav::add(const SampleStretch& stretch) {
  constexpr std::int64_t kSilenceAtOnce = 4096;
  if (!begun_) begin_s_ = stretch.begin_s;
  begun_ = true;
  for (std::int64_t left = stretch.missing; left > 0; left -= kSilenceAtOnce) {
    frames_.assign(static_cast<std::size_t>(std::min(left, kSilenceAtOnce)) * axes_.size(), 0.0F);
    wav_.write(frames_);
  }
  frames_.clear();
  for (std::size_t i = 0; i < static_cast<std::size_t>(stretch.samples); ++i)
    for (const int a : axes_) frames_.push_back(finite_or_silent(stretch.axis[static_cast<std::size_t>(a)][i]));
  wav_.write(frames_);
}

double SampleWav::finish(double full_scale) {
  if (!(full_scale > 0.0)) full_scale = wav_.largest() > 0.0F ? static_cast<double>(wav_.largest()) : 1.0;
  std::string comment = "full scale ";
  append_number(comment, full_scale);
  comment += " m/s^2; channels";
  for (const int a : axes_) comment.append(" ").append(1, kAxisNames[static_cast<std::size_t>(a)]);
  comment += "; begins at ";
  append_fixed(comment, begin_s_, kTimeDecimals);
  comment += " s of the recording; stillcut " STILLCUT_VERSION;
  wav_.finish(static_cast<float>(full_scale), comment);
  return full_scale;
}

SampleUff::SampleUff(std::span<const AccelerometerSettings> sensors) {
  for (const AccelerometerSettings& sensor : sensors)
    sensors_.push_back({.sample_rate_hz = sensor.sample_rate_hz, .axis = {}});
}

void SampleUff::add(const SampleStretch& stretch) {
  Sensor& sensor = sensors_.at(static_cast<std::size_t>(stretch.sensor));
  for (std::size_t a = 0; a < kMaxAxes; ++a) {
    std::vector<float>& values = sensor.axis[a];
    if (stretch.axis[a].data() == nullptr) continue;
    if (static_cast<std::int64_t>(values.size()) + stretch.missing + stretch.samples > kMostUffSamples)
      throw std::length_error("a universal file of more than 10 million samples an axis (" +
                              csv_number(std::floor(kMostUffSamples / sensor.sample_rate_hz)) +
                              " s of this sensor) is not written; choose a shorter window with --from and --to");
    if (values.empty()) sensor.begin_s = stretch.begin_s;
    values.insert(values.end(), static_cast<std::size_t>(stretch.missing), 0.0F);
    std::transform(stretch.axis[a].begin(), stretch.axis[a].end(), std::back_inserter(values), finite_or_silent);
  }
  sensor.missing += stretch.missing;
}

void SampleUff::write(std::ostream& out) const {
  UffFile file{.units = UffUnits{}, .functions = {}};
  for (std::size_t s = 0; s < sensors_.size(); ++s) {
    const Sensor& sensor = sensors_[s];
    for (std::size_t a = 0; a < kMaxAxes; ++a) {
      if (sensor.axis[a].empty()) continue;
      UffFunction function;
      function.id[0] = std::string("acceleration ") + kAxisNames[a] + ", sensor " + std::to_string(s + 1);
      function.id[1] = "begins at ";
      append_fixed(function.id[1], sensor.begin_s, kTimeDecimals);
      function.id[1] += " s of the recording";
      if (sensor.missing > 0) function.id[2] = std::to_string(sensor.missing) + " samples are missing and stand as 0";
      function.type = kUffTimeResponse;
      function.response_node = static_cast<int>(s + 1);
      function.response_direction = static_cast<int>(a + 1);
      function.complex = false;
      function.double_precision = false;
      function.even = true;
      function.abscissa_axis = {kUffTime, "Time", "s"};
      function.ordinate = {kUffAcceleration, "Acceleration", "m/s^2"};
      // As the format's digits have it, so that all times are told by begin and step.
      const double begin = in_six_digits(sensor.begin_s), step = in_six_digits(1.0 / sensor.sample_rate_hz);
      function.values.assign(sensor.axis[a].begin(), sensor.axis[a].end());
      function.abscissa.reserve(function.values.size());
      for (std::size_t i = 0; i < function.values.size(); ++i)
        function.abscissa.push_back(begin + static_cast<double>(i) * step);
      file.functions.push_back(std::move(function));
      write_uff(out, file, UffForm::binary);
      file = {};  // the units stand once, and one axis at a time is held as numbers of double precision
    }
  }
}

}  // namespace stillcut
