#include "tests/surface_study/area_map.hpp"

#include "models/interpolation.hpp"

namespace stillcut::surface_study {

namespace {

constexpr double kStrip = 80e-3 / 9.0, kQuarter = 25e-3;  // m

}  // namespace

std::array<double, 3> area_place(std::size_t area) {
  return {kQuarter * static_cast<double>(1 + area % 3), case_middle(kPublished.at(area).of_case)[1], 0.0};
}

std::array<double, 3> case_middle(int number) { return {2.0 * kQuarter, kStrip * (number - 0.5), 0.0}; }

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

std::vector<Mode> modes_at(const DynamicsMap& map, const std::array<double, 3>& place) {
  Posture at;
  at.position = place;
  return predict_posture(map, at, {}).posture.modes;
}

}  // namespace stillcut::surface_study
