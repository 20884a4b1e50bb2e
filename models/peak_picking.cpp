#include "models/peak_picking.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>

#include "models/frf_lines.hpp"

namespace stillcut {
namespace {

using Eigen::Index;

constexpr double kPeaksApart = 0.03;
constexpr double kLeastOfHighest = 1e-3;

bool is_peak(const FrfLines& lines, const Eigen::VectorXd& power, Index at) {
  if (power[at] < kLeastOfHighest * power.maxCoeff()) return false;
  for (const Index way : {-1, 1})
    for (Index n = at + way;
         n >= 0 && n < power.size() && std::abs(lines.omega[n] / lines.omega[at] - 1.0) < kPeaksApart; n += way)
      if (power[n] > power[at]) return false;
  return at > 0 && at + 1 < power.size();
}

// Where the power falls through half of the peak's, going one way.
std::optional<double> half_power_frequency(const FrfLines& lines, const Eigen::VectorXd& power, Index at, Index way) {
  for (Index n = at + way; n >= 0 && n < power.size(); n += way) {
    if (power[n] > power[at]) return std::nullopt;
    const Index before = n - way;
    if (power[n] <= 0.5 * power[at])
      return lines.omega[before] +
             (lines.omega[n] - lines.omega[before]) * (power[before] - 0.5 * power[at]) / (power[before] - power[n]);
  }
  return std::nullopt;
}

// u/sqrt(k) from the imaginary parts -2 zeta Im H at the peak: by the column of the strongest direct response.
std::optional<Eigen::Vector3d> root_at(const FrfLines& lines, Index at, double damping_ratio) {
  Eigen::Vector3d direct = Eigen::Vector3d::Zero(), column = direct;
  Index strongest = 0;
  for (const FrfEntry& entry : lines.entries)
    if (entry.response == entry.force) direct[entry.force] = -2.0 * damping_ratio * entry.values[at].imag();
  if (!(direct.maxCoeff(&strongest) > 0.0)) return std::nullopt;
  const double root = std::sqrt(direct[strongest]);
  for (const FrfEntry& entry : lines.entries) {
    const double part = -2.0 * damping_ratio * entry.values[at].imag() / root;
    if (entry.force == strongest) column[entry.response] = part;
    if (entry.response == strongest && column[entry.force] == 0.0) column[entry.force] = part;
  }
  return column;
}

}  // namespace

std::vector<Mode> pick_peaks(const FrequencyResponse& response) {
  require_sound_response(response);
  const FrfLines lines = lines_between(response, 0.0, response.frequencies_hz.back());
  Eigen::VectorXd power = Eigen::VectorXd::Zero(lines.omega.size());
  for (const FrfEntry& entry : lines.entries) power += entry.values.cwiseAbs2();
  std::vector<Mode> modes;
  for (Index at = 0; at < power.size(); ++at) {
    if (!is_peak(lines, power, at)) continue;
    const std::optional<double> low = half_power_frequency(lines, power, at, -1),
                                high = half_power_frequency(lines, power, at, 1);
    if (!low || !high) continue;
    const double damping = 0.5 * (*high - *low) / lines.omega[at];
    const std::optional<Eigen::Vector3d> root = root_at(lines, at, damping);
    if (!root || !(damping > 0.0) || damping >= 1.0) continue;
    const Eigen::Vector3d u = root->normalized();
    modes.push_back({lines.omega[at], damping, 1.0 / root->squaredNorm(), {u[0], u[1], u[2]}});
  }
  return modes;
}

}  // namespace stillcut
