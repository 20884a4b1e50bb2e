// The ways to predict between measured postures (models/interpolation), by the names that users give them.
#pragma once

#include <array>

namespace stillcut {

enum class InterpolationKind { frf, modal, trend };
inline constexpr std::array kInterpolationNames{"frf", "modal", "trend"};  // in the order of the enum

}  // namespace stillcut
