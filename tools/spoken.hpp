// What people call the values of our messages: on the page, in the terminal, in logs and reports.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rt/signals.hpp"

namespace stillcut {

const char* state_name(State state) noexcept;               // "cannot tell"
const char* mode_name(RuntimeMode mode) noexcept;           // "shadow"
const char* correction_name(CorrectionKind kind) noexcept;  // "spindle speed variation"
const char* chatter_name(ChatterKind kind) noexcept;        // "regenerative"

// "speed range", "path", ... of Correction::limited_by.
std::vector<std::string> limits_reached(std::int32_t limited_by);
// "accelerometer saturated", ... of the bits of MonitorView::doubts.
std::vector<std::string> doubt_names(std::uint32_t doubts);

}  // namespace stillcut
