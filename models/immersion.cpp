#include "models/immersion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace stillcut {

Immersion immersion(Milling milling, double radial_depth, double diameter) {
  if (!(diameter > 0.0) || !std::isfinite(diameter)) {
    throw std::invalid_argument("diameter: must be positive; give the tool's diameter");
  }
  if (milling == Milling::slot) return {0.0, std::numbers::pi};
  if (!(radial_depth > 0.0 && radial_depth <= diameter)) {
    throw std::invalid_argument("radial depth: must be above zero and at most the tool's diameter");
  }
  const double arc = std::acos(std::clamp(1.0 - 2.0 * radial_depth / diameter, -1.0, 1.0));
  switch (milling) {
    case Milling::up:
      return {0.0, arc};
    case Milling::down:
      return {std::numbers::pi - arc, std::numbers::pi};
    default:
      throw std::invalid_argument("milling: must be down, up or slot");
  }
}

}  // namespace stillcut
