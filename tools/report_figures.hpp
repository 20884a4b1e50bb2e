// The pictures of a report: the timeline of the shift, the seconds around an episode of chatter, and the lobes with the
// cuts on them.
#pragma once

#include <string>
#include <vector>

#include "tools/plot.hpp"
#include "tools/report.hpp"

namespace stillcut {

plot::Figure timeline_figure(const Report& report);

// Of an episode that has a picture.
plot::Figure episode_figure(const ReportEpisode& episode);

// One a posture that had its own lobes, those with the most cuts first, at most `most`; none without lobes.
std::vector<plot::Figure> lobes_figures(const Report& report, std::size_t most);

}  // namespace stillcut
