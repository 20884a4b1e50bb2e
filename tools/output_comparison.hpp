// A recording is decided again as it was, unless something is missing of it or it is played with another cell file:
// what playback decides, beside what the live run published.
#pragma once

#include <string>
#include <vector>

#include "rt/signals.hpp"
#include "tools/robot_playback.hpp"

namespace stillcut {

class OutputComparison {
 public:
  // An output of the core, in order; only those of a recording are kept.
  void add(const Output& output, const RobotPlayback& robot);

  [[nodiscard]] std::size_t count() const { return decided_.size(); }
  // How many from the first on are the same as the live run published, bit for bit.
  [[nodiscard]] std::size_t same_as(const std::vector<MessageBytes>& published) const;

  // Lines for the user. A crash, or an end before the recording's, may cut one of the two short.
  [[nodiscard]] std::vector<std::string> warnings(const RobotPlayback& robot, bool from_the_start) const;

 private:
  std::vector<MessageBytes> decided_;
};

}  // namespace stillcut
