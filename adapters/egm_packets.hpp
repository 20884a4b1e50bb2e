// The packets of ABB's Externally Guided Motion (EGM): protobuf over UDP, one from the controller every 4 ms, one
// answer to each. Two kinds of answer, as the controller's program has set EGM up:
//
// - data: values for the RAPID program (RobotWare with EGM RAPID data), which sets speed and spindle by them. Numbers
// in
//   order: feed change in per cent, spindle change in rpm, against the program, so that 0 means "as programmed"; the
//   digital value asks for a stop.
// - path: path correction, the path moved aside within the limits of EGMMoveL; it carries no speeds.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "adapters/controller_report.hpp"
#include "adapters/packet_adapter.hpp"
#include "adapters/simulated_program.hpp"

namespace stillcut {

enum class EgmAnswer { data, path };

// A packet of the controller: header and feedback pose must be there; the first number from RAPID is the programmed
// spindle speed in rpm, the second the block, where it sends any.
ParsedReport parse_egm(std::span<const std::uint8_t> packet);
std::string build_egm(EgmAnswer kind, const Setpoint& setpoint, const AnswerHead& head);
PacketProtocol egm_protocol(EgmAnswer kind);

// What EGM cannot do with this kind of answer, by correction kind.
std::array<const char*, 6> egm_refusals(EgmAnswer kind);

// The other side, for the simulated controller: its packet, and what it reads from an answer. Nothing: no such answer.
std::string build_egm_report(const ControllerReport& report);
std::optional<MachineInputs> parse_egm_answer(EgmAnswer kind, std::string_view answer);

}  // namespace stillcut
