// The picture of a run in closed loop: depth, vibration and its spectrum, the truth, the indicator, the speed, events.
#pragma once

#include <string>

#include "drivers/files/cell.hpp"
#include "tools/closed_loop.hpp"
#include "tools/hil_score.hpp"
#include "tools/plot.hpp"

namespace stillcut {

plot::Figure hil_figure(const std::string& title, const Cell& cell, const VirtualMachine& machine, const Heard& heard,
                        const HilScore& score);

}  // namespace stillcut
