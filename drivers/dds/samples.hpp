// What the daemon tells, as samples of the ROS 2 message types (telemetry.idl). The numbers are those of the LCM
// messages (drivers/lcm); what a sample's members mean stands in ros2/stillcut_msgs/msg.
#pragma once

#include <telemetry.h>

#include <vector>

#include "drivers/lcm/telemetry_messages.hpp"

namespace stillcut {

using TimeSample = builtin_interfaces::msg::dds_::Time_;
using HeaderSample = std_msgs::msg::dds_::Header_;
using ImuSample = sensor_msgs::msg::dds_::Imu_;
using DiagnosticsSample = diagnostic_msgs::msg::dds_::DiagnosticArray_;
using StatusSample = stillcut_msgs::msg::dds_::Status_;
using IndicatorSample = stillcut_msgs::msg::dds_::Indicator_;
using SpectrumSample = stillcut_msgs::msg::dds_::Spectrum_;
using CorrectionSample = stillcut_msgs::msg::dds_::Correction_;
using EventSample = stillcut_msgs::msg::dds_::Event_;
using LobesSample = stillcut_msgs::msg::dds_::Lobes_;

// Whole seconds rounded down; from 1901 to 2038, which is what the type can say.
TimeSample time_sample(std::int64_t stamp_ns);
HeaderSample header_sample(std::int64_t stamp_ns, const char* frame_id = "");

StatusSample sample_of(const Status& status);
IndicatorSample sample_of(const MonitorReport& report);
SpectrumSample sample_of(const SpectrumReport& report);  // levels become amplitudes
CorrectionSample sample_of(const Correction& correction);
EventSample sample_of(const Event& event);
LobesSample sample_of(const DiagramReport& report);
// One for each sample, at its own time; the last alone where the report's rate is none. Orientation and angular
// velocity are marked as not measured, as sensor_msgs/Imu asks for; frame `tool`, of further sensors `tool_1` and so
// on.
std::vector<ImuSample> samples_of(const VibrationReport& report);

}  // namespace stillcut
