#include "drivers/files/measured_units.hpp"

#include <array>
#include <utility>

namespace stillcut {
namespace {

struct NamedMotion {
  std::string_view name;
  MotionUnit unit;
};
constexpr auto kPerS = ResponseKind::mobility, kPerS2 = ResponseKind::accelerance;
// Signs beyond ASCII as UTF-8 and as Latin-1 has them.
constexpr std::array kMotionUnits{NamedMotion{"m", {1.0}},
                                  NamedMotion{"mm", {1e-3}},
                                  NamedMotion{"um", {1e-6}},
                                  NamedMotion{"\xC2\xB5m", {1e-6}},
                                  NamedMotion{"\xCE\xBCm", {1e-6}},
                                  NamedMotion{"\xB5m", {1e-6}},
                                  NamedMotion{"in", {0.0254}},
                                  NamedMotion{"m/s", {1.0, kPerS}},
                                  NamedMotion{"mm/s", {1e-3, kPerS}},
                                  NamedMotion{"in/s", {0.0254, kPerS}},
                                  NamedMotion{"m/s^2", {1.0, kPerS2}},
                                  NamedMotion{"m/s2", {1.0, kPerS2}},
                                  NamedMotion{"m/s**2", {1.0, kPerS2}},
                                  NamedMotion{"m/s\xC2\xB2", {1.0, kPerS2}},
                                  NamedMotion{"m/s\xB2", {1.0, kPerS2}},
                                  NamedMotion{"mm/s^2", {1e-3, kPerS2}},
                                  NamedMotion{"mm/s2", {1e-3, kPerS2}},
                                  NamedMotion{"in/s^2", {0.0254, kPerS2}},
                                  NamedMotion{"g", {9.80665, kPerS2}},
                                  NamedMotion{"G", {9.80665, kPerS2}}};

constexpr std::array<std::pair<std::string_view, double>, 4> kForceUnits{
    {{"N", 1.0}, {"mN", 1e-3}, {"kN", 1e3}, {"lbf", 4.4482216152605}}};

}  // namespace

std::optional<double> force_unit(std::string_view name) {
  for (const auto& [unit, si] : kForceUnits)
    if (name == unit) return si;
  return {};
}

std::optional<MotionUnit> motion_unit(std::string_view name) {
  for (const NamedMotion& motion : kMotionUnits)
    if (name == motion.name) return motion.unit;
  return {};
}

std::optional<double> acceleration_unit(std::string_view name) {
  const std::optional<MotionUnit> unit = motion_unit(name);
  if (!unit || unit->kind != ResponseKind::accelerance) return {};
  return unit->si;
}

}  // namespace stillcut
