// Picture of slot tests: mean forces over feed per tooth and the lines that the coefficients make of them.
#pragma once

#include <string>
#include <vector>

#include "models/slot_coefficients.hpp"
#include "tools/plot.hpp"

namespace stillcut {

// One panel an axis, one colour a depth.
plot::Figure slot_figure(const std::string& subtitle, const Tool& tool, const std::vector<SlotTest>& tests,
                         const SlotFit& fit);

}  // namespace stillcut
