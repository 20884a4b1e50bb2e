// The feed-direction paper's way to turn a receptance into the feed frame (Tunc and Stoddart 2017, eq. 1), kept under
// its own name to reproduce that paper's figures and for nothing else. It projects the two direct responses as if they
// were the components of a vector, so that at a feed of 90 degrees the cross-feed receptance comes out as -G_xx: a
// structure that moves against the force. Everything else in Stillcut turns the tensor (models/receptance.hpp).
#pragma once

#include <Eigen/Core>
#include <complex>

namespace stillcut {

struct PaperReceptance {
  std::complex<double> feed, cross_feed;  // m/N; the paper has no cross responses
};

// G_f = G_xx cos + G_yy sin, G_cf = -G_xx sin + G_yy cos, of a receptance in workpiece axes and a feed direction in rad
// from +X toward +Y.
PaperReceptance paper_projection(const Eigen::Matrix3cd& workpiece_receptance, double feed_direction);

// The same as the 2 x 2 matrix that zeroth order asks for (models/zeroth_order.hpp).
Eigen::Matrix2cd paper_feed_plane(const Eigen::Matrix3cd& workpiece_receptance, double feed_direction);

}  // namespace stillcut
