#include "models/next_tap.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "dsp/numbers.hpp"
#include "models/posture_trend.hpp"
#include "models/sentence.hpp"

namespace stillcut {
namespace {

constexpr int kPlacesAlongAxis = 9;

struct Candidate {
  Posture place;
  std::array<std::string, 2> between;
};

// Of one posture, as MethodErrors::score is of all.
double left_out_error(const LeftOutPrediction& prediction) {
  double squares = prediction.spurious_peaks;
  for (const ModePrediction& mode : prediction.modes) {
    const double half_widths = mode.frequency_error / mode.measured.damping_ratio;
    squares += mode.predicted ? half_widths * half_widths + mode.peak_error * mode.peak_error : 1.0;
  }
  return std::sqrt(squares / static_cast<double>(prediction.modes.size()));
}

std::vector<Candidate> midpoints(const DynamicsMap& map) {
  std::vector<Candidate> result;
  for (std::size_t i = 0; i < map.postures.size(); ++i)
    for (std::size_t j = i + 1; j < map.postures.size(); ++j) {
      const Posture &a = map.postures[i], &b = map.postures[j];
      Candidate& candidate = result.emplace_back();
      candidate.between = {a.id, b.id};
      for (std::size_t k = 0; k < a.joints.size(); ++k)
        candidate.place.joints[k] = a.joints[k] + 0.5 * std::remainder(b.joints[k] - a.joints[k], kTwoPi);
    }
  return result;
}

std::vector<Candidate> grid(const DynamicsMap& map) {
  std::array<double, 3> low{}, high{};
  std::array<int, 3> count{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [least, most] =
        std::minmax_element(map.postures.begin(), map.postures.end(),
                            [k](const Posture& a, const Posture& b) { return a.position[k] < b.position[k]; });
    low[k] = least->position[k];
    high[k] = most->position[k];
    count[k] = high[k] > low[k] ? kPlacesAlongAxis : 1;
  }
  const auto place = [&](std::size_t k, int i) {
    return count[k] == 1 ? low[k] : low[k] + (high[k] - low[k]) * i / (count[k] - 1);
  };
  std::vector<Candidate> result;
  for (int x = 0; x < count[0]; ++x)
    for (int y = 0; y < count[1]; ++y)
      for (int z = 0; z < count[2]; ++z) {
        Candidate& candidate = result.emplace_back();
        candidate.place.position = {place(0, x), place(1, y), place(2, z)};
      }
  return result;
}

std::string hertz(double frequency) {
  std::ostringstream text;
  text << std::setprecision(3) << frequency / kTwoPi << " Hz";
  return text.str();
}

std::string percent(double share) {
  std::ostringstream text;
  text << std::setprecision(2) << 100.0 * share << " %";
  return text.str();
}

// Root mean square over all predicted modes, of the frequency error in half-widths.
double frequency_half_widths(const LeaveOneOut& report) {
  double squares = 0.0;
  int count = 0;
  for (const LeftOutPosture& posture : report.postures)
    for (const ModePrediction& mode : posture.by(report.best).modes)
      if (mode.predicted) {
        const double error = mode.frequency_error / mode.measured.damping_ratio;
        squares += error * error, ++count;
      }
  return count == 0 ? 0.0 : std::sqrt(squares / count);
}

void doubt_report(const LeaveOneOut& report, std::vector<std::string>& doubts) {
  if (!report.beats_mean)
    doubts.emplace_back(
        "predicted from the others, no posture comes out better than the mean of them all: between its postures the "
        "map tells nothing yet; tap more of them, nearer to each other");
  const double half_widths = frequency_half_widths(report);
  if (half_widths > 1.0)
    doubts.push_back(sentence("left out and predicted, frequencies are off by ",
                              percent(report.of(report.best).frequency.rms), " rms, ", std::setprecision(2),
                              half_widths,
                              " times half a resonance's width: lobes between the postures are off by as much"));
  std::string outside;
  int count = 0;
  for (const LeftOutPosture& posture : report.postures)
    if (posture.outside) outside += (count++ == 0 ? "" : ", ") + posture.id;
  if (count > 0)
    doubts.push_back(sentence(count == 1 ? "posture " : "postures ", outside, count == 1 ? " lies" : " lie",
                              " farther from the others than these from each other; tap between them"));
}

void doubt_number(const DynamicsMap& map, std::vector<std::string>& doubts) {
  const auto count = static_cast<int>(map.postures.size());
  if (count == 1) {
    doubts.emplace_back(
        "a single posture: the same modes are predicted wherever the machine stands; tap at two more at least");
    return;
  }
  const int directions = spread_directions(map), wanted = 2 * directions + 1;
  if (count < wanted)
    doubts.push_back(sentence("too few postures: ", count, " that spread in ", directions,
                              directions == 1 ? " direction" : " directions", "; a slope in all of them takes ",
                              wanted));
}

void doubt_tracks(const DynamicsMap& map, const ModeTracks& tracks, std::vector<std::string>& doubts) {
  const auto count = static_cast<int>(map.postures.size());
  for (int track = 1; track <= tracks.count; ++track) {
    if (2 * tracks.found(track) >= count) continue;
    double sum = 0.0;
    int found = 0;
    std::string where;
    for (std::size_t p = 0; p < tracks.number.size(); ++p)
      for (std::size_t m = 0; m < tracks.number[p].size(); ++m) {
        if (tracks.number[p][m] != track) continue;
        sum += map.postures[p].modes[m].natural_frequency;
        where += (found++ == 0 ? "" : ", ") + map.postures[p].id;
      }
    doubts.push_back(sentence("mode ", track, ", about ", hertz(sum / found), ", was found at ", found, " of ", count,
                              " postures only (", where, "): is it real?"));
  }
}

}  // namespace

std::optional<NextTap> next_tap(const DynamicsMap& map, const LeaveOneOut& report) {
  if (map.postures.size() < 2) return std::nullopt;
  std::vector<double> rate;  // expected error for each rad or m
  for (const LeftOutPosture& posture : report.postures)
    rate.push_back(left_out_error(posture.by(report.best)) / posture.nearest_distance);
  NextTap result;
  result.half_widths = -1.0;
  for (const Candidate& candidate : map.has_joints ? midpoints(map) : grid(map)) {
    const std::vector<double> weights = inverse_distance_weights(map, candidate.place, 2.0);
    const auto nearest = static_cast<std::size_t>(std::max_element(weights.begin(), weights.end()) - weights.begin());
    const double distance = posture_distance(map.postures[nearest], candidate.place, map.has_joints);
    double expected = 0.0;
    for (std::size_t i = 0; i < weights.size(); ++i) expected += weights[i] * rate[i] * distance;
    if (expected > result.half_widths)
      result = {candidate.place, candidate.between, map.postures[nearest].id, distance, expected};
  }
  return result;
}

std::vector<std::string> map_doubts(const DynamicsMap& map, const ModeTracks& tracks,
                                    const std::optional<LeaveOneOut>& report) {
  std::vector<std::string> doubts;
  doubt_number(map, doubts);
  if (report) doubt_report(*report, doubts);
  doubt_tracks(map, tracks, doubts);
  return doubts;
}

}  // namespace stillcut
