#include "models/interpolation.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include "dsp/numbers.hpp"
#include "models/mode_pairs.hpp"
#include "models/posture_trend.hpp"
#include "models/receptance.hpp"

namespace stillcut {
namespace {

Mode normalised(Mode mode) {
  const double length = std::hypot(mode.direction[0], mode.direction[1], mode.direction[2]);
  for (double& component : mode.direction) component /= length;
  return mode;
}

// Puts the modes of `posture` on the tracks, each as the nearest posture has it that is on it already.
void extend_tracks(std::vector<ModeTrack>& tracks, std::span<const double> distances, std::size_t posture,
                   std::span<const Mode> modes) {
  std::vector<Mode> known;
  for (const ModeTrack& track : tracks) {
    std::size_t nearest = track.size();
    for (std::size_t i = 0; i < track.size(); ++i)
      if (track[i] && (nearest == track.size() || distances[i] < distances[nearest])) nearest = i;
    known.push_back(*track[nearest]);
  }
  const auto pairs = pair_modes(modes, known);
  for (std::size_t m = 0; m < modes.size(); ++m) {
    Mode mode = normalised(modes[m]);
    if (!pairs[m]) {
      tracks.emplace_back(tracks.empty() ? 0 : tracks.front().size());
      tracks.back()[posture] = mode;
      continue;
    }
    const std::size_t t = *pairs[m];
    if (direction_cosine(known[t], mode) < 0.0) {
      for (double& component : mode.direction) component = -component;
    }
    tracks[t][posture] = mode;
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

// A parameter at the query: its weighted mean as `to` sees it, which keeps it physical whatever the sign of the
// weights, and no farther beyond the measured ones than they lie apart.
template <class To, class Back>
double follow(const ModeTrack& track, std::span<const double> weights, double Mode::*parameter, To to, Back back) {
  double sum = 0.0, low = kInfinity, high = -kInfinity;
  for (std::size_t i = 0; i < track.size(); ++i) {
    if (!track[i] || weights[i] == 0.0) continue;
    const double value = to((*track[i]).*parameter);
    sum += weights[i] * value;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  return back(std::clamp(sum, low - (high - low), high + (high - low)));
}

// A track at the query along the slope of the map (models/posture_trend).
Mode trend_mode(const DynamicsMap& map, const Posture& query, const ModeTrack& track, std::span<const double> weights,
                const JointScale& scale) {
  std::vector<double> present(weights.begin(), weights.end());
  for (std::size_t i = 0; i < present.size(); ++i) present[i] = track[i] ? present[i] : 0.0;
  const std::vector<double> along = trend_weights(map, query, present, scale);
  const auto log = [](double x) { return std::log(x); };
  const auto exp = [](double x) { return std::exp(x); };
  Mode mode = weighted_mode(track, along, 1.0);  // its direction; the heaviest posture's where directions cancel
  mode.natural_frequency = follow(track, along, &Mode::natural_frequency, log, exp);
  mode.stiffness = follow(track, along, &Mode::stiffness, log, exp);
  mode.damping_ratio = follow(
      track, along, &Mode::damping_ratio, [](double x) { return std::log(x / (1.0 - x)); },
      [](double x) { return 1.0 / (1.0 + std::exp(-x)); });
  return mode;
}

// The tracks that are there at the query: those whose postures hold at least half of the weight.
template <class Make>
std::vector<Mode> modes_on_tracks(const DynamicsMap& map, std::span<const double> weights, const JointScale& scale,
                                  Make make) {
  std::vector<Mode> modes;
  for (const ModeTrack& track : match_modes(map, scale)) {
    double total = 0.0;
    for (std::size_t i = 0; i < track.size(); ++i) total += track[i] ? weights[i] : 0.0;
    if (total >= 0.5) modes.push_back(make(track, total));
  }
  if (modes.empty())
    throw std::invalid_argument("dynamics map: its postures have no mode in common; use interpolation \"frf\"");
  sort_modes(modes);
  return modes;
}

}  // namespace

void check_map(const DynamicsMap& map) {
  for (const Posture& posture : map.postures) {
    try {
      check_modes(posture.modes);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("posture \"" + posture.id + "\": " + error.what());
    }
  }
}

std::vector<ModeTrack> match_modes(const DynamicsMap& map, const JointScale& scale) {
  const std::size_t count = map.postures.size();
  std::vector<ModeTrack> tracks;
  if (count == 0) return tracks;
  for (const Mode& mode : map.postures.front().modes) {
    tracks.emplace_back(count);
    tracks.back().front() = normalised(mode);
  }
  // Prim's shortest tree: always the posture nearest to those already taken.
  std::vector<bool> taken(count, false);
  std::vector<double> distance(count, kInfinity);
  for (std::size_t latest = 0, step = 1;; ++step) {
    taken[latest] = true;
    if (step == count) return tracks;
    std::size_t next = count;
    for (std::size_t i = 0; i < count; ++i) {
      if (taken[i]) continue;
      const double to_latest = posture_distance(map.postures[i], map.postures[latest], map.has_joints, scale);
      distance[i] = std::min(distance[i], to_latest);
      if (next == count || distance[i] < distance[next]) next = i;
    }
    std::vector<double> away;
    for (const Posture& posture : map.postures)
      away.push_back(posture_distance(map.postures[next], posture, map.has_joints, scale));
    extend_tracks(tracks, away, next, map.postures[next].modes);
    latest = next;
  }
}

std::vector<Mode> average_modes(const DynamicsMap& map, std::span<const double> weights, const JointScale& scale) {
  return modes_on_tracks(map, weights, scale,
                         [&](const ModeTrack& track, double total) { return weighted_mode(track, weights, total); });
}

PredictedPosture predict_posture(const DynamicsMap& map, const Posture& query, const Interpolation& interpolation) {
  const JointScale& scale = interpolation.joint_scale;
  const std::vector<double> weights = inverse_distance_weights(map, query, interpolation.power, scale);
  check_map(map);
  PredictedPosture result;
  result.posture = query;
  result.in_joints = map.has_joints;
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
  constexpr double kRounding = 1e-9;  // relative: the next place of an even grid is as far as the others
  result.outside = map.postures.size() > 1 && result.nearest_distance > (1.0 + kRounding) * result.map_spacing;
  if (result.nearest_distance == 0.0) {
    result.posture.modes = neighbour.modes;
    sort_modes(result.posture.modes);
  } else if (interpolation.kind == InterpolationKind::frf) {
    result.posture.modes = superposed(map, weights);
    sort_modes(result.posture.modes);
    result.superposed = true;
  } else if (interpolation.kind == InterpolationKind::trend) {
    result.posture.modes = modes_on_tracks(map, weights, scale, [&](const ModeTrack& track, double) {
      return trend_mode(map, query, track, weights, scale);
    });
  } else {
    result.posture.modes = average_modes(map, weights, scale);
  }
  return result;
}

std::string outside_map_text(const PredictedPosture& predicted) {
  const auto text = [&](double distance) { return posture_distance_text(distance, predicted.in_joints); };
  return "posture \"" + predicted.posture.id + "\" lies outside the map: " + text(predicted.nearest_distance) +
         " from the nearest measured posture \"" + predicted.nearest + "\", while those are at most " +
         text(predicted.map_spacing) + " from their neighbours";
}

}  // namespace stillcut
