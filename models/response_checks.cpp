#include "models/response_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <stdexcept>

#include "models/machining.hpp"
#include "models/median.hpp"
#include "models/sentence.hpp"

namespace stillcut {
namespace {

using Eigen::Index;

constexpr double kAboveNoise = 4.0;       // standard deviations
constexpr double kFarAboveNoise = 20.0;   // likewise
constexpr double kMostGivingPower = 0.3;  // share: above it no receptance
constexpr double kGap = 3.5;              // times the usual spacing
constexpr double kMostUnlike = 0.2;       // of a response measured both ways; sensors and hammers are truer
constexpr double kLeastEnd = 5.0;         // Hz; tap tests reach farther

const std::array<const char*, 3> kAxes{"x", "y", "z"};

std::string name_of(const FrfEntry& entry) {
  return std::string(kAxes[static_cast<std::size_t>(entry.response)]) + kAxes[static_cast<std::size_t>(entry.force)];
}

// Of turn * H, as far as it stands out of the noise, the share with a positive imaginary part: in noise powers, so that
// a resonance counts for more than the lines that noise lifts.
double positive_share(const Eigen::VectorXcd& values, const Eigen::VectorXd& weights, std::complex<double> turn) {
  double positive = 0.0, all = 0.0;
  for (Index n = 0; n < values.size(); ++n) {
    const double part = (turn * values[n]).imag() * std::sqrt(weights[n]);
    if (std::abs(part) < kAboveNoise) continue;
    all += part * part;
    if (part > 0.0) positive += part * part;
  }
  return all > 0.0 ? positive / all : 0.0;
}

// Axes that entries tie together, and whether their lengths follow: they do where some way round comes back after an
// odd number of entries (a direct response is such a way); else only products are known.
struct Ties {
  std::array<bool, 3> measured{};
  std::array<int, 3> group{0, 1, 2};
  std::array<bool, 3> sized{};  // of a group

