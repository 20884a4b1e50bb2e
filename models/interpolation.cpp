#include "models/interpolation.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <tuple>

#include "dsp/numbers.hpp"
#include "models/receptance.hpp"

namespace stillcut {
namespace {

double cosine(const Mode& a, const Mode& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) sum += a.direction[i] * b.direction[i];
  return sum;
}

// 0 for equal modes; one octave apart counts as much as a right angle between the directions.
double difference(const Mode& a, const Mode& b) {
  return std::abs(std::log2(a.natural_frequency / b.natural_frequency)) + 1.0 - std::min(1.0, std::abs(cosine(a, b)));
}

Mode normalised(Mode mode) {
  const double length = std::hypot(mode.direction[0], mode.direction[1], mode.direction[2]);
  for (double& component : mode.direction) component /= length;
  return mode;
}

// Puts the modes of `posture` on the tracks as seen from `parent`, whose modes are on them already.
void extend_tracks(std::vector<ModeTrack>& tracks, std::size_t parent, std::size_t posture,
                   std::span<const Mode> modes) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;  // difference, track, mode
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    for (std::size_t m = 0; m < modes.size(); ++m) {
      if (tracks[t][parent]) pairs.emplace_back(difference(*tracks[t][parent], modes[m]), t, m);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<bool> placed(modes.size(), false);
  for (const auto& [unused, t, m] : pairs) {
    if (placed[m] || tracks[t][posture]) continue;
    Mode mode = normalised(modes[m]);
    if (cosine(*tracks[t][parent], mode) < 0.0) {
      for (double& component : mode.direction) component = -component;
    }
    tracks[t][posture] = mode;
    placed[m] = true;
  }
  for (std::size_t m = 0; m < modes.size(); ++m) {
    if (placed[m]) continue;
    tracks.emplace_back(tracks.empty() ? 0 : tracks.front().size());
    tracks.back()[posture] = normalised(modes[m]);
  }
}

// The weighted mean of a track, over the postures that have the mode.
Mode weighted_mode(const ModeTrack& track, std::span<const double> weights, double total) {
  Mode mean{0.0, 0.0, 0.0, {0.0, 0.0, 0.0}};
  std::size_t heaviest = 0;
  double largest = -1.0;
  for (std::size_t i = 0; i < track.size(); ++i) {
    if (!track[i]) continue;
    const double weight = weights[i] / total;
    mean.natural_frequency += weight * track[i]->natural_frequency;
    mean.damping_ratio += weight * track[i]->damping_ratio;
    mean.stiffness += weight * track[i]->stiffness;
    for (std::size_t k = 0; k < 3; ++k) mean.direction[k] += weight * track[i]->direction[k];
    if (weight > largest) largest = weight, heaviest = i;
  }
  constexpr double kCancelled = 1e-6;  // directions that cancel have no mean: the heaviest posture's stands
  if (std::hypot(mean.direction[0], mean.direction[1], mean.direction[2]) < kCancelled) {
    mean.direction = track[heaviest]->direction;
  }
  return normalised(mean);
}

std::vector<Mode> superposed(const DynamicsMap& map, std::span<const double> weights) {
  std::vector<Mode> modes;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] <= 0.0) continue;
    for (Mode mode : map.postures[i].modes) {
      mode.stiffness /= weights[i];
      modes.push_back(mode);
    }
  }
  return modes;
}

std::vector<Mode> averaged(const DynamicsMap& map, std::span<const double> weights, const JointScale& scale) {
  std::vector<Mode> modes;
  for (const ModeTrack& track : match_modes(map, scale)) {
    double total = 0.0;
    for (std::size_t i = 0; i < track.size(); ++i) total += track[i] ? weights[i] : 0.0;
    if (total >= 0.5) modes.push_back(weighted_mode(track, weights, total));
  }
  if (modes.empty())
    throw std::invalid_argument("dynamics map: its postures have no mode in common; use interpolation \"frf\"");
  return modes;
}

}  // namespace

std::vector<ModeTrack> match_modes(const DynamicsMap& map, const JointScale& scale) {
  const std::size_t count = map.postures.size();
  std::vector<ModeTrack> tracks;
  if (count == 0) return tracks;
  for (const Mode& mode : map.postures.front().modes) {
    tracks.emplace_back(count);
    tracks.back().front() = normalised(mode);
  }
  // Prim's shortest tree: take the posture nearest to those already taken, and compare it with that nearest one.
  std::vector<bool> taken(count, false);
  std::vector<std::size_t> parent(count, 0);
  std::vector<double> distance(count, kInfinity);
  for (std::size_t latest = 0, step = 1;; ++step) {
    taken[latest] = true;
    if (step == count) return tracks;
    std::size_t next = count;
    for (std::size_t i = 0; i < count; ++i) {
      if (taken[i]) continue;
      const double to_latest = posture_distance(map.postures[i], map.postures[latest], map.has_joints, scale);
      if (to_latest < distance[i]) distance[i] = to_latest, parent[i] = latest;
      if (next == count || distance[i] < distance[next]) next = i;
    }
    extend_tracks(tracks, parent[next], next, map.postures[next].modes);
    latest = next;
  }
}

PredictedPosture predict_posture(const DynamicsMap& map, const Posture& query, const Interpolation& interpolation) {
  const JointScale& scale = interpolation.joint_scale;
  const std::vector<double> weights = inverse_distance_weights(map, query, interpolation.power, scale);
  for (const Posture& posture : map.postures) {
    try {
      check_modes(posture.modes);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("posture \"" + posture.id + "\": " + error.what());
    }
  }
  PredictedPosture result;
  result.posture = query;
  const auto nearest = static_cast<std::size_t>(std::max_element(weights.begin(), weights.end()) - weights.begin());
  const Posture& neighbour = map.postures[nearest];
  result.nearest = neighbour.id;
  result.nearest_distance = posture_distance(neighbour, query, map.has_joints, scale);
  for (const Posture& posture : map.postures) {
    double gap = kInfinity;
    for (const Posture& other : map.postures) {
      if (&other != &posture) gap = std::min(gap, posture_distance(posture, other, map.has_joints, scale));
    }
    if (std::isfinite(gap)) result.map_spacing = std::max(result.map_spacing, gap);
  }
  result.outside = map.postures.size() > 1 && result.nearest_distance > result.map_spacing;
  result.posture.modes = result.nearest_distance == 0.0 ? neighbour.modes
                         : interpolation.modal          ? averaged(map, weights, scale)
                                                        : superposed(map, weights);
  std::stable_sort(result.posture.modes.begin(), result.posture.modes.end(),
                   [](const Mode& a, const Mode& b) { return a.natural_frequency < b.natural_frequency; });
  return result;
}

}  // namespace stillcut
