// Events as people and spreadsheets read them: the CSV of contracts ("Events") and one line for the terminal.
#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <string_view>

#include "dsp/signals.hpp"

namespace stillcut {

std::string_view event_name(EventType type) noexcept;     // "cut_entry", ...
std::string_view kind_name(const Event& event) noexcept;  // empty for events that are not about chatter

// time_s,event,kind,frequency_hz,indicator,spindle_speed_rpm,note
void write_event_header(std::ostream& out);
// origin_ns: stamp of the first frame, time zero. Not applicable is empty.
void write_event(std::ostream& out, const Event& event, std::int64_t origin_ns);

// "  3.712 s  chatter onset  regenerative  746.3 Hz  ..." without line feed.
std::string event_line(const Event& event, std::int64_t origin_ns);

}  // namespace stillcut
