// Modes that change over a workspace by a rule of their own, so that which is which is known at every posture.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "models/dynamics_map.hpp"
#include "models/machining.hpp"

namespace stillcut::test {

// log frequency = base + slope . place + place . bend place; direction turns as start + turn place, places in m from -1
// to 1.
struct MovingMode {
  double base;  // log of rad/s
  Eigen::Vector2d slope;
  Eigen::Matrix2d bend;
  Eigen::Vector3d start;
  Eigen::Matrix<double, 3, 2> turn;

  Mode at(const Eigen::Vector2d& place) const {
    Mode mode{std::exp(base + slope.dot(place) + place.dot(bend * place)), 0.03, 2e6, {}};
    const Eigen::Vector3d u = (start + turn * place).normalized();
    mode.direction = {u.x(), u.y(), u.z()};
    return mode;
  }
};

// `apart`: octaves between one mode and the next in the middle of the workspace; `slope`: octaves from its middle to
// its edge, at most along each axis. Directions turn by up to 20 degrees or so.
inline std::vector<MovingMode> moving_modes(int count, double apart, double slope, std::mt19937_64& random) {
  std::uniform_real_distribution<> unit(-1.0, 1.0);
  std::normal_distribution<> normal;
  const auto any = [&] { return slope * std::log(2.0) * unit(random); };
  std::vector<MovingMode> modes;
  for (int m = 0; m < count; ++m) {
    MovingMode& mode = modes.emplace_back();
    mode.base = std::log(kTwoPi * 20.0) + m * apart * std::log(2.0);
    mode.slope = {any(), any()};
    const double cross = 0.15 * any();
    mode.bend << 0.3 * any(), cross, cross, 0.3 * any();
    mode.start = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
    for (int i = 0; i < 6; ++i) mode.turn(i / 2, i % 2) = 0.2 * normal(random);
  }
  return modes;
}

struct KnownMap {
  DynamicsMap map;
  std::vector<std::vector<int>> mode;  // [posture][mode]: which of the moving ones; -1 - posture: none, a false one
};

struct TapErrors {
  double frequency = 0.0, direction = 0.0;  // relative; rad, roughly
  double missed = 0.0, added = 0.0;         // chance of a mode to be missed, of a posture to have a false one
};

inline KnownMap tapped_map(const std::vector<MovingMode>& modes, const std::vector<Eigen::Vector2d>& places,
                           const TapErrors& errors, std::mt19937_64& random) {
  std::uniform_real_distribution<> share(0.0, 1.0);
  std::normal_distribution<> normal;
  KnownMap known;
  for (std::size_t p = 0; p < places.size(); ++p) {
    std::vector<std::pair<Mode, int>> found;
    for (std::size_t m = 0; m < modes.size(); ++m) {
      if (share(random) < errors.missed) continue;
      Mode mode = modes[m].at(places[p]);
      mode.natural_frequency *= std::exp(errors.frequency * normal(random));
      Eigen::Vector3d u(mode.direction.data());
      u += errors.direction * Eigen::Vector3d(normal(random), normal(random), normal(random));
      u *= (random() % 2 == 0 ? 1.0 : -1.0) / u.norm();  // its sign says nothing
      mode.direction = {u.x(), u.y(), u.z()};
      found.emplace_back(mode, static_cast<int>(m));
    }
    if (found.empty() || share(random) < errors.added) {
      Mode mode = modes[random() % modes.size()].at(places[p]);
      mode.natural_frequency *= 1.3;
      const Eigen::Vector3d u = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
      mode.direction = {u.x(), u.y(), u.z()};
      found.emplace_back(mode, -1 - static_cast<int>(p));
    }
    std::sort(found.begin(), found.end(),
              [](const auto& a, const auto& b) { return a.first.natural_frequency < b.first.natural_frequency; });
    Posture& posture = known.map.postures.emplace_back();
    posture.id = std::to_string(p + 1);
    posture.position = {places[p].x(), places[p].y(), 0.0};
    std::vector<int>& which = known.mode.emplace_back();
    for (const auto& [mode, number] : found) {
      posture.modes.push_back(mode);
      which.push_back(number);
    }
  }
  return known;
}

inline std::vector<Eigen::Vector2d> random_places(std::size_t count, std::mt19937_64& random) {
  std::uniform_real_distribution<> unit(-1.0, 1.0);
  std::vector<Eigen::Vector2d> places;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = unit(random), y = unit(random);
    places.emplace_back(x, y);
  }
  return places;
}

inline std::vector<Eigen::Vector2d> grid_places(int along) {
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i < along; ++i)
    for (int j = 0; j < along; ++j) places.emplace_back(-1.0 + 2.0 * i / (along - 1), -1.0 + 2.0 * j / (along - 1));
  return places;
}

}  // namespace stillcut::test
