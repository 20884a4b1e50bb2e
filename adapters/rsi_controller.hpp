// A simulated KUKA controller: RSI configured as docs/adapters.md says.
#pragma once

#include "adapters/simulated_controller.hpp"

namespace stillcut {

ControllerProtocol rsi_controller_protocol();

}  // namespace stillcut
