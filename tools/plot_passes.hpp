// Pictures of the multibody paper's passes: forces over two turns (its Figs 10 to 13), their spectrum (Fig. 15), the
// machined wall (Fig. 17).
#pragma once

#include "tools/pass_table.hpp"
#include "tools/plot.hpp"

namespace stillcut {

plot::Figure pass_forces_figure(const std::vector<PassRun>& runs);
plot::Figure pass_spectrum_figure(const std::vector<PassRun>& runs);
plot::Figure pass_wall_figure(const std::vector<PassRun>& runs);

}  // namespace stillcut
