// Is this host fit to run the loop in active mode, where a late tick matters? Asked before the loop starts, by a
// rehearsal: the loop's thread with all its rights, ticking for a fifth of a second with nothing to do.
#pragma once

#include "rt/thread.hpp"

namespace stillcut {

// Throws ComponentError with the reasons and what mends them where the thread does not get all that it asks for, or
// wakes too late: half a period at the 99th percentile, or a single time by five periods.
void require_real_time(const RealTimeSettings& settings);

}  // namespace stillcut
