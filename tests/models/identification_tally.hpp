// How the errors of identified modes stand beside the least that are possible, over many structures.
#pragma once

#include <limits>

#include "models/peak_picking.hpp"
#include "tests/models/measured_modes.hpp"

namespace stillcut {

// What is asked where the least possible error is a third of it or less (issue 10): relative; direction in rad.
struct AskedAccuracy {
  double frequency, damping, stiffness, direction = 2.0 * kTwoPi / 360.0;
};
inline AskedAccuracy asked_at(double signal_to_noise_db) {
  return signal_to_noise_db > 45.0 ? AskedAccuracy{1e-4, 5e-3, 5e-3} : AskedAccuracy{1e-3, 3e-2, 3e-2};
}

struct IdentificationTally {
  int modes = 0;               // of the structures
  int tellable = 0, told = 0;  // that stand out of the noise ten times as far as a mode costs; found of these
  int found = 0, spurious = 0;
  std::array<int, kModeFigures> within_two{}, covered{};  // of those found: two least errors; 1.96 stated ones
  std::array<double, kModeFigures> squares{};             // of errors over least errors, at most 100 each
  int asked = 0, kept = 0;                                // modes to which the asked accuracy applies; that have it
  int elsewhere = 0;
  std::array<int, kModeFigures> covered_elsewhere{};
  int picked = 0;                                                    // found by peak picking
  std::array<double, kModeFigures> picked_squares{}, own_squares{};  // of errors of modes that both found
};

// The nearest of the modes left, by half-widths and direction; a mode more than two of both away is another one.
inline std::size_t nearest_of(const std::vector<Mode>& left, const Mode& truth) {
  std::size_t best = left.size();
  double least = 2.0;
  for (std::size_t k = 0; k < left.size(); ++k) {
    if (!(left[k].stiffness > 0.0)) continue;  // taken
    const ModeFigures error = errors_of(left[k], truth);
    const double apart = std::abs(error[0]) / truth.damping_ratio + 1.0 - std::cos(error[3]);
    if (apart < least) {
      least = apart;
      best = k;
    }
  }
  return best;
}

inline void count_modes(IdentificationTally& tally, const MeasuredStructure& structure, const ModalFit& fit,
                        double signal_to_noise_db) {
  const LikelihoodFit truth = fit_likelihood(model_of(structure.modes), structure.lines, structure.weights, {0, 1.0});
  const AskedAccuracy asked = asked_at(signal_to_noise_db);
  const ModeFigures limits{asked.frequency, asked.damping, asked.stiffness, asked.direction};
  const double price =
      kTermParameters * std::log(2.0 * static_cast<double>(structure.lines.omega.size() * structure.weights.size()));
  std::vector<std::size_t> order(structure.modes.size());
  for (std::size_t r = 0; r < order.size(); ++r) order[r] = r;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return significance(truth, a) > significance(truth, b); });
  std::vector<Mode> left, picked = pick_peaks(structure.response);
  for (const IdentifiedMode& mode : fit.modes) left.push_back(mode.mode);
  for (const std::size_t r : order) {
    const Mode& mode = structure.modes[r];
    const ModeFigures least = least_errors(truth, r);
    const bool tellable = significance(truth, r) > 10.0 * price;
    tally.modes += 1;
    tally.tellable += tellable ? 1 : 0;
    const std::size_t at = nearest_of(left, mode);
    if (at == left.size()) continue;
    left[at].stiffness = 0.0;
    tally.found += 1;
    tally.told += tellable ? 1 : 0;
    const ModeFigures error = errors_of(fit.modes[at].mode, mode), stated = stated_errors(fit.modes[at]);
    bool applies = true, kept = true;
    for (std::size_t k = 0; k < kModeFigures; ++k) {
      applies = applies && least[k] <= limits[k] / 3.0;
      kept = kept && std::abs(error[k]) <= limits[k];
      tally.within_two[k] += std::abs(error[k]) <= 2.0 * least[k] ? 1 : 0;
      tally.covered[k] += std::abs(error[k]) <= 1.96 * stated[k] ? 1 : 0;
      tally.squares[k] += std::min(100.0, std::pow(error[k] / least[k], 2));
    }
    tally.asked += applies ? 1 : 0;
    tally.kept += applies && kept ? 1 : 0;
    tally.elsewhere += applies ? 0 : 1;
    if (!applies)
      for (std::size_t k = 0; k < kModeFigures; ++k)
        tally.covered_elsewhere[k] += std::abs(error[k]) <= 1.96 * stated[k] ? 1 : 0;
    if (const std::size_t peak = nearest_of(picked, mode); peak < picked.size()) {
      const ModeFigures of_peak = errors_of(picked[peak], mode);
      picked[peak].stiffness = 0.0;
      tally.picked += 1;
      for (std::size_t k = 0; k < kModeFigures; ++k) {
        tally.picked_squares[k] += of_peak[k] * of_peak[k];
        tally.own_squares[k] += error[k] * error[k];
      }
    }
  }
  for (const Mode& mode : left) tally.spurious += mode.stiffness > 0.0 ? 1 : 0;
}

}  // namespace stillcut
