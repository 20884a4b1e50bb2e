#include "models/mode_selection.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "models/frf_noise.hpp"
#include "models/mode_search.hpp"

namespace stillcut {
namespace {

constexpr std::size_t kMostTerms = 40;
constexpr int kMostRounds = 60;
constexpr int kQuickSteps = 12;  // of a fit that is gone on with anyway
constexpr int kMostSteps = 40;
constexpr double kMostTermDamping = 0.3;
constexpr double kLeastTermDamping = 2e-5;

void refit(SelectedModes& modes, const FrfLines& lines, int steps = kQuickSteps) {
  modes.fit = fit_likelihood(std::move(modes.fit.model), lines, modes.weights, steps);
}

// While modes are still missing.
void weigh_roughly(SelectedModes& modes, const FrfLines& lines) {
  modes.weights = weights_of(noise_of_differences(lines, left_over(modes.fit.model, lines)));
}

// Once the remainder is noise.
void weigh(SelectedModes& modes, const FrfLines& lines) {
  const std::vector<Eigen::VectorXcd> rest = left_over(modes.fit.model, lines);
  modes.weights = weights_of(noise_of_remainder(lines, rest));
  modes.alike = lines_alike(rest, modes.weights);
}

// The weakest first; tells whether any was taken away.
bool drop_needless(SelectedModes& modes, const FrfLines& lines) {
  bool dropped = false;
  std::vector<ModalTerm>& terms = modes.fit.model.terms;
  while (!terms.empty()) {
    std::size_t weakest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t r = 0; r < terms.size(); ++r) {
      const double told = can_be_mode(terms[r].pole, lines) ? significance(modes.fit, r) : 0.0;
      if (told < least) {
        least = told;
        weakest = r;
      }
    }
    if (least >= price_of(modes, kTermParameters)) break;
    terms.erase(terms.begin() + static_cast<std::ptrdiff_t>(weakest));
    refit(modes, lines);
    dropped = true;
  }
  return dropped;
}

// Where the remainder asks for it most; tells whether it was worth it.
bool add_missing(SelectedModes& modes, const FrfLines& lines) {
  if (modes.fit.model.terms.size() >= kMostTerms) return false;
  const double price = price_of(modes, kTermParameters);
  const std::vector<Eigen::VectorXcd> left = left_over(modes.fit.model, lines);
  const std::optional<MissingMode> missing = missing_mode(left, lines, modes.weights);
  if (!missing || missing->gain < 0.5 * price) return false;
  FrfLines rest = lines;
  for (std::size_t e = 0; e < left.size(); ++e) rest.entries[e].values = left[e];
  ModalModel more = modes.fit.model;
  more.terms.push_back(model_of_poles({missing->pole}, rest, modes.weights).terms.front());
  LikelihoodFit fit = fit_likelihood(std::move(more), lines, modes.weights, kMostSteps);
  for (const ModalTerm& term : fit.model.terms)
    if (!can_be_mode(term.pole, lines)) return false;
  if (modes.fit.chi_square - fit.chi_square < price) return false;
  modes.fit = std::move(fit);
  return true;
}

// Residual terms stay only where they explain something.
void drop_needless_residuals(SelectedModes& modes, const FrfLines& lines) {
  std::array<bool, 6> places{};
  for (const FrfEntry& entry : lines.entries)
    places[static_cast<std::size_t>(symmetric_place(entry.response, entry.force))] = true;
  const auto parameters = static_cast<double>(std::count(places.begin(), places.end(), true));
  for (bool ModalModel::*has : {&ModalModel::has_inertia, &ModalModel::has_compliance}) {
    if (!(modes.fit.model.*has)) continue;
    ModalModel less = modes.fit.model;
    less.*has = false;
    LikelihoodFit fit = fit_likelihood(std::move(less), lines, modes.weights, kMostSteps);
    if (fit.chi_square - modes.fit.chi_square < price_of(modes, parameters)) modes.fit = std::move(fit);
  }
}

SelectedModes started(const FrfLines& lines, const std::vector<Pole>& poles, const FrfWeights& weights) {
  SelectedModes modes;
  modes.weights = weights;
  modes.fit.model = model_of_poles(poles, lines, weights);
  modes.fit.model.has_inertia = modes.fit.model.has_compliance = true;
  refit(modes, lines);
  return modes;
}

}  // namespace

double price_of(const SelectedModes& modes, double parameters) {
  double values = 0.0;
  for (const Eigen::VectorXd& weight : modes.weights) values += 2.0 * static_cast<double>(weight.size());
  return parameters * std::log(values) * modes.alike;
}

bool can_be_mode(const Pole& pole, const FrfLines& lines) {
  return pole.natural_frequency >= lines.omega[0] && pole.natural_frequency <= lines.omega[lines.omega.size() - 1] &&
         pole.damping_ratio < kMostTermDamping && pole.damping_ratio > kLeastTermDamping;
}

FrfWeights rough_weights(const FrfLines& lines) {
  SelectedModes nothing;
  weigh_roughly(nothing, lines);
  return nothing.weights;
}

SelectedModes select_modes(const FrfLines& lines, const std::vector<Pole>& start, const FrfWeights& weights,
                           const std::function<void(double)>& progress) {
  SelectedModes modes = started(lines, start, weights);
  for (int round = 0; round < kMostRounds; ++round) {
    weigh_roughly(modes, lines);
    refit(modes, lines);
    const bool dropped = drop_needless(modes, lines);
    if (!add_missing(modes, lines) && !dropped) break;
    if (progress) progress(0.3 + 0.5 * round / kMostRounds);
  }
  // Weights and modes, each by the other's last word.
  for (int round = 0; round < 3; ++round) {
    weigh(modes, lines);
    refit(modes, lines);
    drop_needless_residuals(modes, lines);
    drop_needless(modes, lines);
  }
  refit(modes, lines, kMostSteps);
  return modes;
}

SelectedModes fit_poles(const FrfLines& lines, const std::vector<Pole>& poles, const FrfWeights& weights) {
  SelectedModes modes = started(lines, poles, weights);
  weigh_roughly(modes, lines);
  refit(modes, lines, kMostSteps);
  for (int round = 0; round < 3; ++round) {
    weigh(modes, lines);
    refit(modes, lines);
    drop_needless_residuals(modes, lines);
  }
  refit(modes, lines, kMostSteps);
  return modes;
}

}  // namespace stillcut
