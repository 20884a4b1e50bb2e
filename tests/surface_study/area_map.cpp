#include "tests/surface_study/area_map.hpp"

#include "models/interpolation.hpp"

namespace stillcut::surface_study {

std::array<double, 3> area_place(std::size_t area) {
  constexpr double kStrip = 80e-3 / 9.0, kQuarter = 25e-3;
  const auto& published = kPublished.at(area);
  return {kQuarter * static_cast<double>(1 + area % 3), kStrip * (published.of_case - 0.5), 0.0};
}

std::vector<Mode> modes_of(const AreaModes& modes, double stiffness) {
  const double w = kTwoPi * modes.frequency_hz;
  return {{w, modes.damping_ratio, stiffness, {1, 0, 0}},
          {w, modes.damping_ratio, stiffness, {0, 1, 0}},
          {w, modes.damping_ratio, stiffness, {0, 0, 1}}};
}

DynamicsMap area_map(const AreaModes& modes, const std::array<double, kAreas>& stiffness,
                     std::optional<std::size_t> left_out) {
  DynamicsMap map;
  for (std::size_t area = 0; area < kAreas; ++area) {
    if (left_out == area) continue;
    Posture posture;
    posture.id = kPublished.at(area).name;
    posture.position = area_place(area);
    posture.modes = modes_of(modes, stiffness.at(area));
    map.postures.push_back(std::move(posture));
  }
  return map;
}

std::vector<Mode> predicted_modes(const DynamicsMap& map, std::size_t area) {
  Posture at;
  at.position = area_place(area);
  return predict_posture(map, at, {}).posture.modes;
}

}  // namespace stillcut::surface_study
