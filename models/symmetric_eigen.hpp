// Eigenvalues of a symmetric matrix the size of an arm: its natural frequencies, and how near it is to a posture in
// which it cannot move some way.
#pragma once

#include "models/arm.hpp"

namespace stillcut {

struct SymmetricEigen {
  JointVector values;   // rising
  JointMatrix vectors;  // columns of length 1, as the values
};

// Jacobi's method: for so few rows as fast as any other, and accurate to the last digits. `matrix`: symmetric, up to
// kMostJoints rows; where it is not finite, so are the values.
SymmetricEigen symmetric_eigen(JointMatrix matrix);

}  // namespace stillcut
