// The principal period divided at every entry and exit: between two breakpoints the same teeth cut and the cutting
// stiffness is smooth in the angle.
#pragma once

#include <vector>

#include "models/linear_cut.hpp"

namespace stillcut {

struct EngagedTooth {
  int tooth = 0;     // index; teeth of equal pitch all are tooth 0: each does what the one before did
  double tip = 0.0;  // angle of the tooth's tip at the piece's beginning, rad, in the feed frame
};

struct CuttingPiece {
  double from = 0.0, to = 0.0;  // angle of the spindle since the period began, rad
  std::vector<EngagedTooth> teeth;
};

// Pieces that fill the principal period (2 pi / teeth, or 2 pi where the pitch varies), beginning where tooth 0 enters;
// a piece without teeth is free flight. lag: how far the top of the edge trails its tip, rad (0 for straight teeth).
std::vector<CuttingPiece> cutting_pieces(const LinearCut& cut, double lag);

// One tooth's cutting stiffness W and flank projection R (linear_cut.hpp) for its tip at an angle, as a mean over the
// axial depth (m): force = -depth W (q - q_delayed). For straight end mills use cutting_force_direction and chip_normal
// instead: then W = w n^T.
struct CuttingMatrices {
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();  // Pa
  Eigen::Matrix3d radial = Eigen::Matrix3d::Zero();
};
CuttingMatrices cutting_matrices(const LinearCut& cut, double tip, double depth);

}  // namespace stillcut
