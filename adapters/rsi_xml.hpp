// The packets of KUKA's RobotSensorInterface (RSI): XML over UDP, one from the controller each cycle of 4 or 12 ms, one
// answer to each within the cycle, with the controller's own stamp (IPOC) in it.
//
// Out go differences from the program, so that 0 means "as programmed": with HOLDON="0" in the RSI configuration the
// controller falls back to its program by itself where an answer does not come.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "adapters/controller_report.hpp"
#include "adapters/correction_follower.hpp"

namespace stillcut {

// A packet of the controller: RIst and IPOC must be there; AIPos, Delay and our own tags Stillcut.Speed (rpm as
// programmed) and Stillcut.Block may be. Others are passed over.
ParsedReport parse_rsi(std::span<const std::uint8_t> packet);

// The answer to it.
std::string build_rsi(std::int64_t ipoc, const Setpoint& setpoint);

// The other side, for the simulated controller: its packet, and what it reads from an answer.
struct RsiRequest {
  double feed_percent = 0.0, spindle_rpm = 0.0;  // against the program
  bool stop = false;
  std::int64_t ipoc = 0;
};
std::string build_rsi_report(const ControllerReport& report, const std::array<double, 3>& angles_deg);
std::optional<RsiRequest> parse_rsi_answer(std::string_view answer);

// What RSI cannot do, by correction kind.
std::array<const char*, 6> rsi_refusals();

}  // namespace stillcut
