// Roughness of a simulated cut's surface as `hil` and `simulate` tell it.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "models/surface_roughness.hpp"

namespace stillcut {

// In micrometres; null where nothing was cut that has one.
inline nlohmann::ordered_json um_json(const std::optional<ProfileRoughness>& roughness,
                                      double ProfileRoughness::*figure) {
  return roughness ? nlohmann::ordered_json(1e6 * (*roughness).*figure) : nlohmann::ordered_json(nullptr);
}

}  // namespace stillcut
