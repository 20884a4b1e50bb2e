// Time records of taps in universal files: tap_file_of and uff_of of tap_recording_file.hpp.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "drivers/files/input_error.hpp"
#include "drivers/files/measured_units.hpp"
#include "drivers/files/tap_rate.hpp"
#include "drivers/files/tap_recording_file.hpp"

namespace stillcut {
namespace {

constexpr double kAlikeUnits = 1e-3;  // relative
constexpr const char* kTapAxes = "xyz";

bool tells_no_unit(const std::string& label) {
  return label.empty() || label == "NONE" || label == "none" || label == "None";
}

class TapFileReader {
 public:
  TapFileReader(const UffFile& content, const std::string& file) : content_(content), file_(file) {}

  TapFile read() {
    std::size_t others = 0;
    for (const UffFunction& function : content_.functions) {
      if (function.type == kUffTimeResponse)
        add(function);
      else
        ++others;
    }
    finish();
    if (result_.taps.empty()) throw InputError(file_, 0, "has no time record (function type 1 of dataset 58)");
    if (others > 0) result_.notes.push_back(std::to_string(others) + " functions that are no time record are left out");
    if (si_assumed_) result_.notes.emplace_back("no units are given (dataset 164 or axis labels); SI is assumed");
    return std::move(result_);
  }

 private:
  [[noreturn]] void fail(const UffFunction& function, const std::string& message) const {
    throw InputError(file_, function.line, message);
  }

  void add(const UffFunction& function) {
    if (function.complex) fail(function, "a time record of complex numbers; export it as real");
    const bool force = is_force(function);
    const int direction = function.response_direction, axis = std::abs(direction);
    if (axis < 1 || axis > 3)
      fail(function, "response direction: " + std::to_string(direction) +
                         " is no translation; must be 1, 2 or 3 for x, y, z, or negative");
    const auto index = static_cast<std::size_t>(axis - 1);
    if (first_ != nullptr && !(force ? now_.recording.force : now_.recording.acceleration[index]).empty()) finish();
    const double rate = rate_of(function);
    if (first_ == nullptr) {
      first_ = &function;
      now_.recording.sample_rate_hz = rate;
    }
    if (rate != now_.recording.sample_rate_hz || function.values.size() != first_->values.size())
      fail(function, "has another rate or length than the record of line " + std::to_string(first_->line) +
                         "; record force and accelerations together");
    double scale = unit_of(function, force);
    if (force) {
      // Pressing is positive along the function's direction.
      now_.direction = HammerDirection{axis - 1, direction > 0 ? 1.0 : -1.0};
    } else {
      if (acceleration_ != nullptr && acceleration_->response_node != function.response_node)
        fail(function, "acceleration at node " + std::to_string(function.response_node) + ", not " +
                           std::to_string(acceleration_->response_node) + " as in line " +
                           std::to_string(acceleration_->line) + "; a recording is of the tool's point alone");
      acceleration_ = &function;
      if (direction < 0) scale = -scale;
    }
    std::vector<double>& channel = force ? now_.recording.force : now_.recording.acceleration[index];
    for (const std::complex<double>& value : function.values) channel.push_back(scale * value.real());
  }

  // The recording at hand is over.
  void finish() {
    if (first_ == nullptr) return;
    if (now_.recording.force.empty())
      fail(*first_, "acceleration without force in one recording; export the hammer's record before them");
    if (acceleration_ == nullptr)
      fail(*first_, "force without acceleration in one recording; export the accelerations after it");
    result_.taps.push_back(std::move(now_));
    now_ = {};
    first_ = acceleration_ = nullptr;
  }

  // By the data type, or where that is open by the unit.
  bool is_force(const UffFunction& function) const {
    const int type = function.ordinate.data_type;
    if (type == kUffExcitationForce || type == kUffReactionForce) return true;
    if (type == kUffAcceleration) return false;
    if (type <= 1 && force_unit(function.ordinate.units)) return true;
    if (type <= 1 && acceleration_unit(function.ordinate.units)) return false;
    fail(function, "ordinate: data type " + std::to_string(type) + " is no force (13, 9) and no acceleration (12)");
  }

