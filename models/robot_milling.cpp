#include "models/robot_milling.hpp"

#include <cmath>

#include "models/arm_dynamics.hpp"
#include "models/arm_modes.hpp"
#include "models/arm_reach.hpp"
#include "models/linearised_robot.hpp"
#include "models/newmark_robot.hpp"

namespace stillcut {

MillingSetup held_by_robot(MillingSetup setup, const Arm& arm, RobotIntegrator integrator) {
  const JointVector home = home_angles(arm);
  setup.modes = tool_modes(linear_arm(arm, home));
  const Cut& cut = setup.cut;
  const double feed_rate = cut.feed_per_tooth * setup.tool.teeth * cut.spindle_speed / kTwoPi;
  const Eigen::Vector3d feed =
      feed_rate * Eigen::Vector3d(std::cos(cut.feed_direction), std::sin(cut.feed_direction), 0.0);
  const Eigen::Vector3d start = arm_pose(arm, home).tool;
  const JointPath path = feed_rate > 0.0
                             ? JointPath([arm, start, feed](double time) { return reach(arm, start + time * feed); })
                             : holding(home);
  if (integrator == RobotIntegrator::whole) {
    setup.structure = [arm, path](double step) { return std::make_unique<NewmarkRobot>(arm, path, step); };
  } else {
    setup.structure = [arm, path](double step) {
      return std::make_unique<LinearisedRobot>([arm](const JointVector& q) { return linear_arm(arm, q); }, path, step);
    };
  }
  return setup;
}

}  // namespace stillcut
