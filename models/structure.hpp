// What the tool is fastened to: anything whose tool point moves under a cutting force, in steps of equal length. The
// milling simulation knows no more of a machine than this; kinds: models/modal_structure (a dynamics map's modes),
// models/newmark_robot (a robot, whole) and models/linearised_robot (a robot, fast).
#pragma once

#include <Eigen/Core>

namespace stillcut {

// Positions are those of the tool point relative to its commanded path, in workpiece axes: m, m/s, m/s^2. Forces act on
// the tool and go from `begin` to `end` in a straight line within a step, N.
class Structure {
 public:
  virtual ~Structure() = default;

  // Where the tool point will be after one step; changes nothing. What a kind cannot know without solving it may
  // approximate to second order in the step: the caller corrects with advance().
  [[nodiscard]] virtual Eigen::Vector3d displacement_after(const Eigen::Vector3d& begin,
                                                           const Eigen::Vector3d& end) const = 0;

  // Moves on by one step. Throws std::runtime_error, with the reason, where the motion cannot be continued.
  virtual void advance(const Eigen::Vector3d& begin, const Eigen::Vector3d& end) = 0;

  // A hammer blow: impulse in N s, workpiece axes.
  virtual void strike(const Eigen::Vector3d& impulse) = 0;

  [[nodiscard]] virtual Eigen::Vector3d displacement() const = 0;
  [[nodiscard]] virtual Eigen::Vector3d velocity() const = 0;
  [[nodiscard]] virtual Eigen::Vector3d acceleration() const = 0;  // under the `end` force of the last step
};

}  // namespace stillcut
