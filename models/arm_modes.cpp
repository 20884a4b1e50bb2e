#include "models/arm_modes.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "models/arm_dynamics.hpp"
#include "models/symmetric_eigen.hpp"

namespace stillcut {
namespace {

constexpr double kWeakestShare = 1e-3;  // of the softest mode's static compliance
constexpr double kLeastReach = 1e-9;  // m per unit of modal motion: rounding of a mode that leaves the tool where it is

// Frequencies squared and shapes with p^T M p = 1, rising.
struct ArmEigen {
  JointVector squares;
  JointMatrix shapes;
};

ArmEigen arm_eigen(const LinearArm& arm) {
  const Eigen::LLT<JointMatrix> cholesky(arm.mass);  // M = L L^T; L^-1 K L^-T has the squares
  if (cholesky.info() != Eigen::Success)
    throw std::invalid_argument("the arm's mass matrix is singular: a joint moves no mass");
  const JointMatrix half = cholesky.matrixL().solve(arm.stiffness);
  const SymmetricEigen eigen = symmetric_eigen(cholesky.matrixL().solve(JointMatrix(half.transpose())));
  if (!eigen.values.allFinite()) throw std::invalid_argument("the arm's mass or stiffness is not finite");
  if (!(eigen.values[0] > 0.0))
    throw std::invalid_argument("the arm's weight is stronger than its springs; check the joints' stiffness");
  return {eigen.values, cholesky.matrixU().solve(eigen.vectors)};
}

void refuse_overdamped(double frequency, double ratio) {
  if (ratio < 1.0) return;
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(),
                "the mode at %.1f Hz is damped beyond critical (ratio %.2f) and does not vibrate; lower the joints' "
                "damping",
                frequency / (2.0 * std::numbers::pi), ratio);
  throw std::invalid_argument(text.data());
}

}  // namespace

LinearArm linear_arm(const Arm& arm, const JointVector& angles) {
  const ArmPose pose = arm_pose(arm, angles);
  const int n = arm.size();
  LinearArm linear{equations_of_motion(arm, pose, JointVector::Zero(n)).mass, JointVector(n),
                   gravity_stiffness(arm, pose), tool_jacobian(arm, pose)};
  for (int i = 0; i < n; ++i) {
    linear.damping[i] = arm.joints[static_cast<std::size_t>(i)].damping;
    linear.stiffness(i, i) += arm.joints[static_cast<std::size_t>(i)].stiffness;
  }
  return linear;
}

Eigen::Matrix3cd arm_receptance(const LinearArm& arm, double frequency) {
  Eigen::MatrixXcd dynamic = (arm.stiffness - frequency * frequency * arm.mass).cast<std::complex<double>>();
  dynamic.diagonal() += std::complex<double>(0.0, frequency) * arm.damping;
  const Eigen::MatrixXcd jacobian = arm.jacobian.cast<std::complex<double>>();
  return jacobian * dynamic.partialPivLu().solve(Eigen::MatrixXcd(jacobian.transpose()));
}

std::vector<ArmMode> arm_modes(const LinearArm& arm) {
  const ArmEigen eigen = arm_eigen(arm);
  std::vector<ArmMode> modes;
  double softest = 0.0;
  for (Eigen::Index r = 0; r < eigen.squares.size(); ++r) {
    ArmMode found;
    found.shape = eigen.shapes.col(r);
    Eigen::Vector3d moves = arm.jacobian * found.shape;
    found.reach = moves.norm();
    if (!(found.reach > kLeastReach)) continue;
    Eigen::Index largest = 0;
    moves.cwiseAbs().maxCoeff(&largest);
    if (moves[largest] < 0.0) {
      moves = -moves;
      found.shape = -found.shape;
    }
    Mode& mode = found.mode;
    mode.natural_frequency = std::sqrt(eigen.squares[r]);
    mode.damping_ratio = found.shape.dot(arm.damping.cwiseProduct(found.shape)) / (2.0 * mode.natural_frequency);
    mode.stiffness = eigen.squares[r] / (found.reach * found.reach);
    for (Eigen::Index i = 0; i < 3; ++i) mode.direction[static_cast<std::size_t>(i)] = moves[i] / found.reach;
    softest = std::max(softest, 1.0 / mode.stiffness);
    modes.push_back(found);
  }
  std::erase_if(modes, [&](const ArmMode& mode) { return 1.0 / mode.mode.stiffness < kWeakestShare * softest; });
  if (modes.empty()) throw std::invalid_argument("no joint moves the tool point; check the tool link");
  for (const ArmMode& mode : modes) refuse_overdamped(mode.mode.natural_frequency, mode.mode.damping_ratio);
  return modes;
}

std::vector<Mode> tool_modes(const LinearArm& arm) {
  std::vector<Mode> modes;
  for (const ArmMode& mode : arm_modes(arm)) modes.push_back(mode.mode);
  return modes;
}

double highest_frequency(const LinearArm& arm) {
  const ArmEigen eigen = arm_eigen(arm);
  return std::sqrt(eigen.squares[eigen.squares.size() - 1]);
}

}  // namespace stillcut
