// The score of a run in closed loop: what the monitor said beside what the simulated machine knows of itself.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "dsp/signals.hpp"
#include "models/chatter_truth.hpp"
#include "tools/virtual_machine.hpp"

namespace stillcut {

struct HilScore {
  std::vector<ChatterSpell> spells;      // the truth
  double chatter_s = 0.0;                // all spells together
  std::optional<bool> detected;          // the first spell was heard; empty: there was none, as in the next three
  std::optional<double> detection_ms;    // from its start to the alarm; negative: the alarm came first
  std::optional<bool> suppressed;        // every spell ended while the tool cut on at the full depth
  std::optional<double> suppression_ms;  // from the first alarm to the end of the last spell
  int false_alarms = 0;                  // onsets at no spell
  int corrections = 0;                   // target speeds asked for
  double peak_displacement_um = 0.0;
  std::vector<MilledLength> lengths;          // of the wall or floor
  std::optional<ProfileRoughness> roughness;  // m, their mean; empty: none was cut
  std::optional<double> removed_mm3_per_min;  // while the tool was in the part; empty: it never was
  bool stopped = false;                       // a stop request was followed
};

HilScore score_run(const VirtualMachine& machine, std::span<const Event> events);

}  // namespace stillcut
