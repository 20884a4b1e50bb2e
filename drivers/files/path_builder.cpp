#include "drivers/files/path_builder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

// Across the tool's axis, files that round to 0.1 µm and axes of seven decimals leave as much of a plunge.
constexpr double kRoundedTravel = 2e-7;     // m
constexpr double kRoundedDirection = 1e-6;  // of the length
constexpr std::size_t kLongestQuotation = 40;

bool travels_across(const Eigen::Vector3d& travel, const Eigen::Vector3d& axis) {
  const double across = (travel - travel.dot(axis) * axis).norm();
  return across > std::max(kRoundedTravel, kRoundedDirection * travel.norm());
}

}  // namespace

PathBuilder::PathBuilder(std::string file, std::string name) : file_(std::move(file)) { path_.name = std::move(name); }

void PathBuilder::fail(int line, const std::string& message) const { throw InputError(file_, line, message); }

void PathBuilder::check_reach(const Eigen::Vector3d& position, int line) const {
  for (int i = 0; i < 3; ++i) {
    if (std::abs(position[i]) <= kFarthestCoordinate) continue;
    fail(line, std::string(1, "XYZ"[i]) + ": lies beyond 100 m; check the number and the unit");
  }
}

void PathBuilder::add(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const PathMotion& motion, int line) {
  check_reach(to, line);
  if (from == to) return;
  const bool feeds = !std::isnan(motion.feed_rate);
  const bool cutting = feeds && travels_across(to - from, motion.tool_axis);
  if (cutting && motion.spindle_speed == 0.0)
    fail(line, "a feed move while the spindle stands still; start the spindle before it, or make it a rapid");
  if (path_.moves.size() >= kMostPathMoves)
    fail(line, "the path has more than " + std::to_string(kMostPathMoves) + " moves, chords of arcs counted; split it");
  PathMove move;
  move.from = from;
  move.to = to;
  move.tool_axis = motion.tool_axis;
  move.axis_from = motion.axis_from;
  move.cutting = cutting;
  move.feed_rate = motion.feed_rate;
  move.spindle_speed = motion.spindle_speed;
  move.line = line;
  path_.moves.push_back(move);
}

double PathBuilder::feed_rate(double per_minute_m, const std::string& word, int line) const {
  const double rate = per_minute_m / 60.0;
  if (!(rate > 0.0)) fail(line, word + ": a feed must be above 0; give the feed rate");
  if (rate > kFastestFeed) fail(line, word + ": a feed above 100 m/s; check the number and the unit");
  return rate;
}

double PathBuilder::spindle_speed(double speed_rpm, const std::string& word, int line) const {
  if (speed_rpm < 0.0) fail(line, word + ": a spindle speed below 0; give it without a sign");
  if (speed_rpm > kFastestSpindle) fail(line, word + ": a spindle speed above a million rpm; check the number");
  return speed_rpm * 2.0 * std::numbers::pi / 60.0;
}

std::string quoted_word(std::string_view text) {
  std::string quoted(text.substr(0, kLongestQuotation));
  if (text.size() > kLongestQuotation) quoted += "...";
  return quoted;
}

}  // namespace stillcut
