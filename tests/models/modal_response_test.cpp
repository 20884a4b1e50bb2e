#include "models/modal_response.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "stability_cases.hpp"

namespace stillcut {
namespace {

// From rest under a unit force: q = (1 - free decay from q = 1)/k, q'/w its rate.
TEST(ModalResponse, ToAConstantForceIsTheStepResponse) {
  const Oscillator mode(test::mode_of(120, 0.04, 5e6, 1, 0));
  const ForcedStretch& stretch = forced_stretch(14);
  const double duration = 0.011;
  ModalResponse response;
  stretch.respond(mode, duration, true, response);
  for (int i = 0; i < stretch.size(); ++i) {
    const Eigen::Matrix2d free = mode.transition(duration * stretch.nodes()[i]);
    EXPECT_NEAR(response.forced.row(i).sum(), (1.0 - free(0, 0)) / 5e6, 1e-12 / 5e6);
    EXPECT_NEAR(response.forced_rate.row(i).sum(), -free(1, 0) / 5e6, 1e-12 / 5e6);
    EXPECT_NEAR(response.free(0, i), free(0, 0), 1e-13);
    EXPECT_NEAR(response.free(1, i), free(0, 1), 1e-13);
    EXPECT_NEAR(response.free_rate(0, i), free(1, 0), 1e-13);
    EXPECT_NEAR(response.free_rate(1, i), free(1, 1), 1e-13);
  }
  EXPECT_NEAR(response.forced_end.row(0).sum(), (1.0 - response.free_end(0, 0)) / 5e6, 1e-12 / 5e6);
  EXPECT_NEAR(response.forced_end.row(1).sum(), -response.free_end(1, 0) / 5e6, 1e-12 / 5e6);
}

// A force that is a polynomial of the nodes' degree is answered exactly: compared with many short steps.
TEST(ModalResponse, ToAPolynomialForceIsExactForAnyModeAndDuration) {
  std::mt19937_64 random(4);
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  for (int i = 0; i < 60; ++i) {
    const Oscillator mode(test::mode_of(uniform(5, 3000), uniform(0.001, 0.4), uniform(1e5, 1e8), 1, 0));
    const int nodes = 6 + i % 12;
    const double duration = uniform(0.01, 1.5) * kTwoPi / mode.frequency;
    const auto force = [&](double share) { return std::pow(share, 3) - 0.4 * share + 0.1; };
    ModalResponse response;
    forced_stretch(nodes).respond(mode, duration, false, response);
    Eigen::VectorXd at_nodes(nodes);
    for (int k = 0; k < nodes; ++k) at_nodes[k] = force(forced_stretch(nodes).nodes()[k]);
    const Eigen::Vector2d end = response.forced_end * at_nodes;
    Eigen::Vector2d expected(0.0, 0.0);
    const GaussLegendre fine = gauss_legendre(60);
    for (int k = 0; k < 60; ++k) {
      expected += duration * fine.weights[k] * force(fine.nodes[k]) * mode.impulse(duration * (1.0 - fine.nodes[k]));
    }
    // With few nodes the rule itself, not the force, limits: 6 nodes integrate a product up to degree 11.
    EXPECT_LT((end - expected).norm(), (nodes < 9 ? 1e-4 : 1e-8) * expected.norm()) << nodes << " nodes";
  }
}

TEST(ModalResponse, BetweenTheNodesAgreesWithTheNodes) {
  const Oscillator mode(test::mode_of(430, 0.02, 8e6, 0, 1));
  const ForcedStretch& stretch = forced_stretch(9);
  const double duration = 0.0021;
  ModalResponse response;
  stretch.respond(mode, duration, false, response);
  for (int i = 0; i < stretch.size(); ++i) {
    const Eigen::RowVectorXd at = stretch.displacement_at(mode, duration, duration * stretch.nodes()[i]);
    EXPECT_NEAR((at.tail(9) - response.forced.row(i)).norm(), 0.0, 1e-12 * response.forced.norm());
    EXPECT_NEAR(at[0], response.free(0, i), 1e-13);
    EXPECT_NEAR(at[1], response.free(1, i), 1e-13);
  }
}

TEST(ModalResponse, TablesAreMadeOnceAndRefuseNoNodes) {
  EXPECT_EQ(&forced_stretch(11), &forced_stretch(11));
  EXPECT_THROW(forced_stretch(0), std::invalid_argument);
  EXPECT_THROW(forced_stretch(129), std::invalid_argument);
}

}  // namespace
}  // namespace stillcut