  double rate_of(const UffFunction& function) const {
    const UffAxis& axis = function.abscissa_axis;
    if (axis.data_type > 1 && axis.data_type != kUffTime)
      fail(function, "abscissa: data type " + std::to_string(axis.data_type) + " is no time (17)");
    if (!tells_no_unit(axis.units) && axis.units != "s" && axis.units != "sec" && axis.units != "ms")
      fail(function, "abscissa: unit \"" + axis.units + "\" is not known; must be s or ms");
    std::vector<double> times = function.abscissa;
    if (axis.units == "ms")
      for (double& time : times) time *= 1e-3;
    std::size_t uneven = 0;
    const double rate = even_rate_hz(times, uneven);
    if (rate > 0.0) return rate;
    fail(function, times.size() < 2 ? std::string("holds no two samples")
                                    : "abscissa: times must rise evenly; point " + std::to_string(uneven + 1) +
                                          " is not where the others say");
  }

  double unit_of(const UffFunction& function, bool force) {
    const std::string& label = function.ordinate.units;
    std::optional<double> by_dataset, by_label;
    if (content_.units) by_dataset = 1.0 / (force ? content_.units->force : content_.units->length);
    if (!tells_no_unit(label)) {
      by_label = force ? force_unit(label) : acceleration_unit(label);
      if (!by_label)
        fail(function,
             "ordinate: unit \"" + label + "\" is of no " +
                 (force ? "force; must be N, mN, kN or lbf" : "acceleration; must be m/s^2, mm/s^2, in/s^2 or g"));
    }
    if (by_label && by_dataset && std::abs(*by_label - *by_dataset) > kAlikeUnits * *by_dataset)
      fail(function, "ordinate: \"" + label + "\" contradicts the units of dataset 164, line " +
                         std::to_string(content_.units->line) + "; correct one of them");
    si_assumed_ = si_assumed_ || (!by_label && !by_dataset);
    return by_label.value_or(by_dataset.value_or(1.0));
  }

  const UffFile& content_;
  const std::string& file_;
  TapFile result_;
  RecordedTaps now_;
  const UffFunction* first_ = nullptr;         // of the recording at hand
  const UffFunction* acceleration_ = nullptr;  // of it, the newest
  bool si_assumed_ = false;
};

double six_digits(double value) {
  std::array<char, 32> text{};
  (void)std::snprintf(text.data(), text.size(), "%.5E", value);
  return std::strtod(text.data(), nullptr);
}

UffFunction time_record(const TapRecording& recording, const std::vector<double>& values, const std::string& name,
                        int direction, const UffAxis& ordinate) {
  UffFunction function;
  function.id[0] = name;
  function.type = kUffTimeResponse;
  function.response_node = 1;
  function.response_direction = direction;
  function.complex = false;
  function.even = true;
  function.abscissa_axis = {kUffTime, "Time", "s"};
  function.ordinate = ordinate;
  // As the format's digits have it: then text and binary tell the same times, and evenly.
  const double step = six_digits(1.0 / recording.sample_rate_hz);
  for (std::size_t i = 0; i < values.size(); ++i) function.abscissa.push_back(static_cast<double>(i) * step);
  function.values.assign(values.begin(), values.end());
  return function;
}

}  // namespace

TapFile tap_file_of(const UffFile& content, const std::string& file) { return TapFileReader(content, file).read(); }

UffFile uff_of(std::span<const TapRecording> recordings, HammerDirection hammer) {
  UffFile content{.units = UffUnits{}, .functions = {}};
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const TapRecording& recording = recordings[r];
    const std::string part = ", recording " + std::to_string(r + 1);
    content.functions.push_back(time_record(recording, recording.force, "force" + part,
                                            hammer.sense < 0.0 ? -(hammer.axis + 1) : hammer.axis + 1,
                                            {kUffExcitationForce, "Force", "N"}));
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (!recording.acceleration[axis].empty())
        content.functions.push_back(
            time_record(recording, recording.acceleration[axis], std::string("acceleration ") + kTapAxes[axis] + part,
                        static_cast<int>(axis) + 1, {kUffAcceleration, "Acceleration", "m/s^2"}));
  }
  return content;
}

}  // namespace stillcut
