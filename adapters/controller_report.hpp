// What a controller tells in one of its cycles, in SI units, whatever the protocol it came by.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

namespace stillcut {

struct ControllerReport {
  std::int64_t counter = 0;                       // counts the controller's cycles; its step is the protocol's
  std::int64_t clock_us = 0;                      // the controller's own clock
  std::array<double, 6> joints{};                 // rad; 0 where it has none
  std::array<double, 3> position{};               // m, in the base the program runs in: the workpiece frame
  std::array<double, 4> orientation{1, 0, 0, 0};  // wxyz
  double spindle_speed_rpm = std::numeric_limits<double>::quiet_NaN();  // as programmed; NaN: not told
  std::int32_t block = 0;                                               // of the program; 0: not told
  std::int64_t late_answers = 0;                                        // as the controller counts them
};

// Beyond these no machine moves: such a packet is broken.
inline constexpr double kMaxReportedJoint = 1e3, kMaxReportedPosition = 1e3, kMaxReportedSpeed_rpm = 1e6;

// A report, or why the packet is none.
struct ParsedReport {
  ControllerReport report;
  const char* why_not = nullptr;
};

// The reason why a report cannot be believed; nullptr: it can.
const char* reason_to_doubt(const ControllerReport& report);

// Rotations about z, then the new y, then the new x (rad), as one quaternion wxyz: the angles A, B, C of KUKA.
std::array<double, 4> quaternion_of_zyx(double about_z, double about_y, double about_x);

}  // namespace stillcut
