#include "models/mode_tracking.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "dsp/numbers.hpp"
#include "models/cheapest_pairs.hpp"
#include "models/interpolation.hpp"
#include "models/mode_pairs.hpp"
#include "models/posture_trend.hpp"

namespace stillcut {
namespace {

using Costs = std::vector<std::vector<double>>;

double octaves(double a, double b) { return std::abs(std::log2(a / b)); }

double track_difference(const Mode& a, const Mode& b) {
  return octaves(a.natural_frequency, b.natural_frequency) + 1.0 - modal_assurance(a, b);
}

Costs differences(std::span<const Mode> of, std::span<const Mode> in) {
  Costs cost(of.size(), std::vector<double>(in.size()));
  for (std::size_t i = 0; i < of.size(); ++i)
    for (std::size_t j = 0; j < in.size(); ++j) cost[i][j] = track_difference(of[i], in[j]);
  return cost;
}

// How unlike two postures' modes are: the sum over the best pairs, the lonely counting too.
double unlikeness(const Posture& a, const Posture& b, double alone) {
  const Costs cost = differences(a.modes, b.modes);
  const std::vector<int> pairs = cheapest_pairs(cost, alone);
  double sum = alone * static_cast<double>(a.modes.size() + b.modes.size());
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (pairs[i] >= 0) sum += cost[i][static_cast<std::size_t>(pairs[i])] - 2.0 * alone;
  return sum;
}

// What the other postures of a track say about a mode at one of them.
struct Expected {
  int track = 0;
  double frequency = 0.0;     // rad/s
  Eigen::Matrix3d direction;  // weighted mean of u u^T
};

// Tracks while they are made: numbers count from 0 and may fall empty.
class Tracking {
 public:
  Tracking(const DynamicsMap& map, const TrackingSettings& settings)
      : map_(map), settings_(settings), alone_(0.5 * settings.most_difference), number_(map.postures.size()) {
    const std::size_t count = map.postures.size();
    distance_.assign(count, std::vector<double>(count, 0.0));
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < i; ++j)
        distance_[i][j] = distance_[j][i] =
            settings.places_known ? posture_distance(map.postures[i], map.postures[j], map.has_joints, settings.scale)
                                  : unlikeness(map.postures[i], map.postures[j], alone_);
  }

  ModeTracks tracks() {
    if (map_.postures.empty()) return {};
    follow_tree();
    constexpr int kMostRounds = 20;  // they settle in a few; two labellings that follow each other must not go on
    for (int round = 0; round < kMostRounds && reassign(); ++round) {
    }
    return in_rising_frequency();
  }

 private:
  const std::vector<Mode>& modes(std::size_t posture) const { return map_.postures[posture].modes; }

  // Prim's order: always the posture nearest to those that are done, against all of those.
  void follow_tree() {
    const std::size_t count = map_.postures.size();
    std::vector<bool> done(count, false);
    std::vector<double> away(count, kInfinity);
    for (std::size_t step = 0, next = 0; step < count; ++step) {
      assign(next);
      done[next] = true;
      const std::size_t latest = next;
      next = count;
      for (std::size_t i = 0; i < count; ++i) {
        if (done[i]) continue;
        away[i] = std::min(away[i], distance_[latest][i]);
        if (next == count || away[i] < away[next]) next = i;
      }
    }
  }

  bool reassign() {
    bool changed = false;
    for (std::size_t p = 0; p < number_.size(); ++p) changed = assign(p) || changed;
    return changed;
  }

  // A posture against what the others say that have numbers; whether one of its own changed.
  bool assign(std::size_t p) {
    const std::vector<Expected> expected = expected_at(p);
    Costs cost(modes(p).size());
    for (std::size_t m = 0; m < cost.size(); ++m) {
      const Mode& mode = modes(p)[m];
      const Eigen::Vector3d u = Eigen::Vector3d(mode.direction.data()).normalized();
      for (const Expected& e : expected)
        cost[m].push_back(octaves(mode.natural_frequency, e.frequency) + 1.0 -
                          std::clamp(u.dot(e.direction * u), 0.0, 1.0));
    }
    const std::vector<int> pairs = cheapest_pairs(cost, alone_);
    const std::vector<int> before = number_[p];
    number_[p].resize(pairs.size(), kNone);
    for (std::size_t m = 0; m < pairs.size(); ++m) {
      int& number = number_[p][m];
      const bool of_others =
          std::any_of(expected.begin(), expected.end(), [&](const Expected& e) { return e.track == number; });
      if (pairs[m] >= 0)
        number = expected[static_cast<std::size_t>(pairs[m])].track;
      else if (number == kNone || of_others)
        number = next_++;  // it has left the others; a track of its own it keeps
    }
    return number_[p] != before;
  }

