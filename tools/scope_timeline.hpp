// A recording or a simulated cut as a timeline for the page: played once through the daemon's own code, as fast as it
// goes, with all that the daemon would have told.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "drivers/files/cell.hpp"
#include "tools/playback.hpp"
#include "tools/scope_feed.hpp"

namespace stillcut {

// warnings: lines for the user. Both throw InputError.
std::unique_ptr<TimelineFeed> timeline_of_recording(const Cell& cell, const PlaybackSource& source, FeedTitle title,
                                                    std::vector<std::string>& warnings);
// In closed loop, corrections followed as the cell's mode says.
std::unique_ptr<TimelineFeed> timeline_of_scenario(const Cell& cell, const std::string& scenario, FeedTitle title);

}  // namespace stillcut
