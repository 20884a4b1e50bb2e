// The legend of a panel: in the title's line, from the right; in rows above it where there is more to say. Used by
// plot*.cpp only.
#pragma once

#include "tools/plot_canvas.hpp"

namespace stillcut::plot {

inline constexpr double kSmallText = 11.5, kPanelText = 13.0;  // px

// How much room the legend takes above the title's line, px; `box` is the panel's, of which only left and right count.
double legend_overhang(Canvas& canvas, Box box, const Panel& panel);

void draw_legend(Canvas& canvas, Box box, const Panel& panel);

}  // namespace stillcut::plot
