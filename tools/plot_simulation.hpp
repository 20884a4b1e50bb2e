// The picture of a simulated cut: depth and speed as they were commanded, forces, motion and acceleration of the tool.
#pragma once

#include <string>
#include <vector>

#include "models/milling_simulation.hpp"
#include "tools/plot.hpp"

namespace stillcut {

plot::Figure simulation_figure(const std::string& title, const std::vector<MillingState>& states);

}  // namespace stillcut
