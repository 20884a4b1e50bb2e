// Puts a tool path together from the positions that a file names one after the other, with the limits that every such
// file keeps: the readers of G-code and of cutter locations share it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>

#include "models/tool_path.hpp"

namespace stillcut {

inline constexpr double kFarthestCoordinate = 100.0;      // m; a number beyond it is a slip of the unit or of the point
inline constexpr std::size_t kMostPathMoves = 2'000'000;  // 220 MB of them
inline constexpr double kFastestFeed = 100.0;             // m/s
inline constexpr double kFastestSpindle = 1e6;            // rpm

// What holds while a move is made. A feed of NaN is a rapid.
struct PathMotion {
  double feed_rate = 0.0;      // m/s
  double spindle_speed = 0.0;  // rad/s; NaN: not said; 0: stands still
  Eigen::Vector3d tool_axis = Eigen::Vector3d::UnitZ();
  std::optional<Eigen::Vector3d> axis_from{};  // where it is not the axis all along
};

class PathBuilder {
 public:
  PathBuilder(std::string file, std::string name);

  // Adds the move from `from` to `to`, unless it has no length. A feed move cuts when it travels across the tool's
  // axis; along the axis it plunges or lifts, and does not. Throws InputError: a coordinate beyond 100 m, a cutting
  // move while the spindle stands still, more moves than memory should hold.
  void add(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const PathMotion& motion, int line);

  void check_reach(const Eigen::Vector3d& position, int line) const;
  // Speeds as a file writes them; both throw InputError when they cannot be meant. `word` names them in the message.
  [[nodiscard]] double feed_rate(double per_minute_m, const std::string& word, int line) const;   // m/s
  [[nodiscard]] double spindle_speed(double speed_rpm, const std::string& word, int line) const;  // rad/s

  [[noreturn]] void fail(int line, const std::string& message) const;

  [[nodiscard]] ToolPath& path() { return path_; }

 private:
  std::string file_;
  ToolPath path_;
};

// A user's own text within a message: cut short, as files that are no programs have lines of any length.
std::string quoted_word(std::string_view text);

}  // namespace stillcut
