// The tooth period divided at every entry and exit: between two breakpoints the same teeth cut and the cutting
// stiffness is smooth in the angle.
#pragma once

#include <vector>

#include "models/linear_cut.hpp"

namespace stillcut {

struct CuttingPiece {
  double from = 0.0, to = 0.0;      // angle of the spindle since the period began, rad
  std::vector<double> tooth_angle;  // of each cutting tooth's tip at `from`, measured on from its own entry angle
};

// Pieces that fill one tooth period (2 pi / teeth), beginning where a tooth enters; a piece without teeth is free
// flight. lag: how far the top of the edge trails its tip, rad (0 for straight teeth).
std::vector<CuttingPiece> cutting_pieces(const LinearCut& cut, double lag);

// Sum over the cutting teeth, averaged over the edge, of cutting stiffness W (Pa) and of the flank's radial projection
// R.
struct CuttingMatrices {
  DirectionMatrix stiffness = DirectionMatrix::Zero();
  DirectionMatrix radial = DirectionMatrix::Zero();
};
CuttingMatrices cutting_matrices(const LinearCut& cut, const CuttingPiece& piece, double angle, double lag);

}  // namespace stillcut
