// Counts of what was decided, for the summary lines of daemon and playback.
#pragma once

#include <cstdint>

#include "dsp/signals.hpp"

namespace stillcut {

struct EventTally {
  std::int64_t chatter_onsets = 0, corrections = 0, faults = 0;
  bool chatter_open = false;

  void count(const Event& event) noexcept {
    if (event.type == EventType::chatter_onset) {  // a kind told later belongs to the same onset
      chatter_onsets += chatter_open ? 0 : 1;
      chatter_open = true;
    }
    if (event.type == EventType::chatter_end) chatter_open = false;
    corrections += event.type == EventType::correction ? 1 : 0;
    faults += event.type == EventType::fault ? 1 : 0;
  }
};

}  // namespace stillcut
