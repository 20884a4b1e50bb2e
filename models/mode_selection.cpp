#include "models/mode_selection.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>

#include "models/frf_noise.hpp"
#include "models/mode_search.hpp"

namespace stillcut {
namespace {

constexpr std::size_t kMostTerms = 40;
constexpr int kMostSelectionRounds = 60, kMostDrops = 6;
// Of a fit that is gone on with anyway, and of one that decides whether a mode is worth its price (50 or more).
constexpr FitEffort kQuick{12, 1.0, 1e-3}, kDeciding{30, 1.0, 1e-4}, kLast{40, 1e-3, 1e-9};
constexpr std::size_t kMostTried = 3;  // dampings of a missing mode
constexpr std::size_t kMostSplit = 3;  // terms
constexpr double kSplitApart = 0.01;   // half of what close modes are apart
constexpr double kHonestChi = 4.0;     // times the number of values: noise taken from differences is rough
constexpr double kLeastOfResponse = 2e-3, kMostSizeDeviation = 1.0;
constexpr double kMostTermDamping = 0.6;
constexpr double kLeastTermDamping = 2e-5;

void refit(SelectedModes& modes, const FrfLines& lines, const FitEffort& effort = kQuick) {
  modes.fit = fit_likelihood(std::move(modes.fit.model), lines, modes.weights, effort);
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

// What is less of the response than instruments are true to corrects another mode's shape and is none of the structure.
double worth_of(const SelectedModes& modes, std::size_t r, const FrfLines& lines) {
  const ModalTerm& term = modes.fit.model.terms[r];
  if (!can_be_mode(term.pole, lines) || share_of_response(modes.fit.model, term) < kLeastOfResponse) return 0.0;
  return size_deviation(modes.fit, r) < kMostSizeDeviation ? significance(modes.fit, r) : 0.0;
}

// The weakest first; tells whether any was taken away.
bool drop_needless(SelectedModes& modes, const FrfLines& lines) {
  bool dropped = false;
  std::vector<ModalTerm>& terms = modes.fit.model.terms;
  while (!terms.empty()) {
    std::size_t weakest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t r = 0; r < terms.size(); ++r) {
      const double told = worth_of(modes, r, lines);
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

// What the model leaves over, as lines.
FrfLines remainder(const ModalModel& model, const FrfLines& lines) {
  FrfLines rest = lines;
  const std::vector<Eigen::VectorXcd> left = left_over(model, lines);
  for (std::size_t e = 0; e < left.size(); ++e) rest.entries[e].values = left[e];
  return rest;
}

// With terms at these poles beside the model's own, if that is worth one more mode.
bool take_if_worth(SelectedModes& modes, const FrfLines& lines, ModalModel model, const std::vector<Pole>& poles) {
  for (const ModalTerm& term : model_of_poles(poles, remainder(model, lines), modes.weights).terms)
    model.terms.push_back(term);
  LikelihoodFit fit = fit_likelihood(std::move(model), lines, modes.weights, kDeciding);
  // While others are missing a term may be driven out to stand for them: it goes, and is asked for again.
  const auto gone =
      std::erase_if(fit.model.terms, [&](const ModalTerm& term) { return !can_be_mode(term.pole, lines); });
  if (gone > 0) fit = fit_likelihood(std::move(fit.model), lines, modes.weights, kDeciding);
  if (modes.fit.chi_square - fit.chi_square < price_of(modes, kTermParameters)) return false;
  modes.fit = std::move(fit);
  return true;
}

// Two close modes that were fitted as one leave a remainder that a third cannot explain: the terms nearest to it, in
// half-widths, are tried as two.
bool split_near(SelectedModes& modes, const FrfLines& lines, const Pole& missing) {
  const auto half_widths = [&](const ModalTerm& term) {
    return std::abs(std::log(term.pole.natural_frequency / missing.natural_frequency)) / term.pole.damping_ratio;
  };
  std::vector<ModalTerm> terms = modes.fit.model.terms;
  std::sort(terms.begin(), terms.end(),
            [&](const ModalTerm& a, const ModalTerm& b) { return half_widths(a) < half_widths(b); });
  for (std::size_t k = 0; k < std::min(kMostSplit, terms.size()); ++k) {
    ModalModel without = modes.fit.model;
    std::erase_if(without.terms, [&](const ModalTerm& term) {
      return term.pole.natural_frequency == terms[k].pole.natural_frequency && term.root == terms[k].root;
    });
    const Pole& pole = terms[k].pole;
    for (const double apart : {0.5 * pole.damping_ratio, kSplitApart}) {
      const std::vector<Pole> two{{pole.natural_frequency * (1.0 - apart), pole.damping_ratio},
                                  {pole.natural_frequency * (1.0 + apart), pole.damping_ratio}};
      if (take_if_worth(modes, lines, without, two)) return true;
    }
  }
  return false;
}

// Where the remainder asks for one most; tells whether it was worth it.
bool add_missing(SelectedModes& modes, const FrfLines& lines) {
  if (modes.fit.model.terms.size() >= kMostTerms) return false;
  const double price = price_of(modes, kTermParameters);
  const std::vector<MissingMode> missing = missing_modes(left_over(modes.fit.model, lines), lines, modes.weights);
  for (std::size_t k = 0; k < std::min(kMostTried, missing.size()) && missing[k].gain > 0.5 * price; ++k)
    if (take_if_worth(modes, lines, modes.fit.model, {missing[k].pole})) return true;
  return !missing.empty() && missing.front().gain > price && split_near(modes, lines, missing.front().pole);
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
    LikelihoodFit fit = fit_likelihood(std::move(less), lines, modes.weights, kDeciding);
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
  return parameters * std::log(values) * modes.alike * std::max(1.0, modes.fit.chi_square / (kHonestChi * values));
}

double share_of_response(const ModalModel& model, const ModalTerm& term) {
  const Eigen::VectorXd at = Eigen::VectorXd::Constant(1, term.pole.natural_frequency);
  Eigen::Matrix3cd sum = Eigen::Matrix3cd::Zero();
  for (const ModalTerm& other : model.terms)
    sum += pole_response(other.pole, at)[0] * (other.root * other.root.transpose()).cast<std::complex<double>>();
  return term.root.squaredNorm() / (2.0 * term.pole.damping_ratio * sum.norm());
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
  int drops = 0;  // what is added and dropped in turn would go on for ever
  for (int round = 0; round < kMostSelectionRounds && drops < kMostDrops; ++round) {
    weigh_roughly(modes, lines);
    refit(modes, lines);
    const bool dropped = drop_needless(modes, lines);
    drops += dropped ? 1 : 0;
    if (!add_missing(modes, lines) && !dropped) break;
    if (progress) progress(0.3 + 0.5 * round / kMostSelectionRounds);
  }
  // Weights and modes, each by the other's last word.
  for (int round = 0; round < 3; ++round) {
    weigh(modes, lines);
    refit(modes, lines);
    drop_needless_residuals(modes, lines);
    drop_needless(modes, lines);
  }
  refit(modes, lines, kLast);
  return modes;
}

SelectedModes fit_poles(const FrfLines& lines, const std::vector<Pole>& poles, const FrfWeights& weights) {
  SelectedModes modes = started(lines, poles, weights);
  weigh_roughly(modes, lines);
  refit(modes, lines, kLast);
  for (int round = 0; round < 3; ++round) {
    weigh(modes, lines);
    refit(modes, lines);
    drop_needless_residuals(modes, lines);
  }
  refit(modes, lines, kLast);
  return modes;
}

}  // namespace stillcut
