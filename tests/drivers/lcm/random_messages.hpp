// Random values of every message type, all within what a decoder accepts; stamps are whole microseconds, as messages
// hold.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>

#include "dsp/numbers.hpp"
#include "rt/signals.hpp"

namespace stillcut {

class RandomMessages {
 public:
  explicit RandomMessages(std::uint32_t seed) : random_{seed} {}

  RobotState state() {
    RobotState s;
    s.stamp_ns = stamp();
    for (double& joint : s.joint_position) joint = uniform(-6, 6);
    for (double& coordinate : s.tcp_position) coordinate = uniform(-3, 3);
    double squared = 0.0;
    for (double& q : s.tool_orientation) {
      q = uniform(0.1, 1);
      squared += q * q;
    }
    for (double& q : s.tool_orientation) q /= std::sqrt(squared);
    s.feed_direction = uniform(-3, 3);
    s.feed_rate = uniform(0, 1);
    s.spindle_speed_rpm = uniform(0, 20000);
    s.axial_depth = coin() ? kNaN : uniform(0, 0.01);
    s.radial_depth = coin() ? kNaN : uniform(0, 0.1);
    s.milling = static_cast<Milling>(whole(0, 3));
    s.block = whole(-1000, 100000);
    return s;
  }
  RobotPath path() {
    RobotPath p;
    p.stamp_ns = stamp();
    p.count = static_cast<std::size_t>(whole(0, static_cast<int>(RobotPath::kMaxPoints)));
    double after = 0.0;
    for (std::size_t i = 0; i < p.count; ++i) {
      PathPoint& point = p.points[i];
      point.after = after += uniform(0, 2);
      for (double& joint : point.joint_position) joint = uniform(-6, 6);
      for (double& coordinate : point.tcp_position) coordinate = uniform(-3, 3);
      point.feed_direction = uniform(-3, 3);
      point.radial_depth = coin() ? kNaN : uniform(0, 0.1);
      point.milling = static_cast<Milling>(whole(0, 3));
    }
    return p;
  }
  CorrectionAck ack() { return {stamp(), whole(0, 1 << 30), coin(), uniform(0, 20000), uniform(0, 2)}; }
  Correction correction() {
    Correction c;
    c.stamp_ns = stamp();
    c.sequence = whole(0, 1 << 30);
    c.valid_for_ms = whole(0, 5000);
    c.mode = static_cast<RuntimeMode>(whole(0, 2));
    c.kind = static_cast<CorrectionKind>(whole(0, 5));
    for (double* value : {&c.spindle_speed_rpm, &c.spindle_speed_target_rpm, &c.speed_variation_ratio,
                          &c.speed_variation_hz, &c.feed_override, &c.feed_direction, &c.chatter_frequency_hz,
                          &c.predicted_margin_before, &c.predicted_margin_after}) {
      *value = any_double();
    }
    c.limited_by = whole(0, 31);
    c.confidence_percent = static_cast<std::int8_t>(whole(0, 100));
    c.reason = text();
    return c;
  }
  Event event() {
    return {stamp(),
            static_cast<EventType>(whole(1, 7)),
            static_cast<ChatterKind>(whole(0, 2)),
            any_double(),
            any_double(),
            any_double(),
            text()};
  }
  Status status() {
    return {stamp(),
            static_cast<State>(whole(0, 7)),
            static_cast<RuntimeMode>(whole(0, 2)),
            any_double(),
            any_double(),
            any_double(),
            any_double(),
            whole(0, 1 << 30),
            whole(0, 1000),
            stamp()};
  }

 private:
  int whole(int min, int max) { return std::uniform_int_distribution<int>(min, max)(random_); }
  double uniform(double min, double max) { return std::uniform_real_distribution<double>(min, max)(random_); }
  bool coin() { return whole(0, 1) == 1; }
  // Any bits at all: NaN, infinities and denormals too.
  double any_double() {
    const std::uint64_t high = random_();
    return std::bit_cast<double>(high << 32 | random_());
  }
  std::int64_t stamp() { return (1700000000000000LL + whole(0, 1 << 30)) * 1000; }
  ShortText text() {
    ShortText out{};
    const int length = whole(0, static_cast<int>(out.size()) - 1);
    for (int i = 0; i < length; ++i) out[static_cast<std::size_t>(i)] = static_cast<char>(whole(1, 255));
    return out;
  }

  std::mt19937 random_;
};

}  // namespace stillcut
