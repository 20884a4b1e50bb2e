// A robot under the milling simulation: the arm holds the tool and moves along the feed while it cuts.
#pragma once

#include "models/arm.hpp"
#include "models/milling_simulation.hpp"

namespace stillcut {

enum class RobotIntegrator {
  whole,      // all equations of motion (models/newmark_robot)
  linearised  // the modes of the posture, made anew as it moves (models/linearised_robot): several tens of times faster
};

// Fastens the setup's tool to an arm that starts at its home angles and follows the setup's feed, at its speed and
// direction, the tool turned as at home. The arm does not know of conditions that change later: its path stays the
// setup's. Throws std::invalid_argument, with the reason, for an arm without modes there; what it cannot follow on the
// way stops the simulation (std::runtime_error).
[[nodiscard]] MillingSetup held_by_robot(MillingSetup setup, const Arm& arm, RobotIntegrator integrator);

}  // namespace stillcut
