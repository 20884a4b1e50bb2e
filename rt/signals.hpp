// What flows into and out of the core beside the monitor's samples and events (dsp/signals.hpp): robot messages in;
// corrections and status out. Every type here is trivially copyable, so it passes through a ring or a snapshot.
// Times are nanoseconds on the CAN stamps' clock; other quantities are SI (m, s, rad) unless the name says otherwise.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "dsp/signals.hpp"
#include "models/milling_kind.hpp"

namespace stillcut {

// robot_state_t as received (contracts.md), placed on the CAN stamps' clock.
struct RobotState {
  std::int64_t stamp_ns = 0;
  std::array<double, 6> joint_position{};  // rad
  std::array<double, 3> tcp_position{};    // m, workpiece frame
  std::array<double, 4> tool_orientation{1, 0, 0, 0};
  double feed_direction = 0.0;     // rad
  double feed_rate = 0.0;          // m/s
  double spindle_speed_rpm = 0.0;  // commanded
  double axial_depth = 0.0;        // m; NaN: unknown
  double radial_depth = 0.0;       // m; NaN: unknown
  Milling milling = Milling::unknown;
  std::int32_t block = 0;
};

// robot_path_t as received (drivers/lcm): where the program takes the tool next.
struct PathPoint {
  double after = 0.0;                      // s from the path's stamp on
  std::array<double, 6> joint_position{};  // rad
  std::array<double, 3> tcp_position{};    // m, workpiece frame
  double feed_direction = 0.0;             // rad
  double radial_depth = 0.0;               // m; NaN: unknown
  Milling milling = Milling::unknown;
};

struct RobotPath {
  static constexpr std::size_t kMaxPoints = 8;

  std::int64_t stamp_ns = 0;
  std::size_t count = 0;
  std::array<PathPoint, kMaxPoints> points{};  // in time
};

// The loop falls out of time, or keeps it again (rt/timekeeper.hpp).
struct LoopTiming {
  std::int64_t stamp_ns = 0;
  bool in_time = true;
  std::int64_t longest_gap_ns = 0;  // between ticks
};

struct CorrectionAck {
  std::int64_t stamp_ns = 0;
  std::int64_t sequence = 0;
  bool accepted = false;
  double spindle_speed_rpm = 0.0;
  double feed_override = 1.0;
  ShortText reason{};  // why it was refused, in the controller's words
};

enum class RuntimeMode : std::int8_t { off = 0, shadow = 1, active = 2 };
enum class CorrectionKind : std::int8_t {
  release = 0,
  spindle_speed = 1,
  speed_variation = 2,
  feed_direction = 3,
  feed_override = 4,
  stop_request = 5
};

// Bits of Correction::limited_by.
inline constexpr std::int32_t kLimitedBySpeedRange = 1, kLimitedByAcceleration = 2, kLimitedByFeedRange = 4,
                              kLimitedByPath = 8, kNoStableSettingKnown = 16;

struct Correction {
  std::int64_t stamp_ns = 0;
  std::int64_t sequence = 0;
  std::int32_t valid_for_ms = 0;
  RuntimeMode mode = RuntimeMode::shadow;
  CorrectionKind kind = CorrectionKind::release;
  double spindle_speed_rpm = 0.0;  // setpoint now, on the jerk-limited ramp
  double spindle_speed_target_rpm = 0.0;
  double speed_variation_ratio = 0.0;
  double speed_variation_hz = 0.0;
  double feed_override = 1.0;
  double feed_direction = 0.0;  // rad
  double chatter_frequency_hz = 0.0;
  double predicted_margin_before = 0.0;  // a_lim/a - 1; NaN unknown
  double predicted_margin_after = 0.0;
  std::int32_t limited_by = 0;
  std::int8_t confidence_percent = 0;
  ShortText reason{};
};

struct Status {
  std::int64_t stamp_ns = 0;
  State state = State::idle;
  RuntimeMode mode = RuntimeMode::shadow;
  double spindle_speed_rpm = 0.0;
  double indicator = 0.0;
  double margin = 0.0;  // NaN unknown
  double chatter_frequency_hz = 0.0;
  std::int64_t frames = 0;
  std::int64_t frames_lost = 0;
  std::int64_t lobes_stamp_ns = 0;
};

// One item of the ring from the real-time thread to the publisher.
struct Output {
  enum class Type : std::uint8_t { event, correction, status } type = Type::event;
  union {
    Event event;
    Correction correction;
    Status status;
  };
  Output() : event{} {}
  explicit Output(const Event& e) : type{Type::event}, event{e} {}
  explicit Output(const Correction& c) : type{Type::correction}, correction{c} {}
  explicit Output(const Status& s) : type{Type::status}, status{s} {}
};

static_assert(std::is_trivially_copyable_v<RobotState> && std::is_trivially_copyable_v<RobotPath>);
static_assert(std::is_trivially_copyable_v<Output>);

}  // namespace stillcut
