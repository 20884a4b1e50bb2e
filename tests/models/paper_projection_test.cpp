#include "models/paper_projection.hpp"

#include <gtest/gtest.h>

#include "stability_cases.hpp"

namespace stillcut {
namespace {

constexpr double kRightAngle = 0.5 * std::numbers::pi;

Eigen::Matrix3cd by_tensor(const std::vector<Mode>& modes, double feed_direction, double frequency) {
  return receptance(modes_in_feed_frame(modes, feed_direction), frequency);
}

double distance(std::complex<double> a, std::complex<double> b) { return std::abs(a - b) / std::abs(b); }

TEST(PaperProjection, AgreesWithTheTensorAlongX) {
  const auto modes = test::robot_modes();
  for (const double hz : {0.0, 20.0, 55.0, 300.0, 510.0}) {
    const Eigen::Matrix3cd tensor = by_tensor(modes, 0.0, kTwoPi * hz);
    const PaperReceptance paper = paper_projection(receptance(modes, kTwoPi * hz), 0.0);
    EXPECT_LT(distance(paper.feed, tensor(0, 0)), 1e-12);
    EXPECT_LT(distance(paper.cross_feed, tensor(1, 1)), 1e-12);
  }
}

TEST(PaperProjection, MakesANegativeReceptanceWhereTheFeedIsAlongY) {
  const auto modes = test::robot_modes();
  for (const double hz : {0.0, 20.0, 55.0, 300.0, 510.0}) {
    const Eigen::Matrix3cd workpiece = receptance(modes, kTwoPi * hz);
    const Eigen::Matrix3cd tensor = by_tensor(modes, kRightAngle, kTwoPi * hz);
    const PaperReceptance paper = paper_projection(workpiece, kRightAngle);
    // By the tensor the feed sees G_yy and the cross-feed G_xx; the paper's rule has the latter's sign turned.
    EXPECT_LT(distance(tensor(0, 0), workpiece(1, 1)), 1e-12);
    EXPECT_LT(distance(tensor(1, 1), workpiece(0, 0)), 1e-12);
    EXPECT_LT(distance(paper.feed, workpiece(1, 1)), 1e-12);
    EXPECT_LT(distance(paper.cross_feed, -workpiece(0, 0)), 1e-12);
  }
}

TEST(PaperProjection, AStructureAlikeInAllDirectionsChangesWithTheFeed) {
  // It should not: such a structure looks the same from everywhere.
  const std::vector<Mode> modes{test::mode_of(55, 0.04, 3e6, 1, 0), test::mode_of(55, 0.04, 3e6, 0, 1)};
  const Eigen::Matrix3cd workpiece = receptance(modes, kTwoPi * 50.0);
  for (const double direction : {0.3, 0.5 * kRightAngle, 2.0}) {
    EXPECT_LT(distance(by_tensor(modes, direction, kTwoPi * 50.0)(0, 0), workpiece(0, 0)), 1e-12);
    EXPECT_LT(distance(paper_projection(workpiece, direction).feed,
                       workpiece(0, 0) * (std::cos(direction) + std::sin(direction))),
              1e-12);
  }
}

}  // namespace
}  // namespace stillcut
