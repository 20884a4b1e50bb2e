// Which side of the tool meets the part; the numbers are those of robot_state_t.
#pragma once

#include <cstdint>

namespace stillcut {

enum class Milling : std::int8_t { unknown = 0, down = 1, up = 2, slot = 3 };

}  // namespace stillcut