  // Of every track that another posture has.
  std::vector<Expected> expected_at(std::size_t p) const {
    std::vector<Expected> result;
    for (int track = 0; track < next_; ++track) {
      std::vector<double> weights(number_.size(), 0.0);
      double total = 0.0;
      for (std::size_t q = 0; q < number_.size(); ++q) {
        if (q == p || !mode_on(track, q)) continue;
        const double d = std::max(distance_[p][q], kNear);
        total += weights[q] = 1.0 / (d * d);
      }
      if (!(total > 0.0)) continue;
      for (double& weight : weights) weight /= total;
      const std::vector<double> along =
          settings_.places_known ? trend_weights(map_, map_.postures[p], weights, settings_.scale) : weights;
      Expected expected{track, 0.0, Eigen::Matrix3d::Zero()};
      double log_frequency = 0.0;
      for (std::size_t q = 0; q < number_.size(); ++q) {
        if (weights[q] == 0.0) continue;
        const Mode& mode = *mode_on(track, q);
        log_frequency += along[q] * std::log(mode.natural_frequency);
        const Eigen::Vector3d u = Eigen::Vector3d(mode.direction.data()).normalized();
        expected.direction += weights[q] * u * u.transpose();
      }
      expected.frequency = std::exp(log_frequency);
      result.push_back(expected);
    }
    return result;
  }

  const Mode* mode_on(int track, std::size_t posture) const {
    const auto& numbers = number_[posture];
    const auto at = std::find(numbers.begin(), numbers.end(), track);
    return at == numbers.end() ? nullptr : &modes(posture)[static_cast<std::size_t>(at - numbers.begin())];
  }

  ModeTracks in_rising_frequency() const {
    std::vector<double> sum(static_cast<std::size_t>(next_), 0.0), count = sum;
    for (std::size_t p = 0; p < number_.size(); ++p)
      for (std::size_t m = 0; m < number_[p].size(); ++m) {
        const auto track = static_cast<std::size_t>(number_[p][m]);
        sum[track] += std::log(modes(p)[m].natural_frequency);
        count[track] += 1.0;
      }
    std::vector<std::size_t> order;
    for (std::size_t t = 0; t < count.size(); ++t)
      if (count[t] > 0.0) order.push_back(t);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return sum[a] / count[a] < sum[b] / count[b]; });
    ModeTracks result{.count = static_cast<int>(order.size()), .number = number_};
    for (auto& numbers : result.number)
      for (int& number : numbers) {
        const auto at = std::find(order.begin(), order.end(), static_cast<std::size_t>(number));
        number = static_cast<int>(at - order.begin()) + 1;
      }
    return result;
  }

  static constexpr int kNone = -1;
  static constexpr double kNear = 1e-6;  // rad or m: postures at one place still have a weight

  const DynamicsMap& map_;
  const TrackingSettings& settings_;
  double alone_;
  Costs distance_;
  std::vector<std::vector<int>> number_;  // [posture][mode]
  int next_ = 0;
};

}  // namespace

double modal_assurance(const Mode& a, const Mode& b) {
  const double cosine = direction_cosine(a, b), squares = direction_cosine(a, a) * direction_cosine(b, b);
  return std::min(1.0, cosine * cosine / squares);
}

int ModeTracks::found(int track) const {
  return static_cast<int>(std::count_if(number.begin(), number.end(), [&](const std::vector<int>& numbers) {
    return std::find(numbers.begin(), numbers.end(), track) != numbers.end();
  }));
}

ModeTracks track_modes(const DynamicsMap& map, const TrackingSettings& settings) {
  check_map(map);
  return Tracking(map, settings).tracks();
}

}  // namespace stillcut
