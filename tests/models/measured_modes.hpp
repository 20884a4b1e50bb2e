// Frequency responses of structures whose modes are known, with noise, and the least errors that anybody could have.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "models/likelihood_fit.hpp"
#include "models/machining.hpp"
#include "models/modal_identification.hpp"

namespace stillcut {

enum class NoiseKind { even, relative, of_acceleration };

struct MeasuringPlan {
  NoiseKind noise = NoiseKind::even;
  double signal_to_noise_db = 60.0;  // root mean square of each entry over that of its noise
  int force_axes = 3;                // x; x and y; all
  double spacing_hz = 0.25;
  int lines = 8192;
};

struct MeasuredStructure {
  std::vector<Mode> modes;
  FrequencyResponse response;
  FrfLines lines;
  FrfWeights weights;  // of the noise that was added
};

inline ModalModel model_of(const std::vector<Mode>& modes) {
  ModalModel model;
  for (const Mode& mode : modes)
    model.terms.push_back({{mode.natural_frequency, mode.damping_ratio},
                           Eigen::Vector3d(mode.direction.data()) / std::sqrt(mode.stiffness)});
  return model;
}

inline MeasuredStructure measured(const std::vector<Mode>& modes, const MeasuringPlan& plan, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  MeasuredStructure result{modes, {}, {}, {}};
  for (int k = 1; k <= plan.lines; ++k) result.response.frequencies_hz.push_back(k * plan.spacing_hz);
  Eigen::VectorXd omega(plan.lines);
  for (Eigen::Index n = 0; n < omega.size(); ++n) omega[n] = kTwoPi * static_cast<double>(n + 1) * plan.spacing_hz;
  const ModalModel truth = model_of(modes);
  const double share = std::pow(10.0, -plan.signal_to_noise_db / 20.0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < plan.force_axes; ++j) {
      const Eigen::VectorXcd h = model_values(truth, omega, i, j);
      Eigen::VectorXd level = Eigen::VectorXd::Constant(plan.lines, std::sqrt(h.cwiseAbs2().mean()));
      if (plan.noise == NoiseKind::relative) level = h.cwiseAbs();
      if (plan.noise == NoiseKind::of_acceleration) {
        const Eigen::VectorXd square = omega.cwiseAbs2();
        level = std::sqrt(h.cwiseAbs2().cwiseProduct(square.cwiseAbs2()).mean()) * square.cwiseInverse();
      }
      ComplexValues& values = result.response.receptance[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
      for (Eigen::Index n = 0; n < omega.size(); ++n)
        values.push_back(h[n] +
                         share * level[n] * std::sqrt(0.5) * std::complex<double>(normal(random), normal(random)));
      result.weights.push_back(2.0 / (share * level).cwiseAbs2().array());
    }
  result.lines = lines_between(result.response, 0.0, kInfinity);
  return result;
}

// 1 to 8 modes, 8 to 2000 Hz, damping 0.5 to 8 %; a third of them with a neighbour 2 % above.
inline std::vector<Mode> random_modes(std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  std::vector<Mode> modes;
  const int count = std::uniform_int_distribution<int>(1, 8)(random);
  bool paired = true;  // the last one has its neighbour
  while (static_cast<int>(modes.size()) < count) {
    Mode mode;
    double hz = 8.0 * std::pow(250.0, uniform(random));
    const bool pair = !paired && uniform(random) < 0.5;
    if (pair) hz = 1.02 * modes.back().natural_frequency / kTwoPi;
    mode.natural_frequency = kTwoPi * hz;
    const bool apart = std::all_of(modes.begin(), modes.end(), [&](const Mode& other) {
      return std::abs(std::log(mode.natural_frequency / other.natural_frequency)) > (pair ? 0.0195 : 0.06);
    });
    if (hz > 2000.0 || !apart) {
      paired = true;
      continue;
    }
    paired = pair;
    mode.damping_ratio = 0.005 * std::pow(16.0, uniform(random));
    mode.stiffness = 1e6 * std::pow(30.0, uniform(random));
    const Eigen::Vector3d u = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
    mode.direction = {u[0], u[1], u[2]};
    modes.push_back(mode);
  }
  sort_modes(modes);
  return modes;
}

// Frequency, damping and stiffness relative, direction in rad.
inline constexpr std::size_t kModeFigures = 4;
using ModeFigures = std::array<double, kModeFigures>;

// The Cramer-Rao bound of what was measured: standard deviations that no unbiased estimate is below.
inline ModeFigures least_errors(const LikelihoodFit& truth, std::size_t mode) {
  const auto p = kTermParameters * static_cast<Eigen::Index>(mode);
  const Eigen::Vector3d a = truth.model.terms[mode].root, u = a.normalized();
  const Eigen::Matrix3d of_root = truth.covariance.block<3, 3>(p + 2, p + 2);
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - u * u.transpose();
  return {std::sqrt(truth.covariance(p, p)), std::sqrt(truth.covariance(p + 1, p + 1)),
          2.0 / a.norm() * std::sqrt(u.dot(of_root * u)), std::sqrt((across * of_root * across).trace()) / a.norm()};
}

inline ModeFigures errors_of(const Mode& found, const Mode& truth) {
  double cosine = 0.0;
  for (std::size_t k = 0; k < 3; ++k) cosine += found.direction[k] * truth.direction[k];
  return {found.natural_frequency / truth.natural_frequency - 1.0, found.damping_ratio / truth.damping_ratio - 1.0,
          found.stiffness / truth.stiffness - 1.0, std::acos(std::min(1.0, std::abs(cosine)))};
}

inline ModeFigures stated_errors(const IdentifiedMode& found) {
  return {found.deviation.natural_frequency / found.mode.natural_frequency,
          found.deviation.damping_ratio / found.mode.damping_ratio, found.deviation.stiffness / found.mode.stiffness,
          found.deviation.direction};
}

}  // namespace stillcut
