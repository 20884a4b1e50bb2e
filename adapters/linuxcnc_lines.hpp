// The line protocol of linuxcncrsh, the network interface of LinuxCNC: what its replies say.
//
// A command a line; GET X is answered by "X values", SET X by "SET X ACK" (in verbose mode), both by "... NAK", or by
// "error: ..." of newer versions, where they are refused. Lines end in \r\n or \n\r. Overrides are set in whole per
// cent.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

namespace stillcut {

enum class CncReply { none, done, refused };  // none: no reply to this command (an echo, a message)

// Whether `line` answers `command`.
CncReply reply_to(std::string_view command, std::string_view line);

// The values after the first word, parted by blanks; at most 64.
std::vector<std::string_view> values_of(std::string_view line);
std::optional<double> cnc_number(std::string_view text);

// Position or joint values: the first six; fewer are left 0. Nothing where one is no number, or there is none.
std::optional<std::array<double, 6>> cnc_places(std::string_view line);

// The programmed spindle speed among the active codes: "... G17 F1500 S8500".
std::optional<double> programmed_speed_rpm(std::string_view line);

}  // namespace stillcut
