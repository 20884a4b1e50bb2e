#include "tools/output_comparison.hpp"

#include <algorithm>

namespace stillcut {

void OutputComparison::add(const Output& output, const RobotPlayback& robot) {
  if (!robot.is_recording()) return;
  if (output.type == Output::Type::event) decided_.push_back(encode(output.event));
  if (output.type == Output::Type::correction) decided_.push_back(encode(output.correction));
}

std::size_t OutputComparison::same_as(const std::vector<MessageBytes>& published) const {
  const auto differ = std::mismatch(decided_.begin(), decided_.end(), published.begin(), published.end());
  return static_cast<std::size_t>(differ.first - decided_.begin());
}

std::vector<std::string> OutputComparison::warnings(const RobotPlayback& robot, bool from_the_start) const {
  if (!robot.is_recording()) return {};
  std::vector<std::string> lines;
  if (robot.lobes_missing() > 0)
    lines.push_back(std::to_string(robot.lobes_missing()) + " stability lobe diagrams cannot be made again");
  const std::size_t same = same_as(robot.published());
  if (same == std::min(decided_.size(), robot.published().size())) return lines;
  lines.push_back("the live run decided otherwise from its decision " + std::to_string(same + 1) + " of " +
                  std::to_string(robot.published().size()) + " on: " +
                  (!from_the_start    ? "the beginning of this recording was deleted"
                   : robot.lost() > 0 ? "the recording has holes"
                                      : "is this the cell file of that run?"));
  return lines;
}

}  // namespace stillcut
