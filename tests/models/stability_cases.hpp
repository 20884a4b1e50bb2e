// Cuts that several stability tests share: those of tests/data/stability, and random ones from a seed.
#pragma once

#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "models/leading_multiplier.hpp"
#include "models/linear_cut.hpp"
#include "models/machining.hpp"
#include "models/receptance.hpp"

namespace stillcut::test {

inline std::vector<std::vector<std::string>> read_table(const std::string& name) {
  std::ifstream file(std::string(TEST_DATA "/stability/") + name);
  std::vector<std::vector<std::string>> rows;
  std::string line;
  std::getline(file, line);  // header
  while (std::getline(file, line)) {
    std::stringstream fields(line);
    rows.emplace_back();
    for (std::string field; std::getline(fields, field, ',');) rows.back().push_back(field);
  }
  return rows;
}

// A robot's cut as a cell describes it: two teeth, half immersion down-milling, 2800-3800 rpm, and its modes.
struct RobotCell {
  Tool tool;
  Material material;
  Cut cut;
  SpindleLimits spindle{rpm_to_rad_s(2800), rpm_to_rad_s(3800), 200, 2000};

  RobotCell() {
    tool.teeth = 2;
    tool.diameter = 0.025;
    material.ktc = 8e8;
    material.krc = 3e8;
    cut.milling = Milling::down;
    cut.radial_depth = 0.0125;
  }
};

// The period operator of a cut written out as a matrix, column by column.
inline Eigen::MatrixXd written_out(const LinearMap& map) {
  Eigen::MatrixXd matrix(map.size(), map.size());
  for (int i = 0; i < map.size(); ++i) {
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(map.size(), i);
    map.apply(unit.data(), matrix.col(i).data());
  }
  return matrix;
}

struct StabilityCase {
  LinearCut cut;
  std::vector<Mode> modes;  // feed frame
};

inline Mode mode_of(double frequency_hz, double damping, double stiffness, double ux, double uy, double uz = 0.0) {
  return {kTwoPi * frequency_hz, damping, stiffness, {ux, uy, uz}};
}

inline LinearCut cut_of(int teeth, Milling milling, double immersion_ratio, double ktc, double krc) {
  Tool tool;
  tool.teeth = teeth;
  tool.diameter = 0.025;
  Material material;
  material.ktc = ktc;
  material.krc = krc;
  Cut cut;
  cut.milling = milling;
  cut.radial_depth = immersion_ratio * tool.diameter;
  return linear_cut(tool, material, cut);
}

inline std::vector<Mode> robot_modes() {
  return {mode_of(55, 0.04, 3e6, 1, 0), mode_of(500, 0.03, 2e7, 1, 0), mode_of(125, 0.035, 6e6, 0, 1),
          mode_of(520, 0.03, 1.8e7, 0, 1)};
}

// "a", "b" or "c_feedN" of spectral_radius.csv.
inline StabilityCase reference_case(const std::string& name, double immersion_ratio, Milling milling) {
  if (name.starts_with("c_feed")) {
    return {cut_of(2, milling, immersion_ratio, 8e8, 3e8),
            modes_in_feed_frame(robot_modes(), deg_to_rad(std::stod(name.substr(6))))};
  }
  const double frequency = kTwoPi * 922.0, stiffness = 0.03993 * frequency * frequency;
  std::vector<Mode> modes{mode_of(922, 0.011, stiffness, 1, 0)};
  if (name == "b") modes.push_back(mode_of(922, 0.011, stiffness, 0, 1));
  return {cut_of(2, milling, immersion_ratio, 6e8, 2e8), modes};
}

// One to four teeth, any immersion and direction, one to three modes between 40 and 900 Hz.
inline StabilityCase random_case(std::mt19937_64& random) {
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  StabilityCase result;
  const auto milling = static_cast<Milling>(std::uniform_int_distribution<int>(1, 3)(random));
  result.cut = cut_of(std::uniform_int_distribution<int>(1, 4)(random), milling, uniform(0.05, 1.0),
                      uniform(5e8, 1.5e9), uniform(1e8, 5e8));
  const int count = std::uniform_int_distribution<int>(1, 3)(random);
  for (int i = 0; i < count; ++i) {
    const double angle = uniform(0.0, kTwoPi);
    result.modes.push_back(mode_of(uniform(40, 900), uniform(0.01, 0.06), uniform(2e6, 3e7), std::cos(angle),
                                   std::sin(angle), uniform(-0.3, 0.3)));
  }
  return result;
}

// As random_case with two to six modes, half of them on a robot's low frequencies, and unequal pitch in whole steps of
// a `steps`th of a turn.
inline StabilityCase random_uneven_case(std::mt19937_64& random, int steps) {
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  StabilityCase result = random_case(random);
  const int teeth = std::uniform_int_distribution<int>(2, 5)(random);
  result.cut.teeth = teeth;
  int left = steps;
  for (int tooth = 0; tooth + 1 < teeth; ++tooth) {
    const int pitch = static_cast<int>(uniform(0.75, 1.25) * steps / teeth);
    result.cut.pitch.push_back(kTwoPi * pitch / steps);
    left -= pitch;
  }
  result.cut.pitch.push_back(kTwoPi * left / steps);
  result.modes.clear();
  const int count = std::uniform_int_distribution<int>(2, 6)(random);
  for (int i = 0; i < count; ++i) {
    const double angle = uniform(0.0, kTwoPi);
    result.modes.push_back(mode_of(i % 2 == 0 ? uniform(8, 120) : uniform(120, 900), uniform(0.01, 0.06),
                                   uniform(2e6, 3e7), std::cos(angle), std::sin(angle), uniform(-0.3, 0.3)));
  }
  return result;
}

}  // namespace stillcut::test