  explicit Ties(const FrfLines& lines) {
    std::array<int, 3> side{};  // of each axis, 0 or 1, so that ties lead from side to side
    for (const FrfEntry& entry : lines.entries) {
      const auto i = static_cast<std::size_t>(entry.response), j = static_cast<std::size_t>(entry.force);
      measured[i] = measured[j] = true;
      if (group[i] != group[j]) {
        const int from = group[j], to = group[i];
        const bool turn = side[i] == side[j];
        sized[static_cast<std::size_t>(to)] =
            sized[static_cast<std::size_t>(to)] || sized[static_cast<std::size_t>(from)];
        for (std::size_t k = 0; k < 3; ++k)
          if (group[k] == from) {
            group[k] = to;
            if (turn) side[k] = 1 - side[k];
          }
      } else if (side[i] == side[j]) {
        sized[static_cast<std::size_t>(group[i])] = true;
      }
    }
  }
};

}  // namespace

ResponseChecks check_responses(const FrfLines& lines, const FrfWeights& weights) {
  ResponseChecks checks;
  double difference = 0.0, mean = 0.0, excess = 0.0;
  int direct = 0;
  for (std::size_t e = 0; e < lines.entries.size(); ++e) {
    const FrfEntry& entry = lines.entries[e];
    if (entry.response == entry.force) {
      excess += positive_share(entry.values, weights[e], 1.0);
      ++direct;
    }
    for (const FrfEntry& other : lines.entries) {
      if (entry.response >= entry.force || other.response != entry.force || other.force != entry.response) continue;
      difference += (entry.values - other.values).squaredNorm();
      mean += 0.25 * (entry.values + other.values).squaredNorm();
    }
  }
  if (direct > 0) checks.passivity_excess = excess / direct;
  if (mean > 0.0) checks.reciprocity_error = std::sqrt(difference / mean);
  return checks;
}

void require_receptance(const FrfLines& lines, const FrfWeights& weights) {
  const Ties ties(lines);
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (ties.measured[axis] && !ties.sized[static_cast<std::size_t>(ties.group[axis])])
      throw std::invalid_argument(sentence("the measured responses leave stiffness along ", kAxes[axis],
                                           " open: measure the direct response too, e.g. h_", kAxes[axis],
                                           kAxes[axis]));
  for (std::size_t e = 0; e < lines.entries.size(); ++e) {
    const FrfEntry& entry = lines.entries[e];
    if (entry.response != entry.force) continue;
    const auto excess_as = [&](std::complex<double> turn) { return positive_share(entry.values, weights[e], turn); };
    if (excess_as(1.0) <= kMostGivingPower) continue;
    const bool mobility = excess_as({0.0, -1.0}) < 0.1;
    throw std::invalid_argument(sentence(
        "the direct response ", name_of(entry), " gives power instead of taking it: ",
        mobility ? "it looks like mobility, not receptance"
                 : "it is accelerance and not receptance, or force and response are swapped, or one of them has the "
                   "wrong sign"));
  }
}

std::vector<std::string> reciprocity_doubts(const FrfLines& lines, const FrfWeights& weights) {
  std::vector<std::string> doubts;
  for (std::size_t e = 0; e < lines.entries.size(); ++e)
    for (std::size_t o = 0; o < lines.entries.size(); ++o) {
      const FrfEntry &entry = lines.entries[e], &other = lines.entries[o];
      if (entry.response >= entry.force || other.response != entry.force || other.force != entry.response) continue;
      // Where either stands far out of the noise, each line by how well it is known.
      double difference = 0.0, larger = 0.0;
      for (Index n = 0; n < lines.omega.size(); ++n) {
        const double weight = std::min(weights[e][n], weights[o][n]);
        const double strength = std::max(std::norm(entry.values[n]), std::norm(other.values[n]));
        if (strength * weight < kFarAboveNoise * kFarAboveNoise) continue;
        difference += weight * std::norm(entry.values[n] - other.values[n]);
        larger += weight * strength;
      }
      if (difference > kMostUnlike * kMostUnlike * larger)
        doubts.push_back(sentence("the responses ", name_of(entry), " and ", name_of(other), " differ by ",
                                  100.0 * std::sqrt(difference / larger),
                                  " % of the larger, and must be alike: one has a wrong sign, scale or channel, and "
                                  "directions may be wrong; leave that one out or measure it again"));
    }
  return doubts;
}

std::vector<std::string> response_doubts(const FrfLines& lines) {
  std::vector<std::string> doubts;
  const Ties ties(lines);
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!ties.measured[axis])
      doubts.push_back(sentence("nothing was measured along ", kAxes[axis], ": every mode's direction has 0 there"));
  std::array<bool, 3> seen{};
  int separate = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (ties.measured[axis] && !seen[static_cast<std::size_t>(ties.group[axis])]) {
      seen[static_cast<std::size_t>(ties.group[axis])] = true;
      ++separate;
    }
  if (separate > 1)
    doubts.push_back(
        "no cross response ties the axes together: the signs of the directions' components are open and taken as "
        "positive; measure one, e.g. h_yx");
  const Index count = lines.omega.size();
  if (const double end = lines.omega[count - 1] / kTwoPi; end < kLeastEnd)
    doubts.push_back(sentence("the responses end at ", end, " Hz: are their frequencies in Hz?"));
  std::vector<double> spacing;
  for (Index n = 1; n < count; ++n) spacing.push_back(lines.omega[n] - lines.omega[n - 1]);
  const double usual = median(spacing);
  for (Index n = 1; n < count; ++n) {
    const std::size_t k = static_cast<std::size_t>(n - 1);
    const double around =
        std::max({usual, k > 0 ? spacing[k - 1] : 0.0, k + 1 < spacing.size() ? spacing[k + 1] : 0.0});
    if (spacing[k] > kGap * around)
      doubts.push_back(sentence("nothing was measured between ", lines.omega[n - 1] / kTwoPi, " and ",
                                lines.omega[n] / kTwoPi, " Hz: a mode there is not seen"));
  }
  return doubts;
}

}  // namespace stillcut
