// Which side of the tool meets the part; the numbers are those of robot_state_t.
#pragma once

#include <cstdint>

namespace stillcut {

enum class Milling : std::int8_t { unknown = 0, down = 1, up = 2, slot = 3 };

// Of the way back: down and up change places, the others stay.
constexpr Milling opposite(Milling milling) {
  if (milling == Milling::down) return Milling::up;
  return milling == Milling::up ? Milling::down : milling;
}

}  // namespace stillcut
