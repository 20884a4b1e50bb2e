// How an arm takes up its feed: from rest to the feed rate with a jerk, a constant acceleration and the jerk reversed,
// then on at that rate along a straight line (Huynh et al. 2017, section 3.1, Fig. 8).
#pragma once

#include <Eigen/Core>

namespace stillcut {

struct FeedPath {
  Eigen::Vector3d start = Eigen::Vector3d::Zero();       // m
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  // unit
  double feed_rate = 0.0;                                // m/s
  double jerk_time = 0.4, constant_time = 0.2;           // s; the paper's
};

struct FeedState {
  double travel, speed, acceleration;  // m, m/s, m/s^2, along the path
};

// At a time after the start, s; before it the tool stands. Throws std::invalid_argument for a jerk time that is not
// positive or a negative constant time.
FeedState feed_state(const FeedPath& path, double time);

// Where the tool is commanded to be, m.
Eigen::Vector3d feed_position(const FeedPath& path, double time);

}  // namespace stillcut
