// The topics, by name, and how many samples their writers keep for readers that fell behind: about a second's.
#pragma once

#include <string>

namespace stillcut {

struct DdsTopic {
  const char* name;  // behind the namespace
  int depth;
};
inline constexpr DdsTopic kStatusTopic{"status", 10}, kIndicatorTopic{"indicator", 20}, kSpectrumTopic{"spectrum", 20},
    kVibrationTopic{"vibration", 200}, kCorrectionTopic{"correction", 10}, kEventTopic{"event", 100},
    kLobesTopic{"lobes", 10}, kDiagnosticsTopic{"diagnostics", 10};

// ROS 2 calls it /NAMESPACE/NAME; its diagnostics have one topic for all.
inline std::string topic_name(const std::string& name_space, const DdsTopic& topic) {
  const std::string prefix = topic.name == kDiagnosticsTopic.name ? "rt/" : "rt/" + name_space + '/';
  return prefix + topic.name;
}

}  // namespace stillcut
