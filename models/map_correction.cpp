#include "models/map_correction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "models/posture.hpp"

namespace stillcut {
namespace {

constexpr double kLeastAlignment = 0.5;              // |cos| between directions
constexpr double kSamePosture = 1e-6;                // rad
constexpr double kMostDetuning = std::numbers::ln2;  // |ln| of the frequency ratio

// Logarithms, measured over predicted.
struct MeasuredRatio {
  bool found = false;
  double frequency = 0.0, stiffness = 0.0, damping = 0.0;
};

struct PostureMatch {
  std::vector<MeasuredRatio> ratios;  // one a robot mode
  std::vector<Mode> others;           // measured, without a partner
};

PostureMatch match_posture(const std::vector<Mode>& robot, const std::vector<Mode>& measured) {
  struct Pair {
    double cost;
    std::size_t robot, measured;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < robot.size(); ++i) {
    for (std::size_t j = 0; j < measured.size(); ++j) {
      const auto& u = robot[i].direction;
      const auto& v = measured[j].direction;
      const double along = std::abs(u[0] * v[0] + u[1] * v[1] + u[2] * v[2]);
      const double detuned = std::abs(std::log(measured[j].natural_frequency / robot[i].natural_frequency));
      if (along >= kLeastAlignment && detuned <= kMostDetuning) pairs.push_back({detuned + 1.0 - along, i, j});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.cost < b.cost; });
  PostureMatch match{std::vector<MeasuredRatio>(robot.size()), {}};
  std::vector<bool> taken(measured.size(), false);
  for (const Pair& pair : pairs) {
    if (match.ratios[pair.robot].found || taken[pair.measured]) continue;
    const Mode& a = robot[pair.robot];
    const Mode& b = measured[pair.measured];
    taken[pair.measured] = true;
    match.ratios[pair.robot] = {true, std::log(b.natural_frequency / a.natural_frequency),
                                std::log(b.stiffness / a.stiffness), std::log(b.damping_ratio / a.damping_ratio)};
  }
  for (std::size_t j = 0; j < measured.size(); ++j) {
    if (!taken[j]) match.others.push_back(measured[j]);
  }
  return match;
}

void correct_modes(std::vector<Mode>& modes, const std::vector<PostureMatch>& matches,
                   const std::vector<double>& weights) {
  for (std::size_t r = 0; r < modes.size(); ++r) {
    MeasuredRatio mean;
    double weight = 0.0;
    for (std::size_t i = 0; i < matches.size(); ++i) {
      if (r >= matches[i].ratios.size() || !matches[i].ratios[r].found) continue;
      const MeasuredRatio& ratio = matches[i].ratios[r];
      weight += weights[i];
      mean.frequency += weights[i] * ratio.frequency;
      mean.stiffness += weights[i] * ratio.stiffness;
      mean.damping += weights[i] * ratio.damping;
    }
    if (!(weight > 0.0)) continue;
    modes[r].natural_frequency *= std::exp(mean.frequency / weight);
    modes[r].stiffness *= std::exp(mean.stiffness / weight);
    modes[r].damping_ratio = std::min(0.999, modes[r].damping_ratio * std::exp(mean.damping / weight));
  }
}

}  // namespace

CorrectedMap corrected_map(const DynamicsMap& measured, const DynamicsMap& predicted, const RobotModes& robot) {
  if (measured.postures.empty() || !measured.has_joints)
    throw std::invalid_argument("the measured map has no joint angles; a robot's modes need them (j1_deg to j6_deg)");
  CorrectedMap result{measured, {}};
  std::vector<PostureMatch> matches;
  for (const Posture& posture : measured.postures) {
    matches.push_back(match_posture(robot(posture), posture.modes));
    const std::vector<MeasuredRatio>& ratios = matches.back().ratios;
    if (result.matches.size() < ratios.size()) result.matches.resize(ratios.size());
    for (std::size_t r = 0; r < ratios.size(); ++r) {
      if (!ratios[r].found) continue;
      ModeMatch& match = result.matches[r];
      const double ratio = std::exp(ratios[r].frequency);
      match.lowest_frequency_ratio = match.found == 0 ? ratio : std::min(match.lowest_frequency_ratio, ratio);
      match.highest_frequency_ratio = match.found == 0 ? ratio : std::max(match.highest_frequency_ratio, ratio);
      ++match.found;
    }
  }
  for (Posture posture : predicted.postures) {
    std::vector<double> distances;
    for (const Posture& other : measured.postures) distances.push_back(posture_distance(posture, other, true));
    const auto nearest = std::min_element(distances.begin(), distances.end());
    if (*nearest <= kSamePosture) continue;
    correct_modes(posture.modes, matches, inverse_distance_weights(measured, posture, 1.0));
    const std::vector<Mode>& others = matches[static_cast<std::size_t>(nearest - distances.begin())].others;
    posture.modes.insert(posture.modes.end(), others.begin(), others.end());
    std::stable_sort(posture.modes.begin(), posture.modes.end(),
                     [](const Mode& a, const Mode& b) { return a.natural_frequency < b.natural_frequency; });
    const auto same_id = [&](const Posture& other) { return other.id == posture.id; };
    while (std::any_of(result.map.postures.begin(), result.map.postures.end(), same_id)) posture.id += "-robot";
    result.map.postures.push_back(std::move(posture));
  }
  return result;
}

}  // namespace stillcut
