// A simulated ABB controller: EGM set up as docs/adapters.md says.
#pragma once

#include "adapters/egm_packets.hpp"
#include "adapters/simulated_controller.hpp"

namespace stillcut {

// EGM answers do not say which packet they belong to: whatever comes within the cycle counts.
inline ControllerProtocol egm_controller_protocol(EgmAnswer kind) {
  return {build_egm_report,
          [kind](std::string_view answer, const ControllerReport&) { return parse_egm_answer(kind, answer); }};
}

}  // namespace stillcut
