// What is fitted to frequency responses: modes with a direction each and terms for what lies outside the band, and how
// well it goes with what was measured.
//
//     H_ij(w) = sum_r a_ri a_rj g_r(w) - inertia_ij/w^2 + compliance_ij,   g_r = 1/(1 - (w/w_r)^2 + 2 i zeta_r w/w_r),
//
// a_r = u_r/sqrt(k_r): one vector for all entries, so that reciprocity and a positive stiffness are built in.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "models/frf_lines.hpp"

namespace stillcut {

struct Pole {
  double natural_frequency = 0.0;  // rad/s
  double damping_ratio = 0.0;
};

struct ModalTerm {
  Pole pole;
  Eigen::Vector3d root = Eigen::Vector3d::Zero();  // a, sqrt(m/N)
};

struct ModalModel {
  std::vector<ModalTerm> terms;
  bool has_inertia = false, has_compliance = false;                           // whether the residual terms are fitted
  Eigen::Matrix<double, 6, 1> inertia = Eigen::Matrix<double, 6, 1>::Zero();  // 1/kg, by symmetric_place()
  Eigen::Matrix<double, 6, 1> compliance = Eigen::Matrix<double, 6, 1>::Zero();  // m/N
};

// Parameters in their order: of each term ln w, ln zeta and a; inertia; compliance (where fitted).
inline constexpr Eigen::Index kTermParameters = 5;
[[nodiscard]] Eigen::Index parameter_count(const ModalModel& model);

[[nodiscard]] Eigen::VectorXcd pole_response(const Pole& pole, const Eigen::VectorXd& omega);
[[nodiscard]] Eigen::VectorXcd model_values(const ModalModel& model, const Eigen::VectorXd& omega, int i, int j);

// What is left of every entry: measured less fitted.
[[nodiscard]] std::vector<Eigen::VectorXcd> left_over(const ModalModel& model, const FrfLines& lines);

// Sum of |left over|^2 times weight.
[[nodiscard]] double chi_square(const ModalModel& model, const FrfLines& lines, const FrfWeights& weights);

struct NormalEquations {
  Eigen::MatrixXd information;  // J^T W J: half the second derivative of chi_square()
  Eigen::VectorXd gradient;     // J^T W (measured - fitted): the way down
  double chi_square = 0.0;
};
[[nodiscard]] NormalEquations normal_equations(const ModalModel& model, const FrfLines& lines,
                                               const FrfWeights& weights);

// After a step of the parameters; logarithms move by 0.3 at most at a time.
[[nodiscard]] ModalModel moved(ModalModel model, const Eigen::VectorXd& step);

}  // namespace stillcut
