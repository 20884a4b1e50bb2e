// A timeline of bounded length over a recording of any length: when it is full, neighbours are joined and each stretch
// lasts twice as long.
#pragma once

#include <vector>

#include "tools/report.hpp"

namespace stillcut {

class Timeline {
 public:
  static constexpr std::size_t kMost = 1600;

  // What was seen at a moment; times may go back a little.
  void add(const TimelinePoint& seen);

  [[nodiscard]] const std::vector<TimelinePoint>& points() const { return points_; }  // begin to begin + step
  [[nodiscard]] double step_s() const { return step_s_; }

 private:
  void join_neighbours();

  double step_s_ = 0.05;
  std::vector<TimelinePoint> points_;
};

// Which of two states a reader must know of.
[[nodiscard]] State graver(State a, State b);

}  // namespace stillcut
