#include "models/modal_structure.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "models/machining.hpp"

namespace stillcut {
namespace {

Mode oscillator(double frequency_hz, double damping_ratio, double stiffness, std::array<double, 3> direction) {
  return {kTwoPi * frequency_hz, damping_ratio, stiffness, direction};
}

TEST(ModalStructure, KeepsItsEnergyWithoutDamping) {
  const std::vector<Mode> modes{oscillator(12, 0.0, 1e6, {1, 0.2, 0}), oscillator(700, 0.0, 2e7, {0, 1, 0.5}),
                                oscillator(1900, 0.0, 5e7, {0.1, 0, 1})};
  ModalStructure structure(modes, 1.0 / 60e3);
  structure.strike({0.3, 0.2, -0.1});
  const double before = structure.energy();
  for (int i = 0; i < 600000; ++i) structure.advance(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  EXPECT_NEAR(structure.energy(), before, 1e-8 * before);
}

TEST(ModalStructure, GivenOtherModesMovesOnFromWhereItIs) {
  const std::vector<Mode> modes{oscillator(12, 0.02, 1e6, {1, 0, 0}), oscillator(700, 0.03, 2e7, {0, 1, 0})};
  ModalStructure structure(modes, 1e-4);
  structure.strike({0.3, 0.2, 0});
  for (int i = 0; i < 100; ++i) structure.advance({10, 0, 0}, {10, 0, 0});
  const Eigen::Vector3d displacement = structure.displacement(), velocity = structure.velocity();
  structure.set_modes(std::vector<Mode>{oscillator(14, 0.02, 1.1e6, {1, 0, 0}), oscillator(690, 0.03, 2e7, {0, 1, 0})});
  EXPECT_EQ(structure.displacement(), displacement);
  EXPECT_EQ(structure.velocity(), velocity);
  for (int i = 0; i < 200000; ++i) structure.advance({0, 0, 0}, {11, 0, 0});
  for (int i = 0; i < 200000; ++i) structure.advance({11, 0, 0}, {11, 0, 0});
  EXPECT_NEAR(structure.displacement().x(), 11 / 1.1e6, 1e-9 * 11 / 1.1e6);
  EXPECT_THROW(structure.set_modes(std::vector<Mode>{modes[0]}), std::invalid_argument);
}

TEST(ModalStructure, FollowsTheClosedFormOfADampedRampResponse) {
  const double w = kTwoPi * 50, zeta = 0.1, k = 2e6, slope = 1e4;  // N/s from zero
  const std::vector<Mode> modes{oscillator(50, zeta, k, {0, 1, 0})};
  const double step = 1e-3;
  ModalStructure structure(modes, step);
  const double wd = w * std::sqrt(1 - zeta * zeta);
  for (int i = 0; i < 100; ++i) {
    structure.advance({0, slope * i * step, 0}, {0, slope * (i + 1) * step, 0});
    const double t = (i + 1) * step;
    const double expected =
        slope / k *
        (t - 2 * zeta / w +
         std::exp(-zeta * w * t) * (2 * zeta / w * std::cos(wd * t) + (2 * zeta * zeta - 1) / wd * std::sin(wd * t)));
    ASSERT_NEAR(structure.displacement().y(), expected, 1e-12 * slope / k) << t;
  }
}

}  // namespace
}  // namespace stillcut
