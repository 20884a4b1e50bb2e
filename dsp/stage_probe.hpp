// Tells an onlooker which part of the work begins, so that the loop can learn where its time goes. The core holds no
// clock: without an onlooker this does nothing, and with one it changes no decision.
#pragma once

#include <cstdint>

namespace stillcut {

// From the socket to the channels, in the order of the work. A stage lasts until another begins.
enum class Stage : std::uint8_t {
  receive,    // frames out of the bus
  decode,     // signals out of frames
  filter,     // angle, integrity, what repeats with the spindle taken out, thinning out
  transform,  // spectrum of a hop and what stands out of its floor
  decide,     // monitor, compensator, trajectories
  hand_over   // into the rings to the ordinary threads
};
inline constexpr int kStages = 6;

struct StageProbe {
  void (*begins)(void* onlooker, Stage stage) noexcept = nullptr;
  void* onlooker = nullptr;

  void operator()(Stage stage) const noexcept {
    if (begins != nullptr) begins(onlooker, stage);
  }
};

}  // namespace stillcut
