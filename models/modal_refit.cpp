#include "models/modal_refit.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>

#include "models/modal_polish.hpp"
#include "models/mode_pairs.hpp"
#include "models/receptance.hpp"
#include "models/receptance_peaks.hpp"

namespace stillcut {
namespace {

using Complex = std::complex<double>;
using Eigen::Vector3d;

constexpr double kSame = 1e-9;      // relative: two modes no farther apart than this are copies
constexpr double kFitPoints = 2.0;  // to a half-width, for the polish
constexpr std::size_t kMostFitPoints = 1500;

bool copies(const Mode& a, const Mode& b) {
  return std::abs(a.natural_frequency - b.natural_frequency) <= kSame * a.natural_frequency &&
         std::abs(a.damping_ratio - b.damping_ratio) <= kSame * a.damping_ratio &&
         1.0 - std::abs(direction_cosine(a, b)) <= kSame * kSame + 1e-15;
}

std::vector<Mode> without_copies(std::span<const Mode> modes) {
  std::vector<Mode> result;
  for (Mode mode : modes) {
    Eigen::Map<Vector3d>(mode.direction.data()).normalize();
    const auto same =
        std::find_if(result.begin(), result.end(), [&](const Mode& other) { return copies(other, mode); });
    if (same == result.end()) {
      result.push_back(mode);
    } else {
      same->stiffness = 1.0 / (1.0 / same->stiffness + 1.0 / mode.stiffness);
    }
  }
  return result;
}

// Inner product of two modes' impulse responses along one line, in closed form. With poles p = -zeta w + i w_d each is
// h(t) = (w^2/(k w_d)) Im(exp(p t)), and the integral of Im(exp(p t)) Im(exp(q t)) over t > 0 is
// (Re(1/(p + q)) - Re(1/(p + conj q)))/2.
double inner_product(const Mode& a, const Mode& b) {
  const auto pole = [](const Mode& mode) {
    const double w = mode.natural_frequency, zeta = mode.damping_ratio;
    return Complex(-zeta * w, w * std::sqrt(1.0 - zeta * zeta));
  };
  const Complex p = pole(a), q = pole(b);
  const double gain_a = a.natural_frequency * a.natural_frequency / (a.stiffness * p.imag());
  const double gain_b = b.natural_frequency * b.natural_frequency / (b.stiffness * q.imag());
  return gain_a * gain_b * 0.5 * ((1.0 / (p + q)).real() - (1.0 / (p + std::conj(q))).real());
}

// The same for the tensors u u^T h(t), Frobenius.
double tensor_product(const Mode& a, const Mode& b) {
  const double c = direction_cosine(a, b);
  return c * c * inner_product(a, b);
}

// One mode for two: parameters weighted by compliance, the direction in which the two move most, and damping enough to
// cover the gap between their frequencies.
Mode joined(const Mode& a, const Mode& b) {
  const double ca = 1.0 / a.stiffness, cb = 1.0 / b.stiffness, share = ca / (ca + cb);
  const Vector3d ua(a.direction.data()), ub(b.direction.data());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> compliance(ca * ua * ua.transpose() + cb * ub * ub.transpose());
  Mode mode;
  mode.natural_frequency =
      std::exp(share * std::log(a.natural_frequency) + (1.0 - share) * std::log(b.natural_frequency));
  const double gap = std::log(a.natural_frequency / b.natural_frequency);
  const double damping = share * a.damping_ratio + (1.0 - share) * b.damping_ratio;
  mode.damping_ratio = std::min(0.9, std::hypot(damping, std::sqrt(share * (1.0 - share)) * gap));
  mode.stiffness = 1.0 / compliance.eigenvalues()[2];
  Eigen::Map<Vector3d>(mode.direction.data()) = compliance.eigenvectors().col(2);
  return mode;
}

// What joining loses: the energy of the difference in the impulse response beside the response there is at that
// frequency, a decade counting like any other.
double cost_of_joining(const Mode& a, const Mode& b, std::span<const Mode> reference) {
  const Mode both = joined(a, b);
  const double lost = tensor_product(a, a) + tensor_product(b, b) + tensor_product(both, both) +
                      2.0 * (tensor_product(a, b) - tensor_product(a, both) - tensor_product(b, both));
  const double level = receptance(reference, both.natural_frequency).squaredNorm();
  return std::max(0.0, lost) / (both.natural_frequency * level);
}

std::vector<Mode> join_down_to(std::vector<Mode> modes, std::size_t most) {
  const std::vector<Mode> reference = modes;
  Eigen::MatrixXd cost(modes.size(), modes.size());
  const auto set_cost = [&](std::size_t i, std::size_t j) {
    const auto row = static_cast<Eigen::Index>(std::min(i, j)), column = static_cast<Eigen::Index>(std::max(i, j));
    cost(row, column) = cost_of_joining(modes[i], modes[j], reference);
  };
  for (std::size_t i = 0; i < modes.size(); ++i)
    for (std::size_t j = i + 1; j < modes.size(); ++j) set_cost(i, j);
  while (modes.size() > most) {
    std::size_t first = 0, second = 1;
    for (std::size_t i = 0; i < modes.size(); ++i) {
      for (std::size_t j = i + 1; j < modes.size(); ++j) {
        const auto at = [&](std::size_t a, std::size_t b) {
          return cost(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
        };
        if (at(i, j) < at(first, second)) first = i, second = j;
      }
    }
    modes[first] = joined(modes[first], modes[second]);
    // The last mode moves into the gap.
    modes[second] = modes.back();
    modes.pop_back();
    for (const std::size_t changed : {first, second}) {
      for (std::size_t i = 0; i < modes.size() && changed < modes.size(); ++i)
        if (i != changed) set_cost(i, changed);
    }
  }
  return modes;
}

std::vector<Mode> polished(std::vector<Mode> start, std::span<const Mode> reference) {
  std::vector<double> frequencies = peak_frequencies(reference, kFitPoints);
  const std::size_t stride = frequencies.size() / kMostFitPoints + 1;
  std::vector<double> few;
  std::vector<Eigen::Matrix3cd> responses;
  for (std::size_t i = 0; i < frequencies.size(); i += stride) {
    few.push_back(frequencies[i]);
    responses.push_back(receptance(reference, frequencies[i]));
  }
  return polish_modes(std::move(start), few, responses);
}

}  // namespace

ReceptanceError receptance_error(std::span<const Mode> modes, std::span<const Mode> reference) {
  check_modes(modes);
  const std::vector<double> frequencies = peak_frequencies(reference);
  ReceptanceError error;
  double highest = 0.0, squares = 0.0;
  for (const double frequency : frequencies) {
    const Eigen::Matrix3cd wanted = receptance(reference, frequency);
    const double norm = wanted.norm(), relative = (receptance(modes, frequency) - wanted).norm() / norm;
    squares += relative * relative;
    error.worst = std::max(error.worst, relative);
    if (norm > highest) highest = norm, error.at_peak = relative;
  }
  error.rms = std::sqrt(squares / static_cast<double>(frequencies.size()));
  return error;
}

ModalRefit refit_modes(std::span<const Mode> modes, std::size_t most) {
  check_modes(modes);
  if (most == 0) throw std::invalid_argument("refit: at least one mode is needed");
  ModalRefit result;
  result.modes = without_copies(modes);
  if (result.modes.size() > most) result.modes = polished(join_down_to(std::move(result.modes), most), modes);
  sort_modes(result.modes);
  result.error = receptance_error(result.modes, modes);
  return result;
}

PredictedPosture with_few_modes(PredictedPosture predicted, std::size_t most) {
  std::vector<Mode>& modes = predicted.posture.modes;
  if (!predicted.superposed || modes.size() <= most) return predicted;
  predicted.fitted_from = modes.size();
  ModalRefit refit = refit_modes(modes);
  modes = std::move(refit.modes);
  predicted.fit_error = refit.error.rms;
  return predicted;
}

}  // namespace stillcut
