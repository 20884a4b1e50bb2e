#include "models/modal_identification.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "models/chart_poles.hpp"
#include "models/frf_noise.hpp"
#include "models/machining.hpp"
#include "models/mode_selection.hpp"
#include "models/sentence.hpp"
#include "models/tap_estimate.hpp"

namespace stillcut {
namespace {

using Eigen::Index;

constexpr Index kLeastFittedLines = 20;
constexpr double kDriftLines = 3.0, kAboveHighest = 1.5;
constexpr double kNearChartPole = 0.05;  // of the operator's frequency
constexpr double kFarFromAsked = 0.1;
constexpr double kManyAlike = 4.0;
// A remainder so far above what the lines say of their noise, and so much of the response, is structure.
constexpr double kAboveLineNoise = 2.0, kLeastMisfit = 0.03;
constexpr double kMostMisfit = 0.5;  // whatever the lines say: narrow resonances look like noise from line to line

std::vector<Pole> poles_of_chart(const StabilizationChart& chart) {
  std::vector<Pole> poles;
  for (const ChartPole& pole : agreed_poles(chart)) poles.push_back({pole.natural_frequency, pole.damping_ratio});
  return poles;
}

std::vector<Pole> poles_asked(const std::vector<double>& asked_hz, const StabilizationChart& chart,
                              const FrfLines& lines) {
  const std::vector<Pole> known = poles_of_chart(chart);
  std::vector<Pole> poles;
  for (const double hz : asked_hz) {
    Pole pole{kTwoPi * hz, 0.02};
    if (!can_be_mode(pole, lines))
      throw std::invalid_argument(sentence("a mode at ", hz, " Hz is asked for, outside the band of ",
                                           lines.omega[0] / kTwoPi, " to ",
                                           lines.omega[lines.omega.size() - 1] / kTwoPi, " Hz"));
    double nearest = kNearChartPole;
    for (const Pole& other : known)
      if (const double apart = std::abs(other.natural_frequency / (kTwoPi * hz) - 1.0); apart < nearest) {
        nearest = apart;
        pole = other;
      }
    poles.push_back(pole);
  }
  return poles;
}

IdentifiedMode identified(const SelectedModes& work, std::size_t r) {
  const ModalTerm& term = work.fit.model.terms[r];
  const Index p = kTermParameters * static_cast<Index>(r);
  const Eigen::MatrixXd covariance = work.alike * work.fit.covariance.block<kTermParameters, kTermParameters>(p, p);
  const double size = term.root.norm();
  Eigen::Vector3d u = term.root / size;
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - u * u.transpose();
  const Eigen::Matrix3d of_root = covariance.bottomRightCorner<3, 3>();
  IdentifiedMode result;
  result.deviation = {term.pole.natural_frequency * std::sqrt(covariance(0, 0)),
                      term.pole.damping_ratio * std::sqrt(covariance(1, 1)),
                      2.0 / (size * size * size) * std::sqrt(std::max(0.0, u.dot(of_root * u))),
                      std::sqrt(std::max(0.0, (across * of_root * across).trace())) / size};
  Index largest = 0;
  u.cwiseAbs().maxCoeff(&largest);
  if (u[largest] < 0.0) u = -u;
  result.mode = {term.pole.natural_frequency, term.pole.damping_ratio, 1.0 / (size * size), {u[0], u[1], u[2]}};
  return result;
}

// What an error of the force does that the lines about a mode share, as no remainder tells: turned by an angle the
// response looks like one of another frequency, by that angle in half-widths; damping goes with how the error changes
// over the half-width, which is at most of its own size. It is an error of the whole response: where a mode is a small
// share of that, it is a larger one of the mode.
void widen(IdentifiedMode& one, double force_error) {
  const auto widened = [&](double deviation, double by) { return std::hypot(deviation, by * force_error); };
  ModeDeviation& deviation = one.deviation;
  const Mode& mode = one.mode;
  deviation.natural_frequency = widened(deviation.natural_frequency, mode.damping_ratio * mode.natural_frequency);
  deviation.damping_ratio = widened(deviation.damping_ratio, mode.damping_ratio);
  deviation.stiffness = widened(deviation.stiffness, mode.stiffness);
  deviation.direction = widened(deviation.direction, 0.5);
}

// Modes rising in frequency, as they were measured and as they are.
void take_modes(ModalFit& result, const SelectedModes& work, double added_decay_per_s, double force_error) {
  std::vector<IdentifiedMode> measured;
  for (std::size_t r = 0; r < work.fit.model.terms.size(); ++r) {
    const ModalTerm& term = work.fit.model.terms[r];
    if (!std::isfinite(1.0 / term.root.squaredNorm())) {  // asked for, and nothing moves there
      result.doubts.push_back(sentence("the mode asked for at ", term.pole.natural_frequency / kTwoPi,
                                       " Hz came to nothing: left out; ask for it once"));
      continue;
    }
    measured.push_back(identified(work, r));
    widen(measured.back(), force_error / share_of_response(work.fit.model, term));
  }
  std::stable_sort(measured.begin(), measured.end(), [](const IdentifiedMode& a, const IdentifiedMode& b) {
    return a.mode.natural_frequency < b.mode.natural_frequency;
  });
  for (const IdentifiedMode& one : measured) {
    result.as_measured.push_back(one.mode);
    if (one.mode.damping_ratio * one.mode.natural_frequency <= added_decay_per_s) {
      result.doubts.push_back(sentence("the mode at ", one.mode.natural_frequency / kTwoPi,
                                       " Hz decays no faster than the exponential window alone: left out; record "
                                       "longer, or with a weaker window"));
      continue;
    }
    IdentifiedMode own = one;
    // The window moves decay and frequency, not how sure they are.
    own.mode = without_added_decay(one.mode, added_decay_per_s);
    own.deviation.damping_ratio *= one.mode.natural_frequency / own.mode.natural_frequency;
    own.deviation.stiffness *= own.mode.stiffness / one.mode.stiffness;
    result.modes.push_back(own);
  }
}

void fill_residual(ResidualTerms& residual, const ModalModel& model) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
      if (model.has_inertia) residual.inertia[a][b] = model.inertia[symmetric_place(i, j)];
      if (model.has_compliance) residual.compliance[a][b] = model.compliance[symmetric_place(i, j)];
    }
}

void add_doubts(ModalFit& result, const SelectedModes& work, const std::vector<double>& asked_hz) {
  if (work.alike > kManyAlike)
    result.doubts.push_back(
        sentence("what the modes leave over is no noise (", work.alike,
                 " neighbouring lines say the same): windowed, not linear, or more modes than were found; the stated "
                 "uncertainty is widened"));
  for (std::size_t k = 0; k < asked_hz.size(); ++k) {
    const double hz = work.fit.model.terms[k].pole.natural_frequency / kTwoPi;
    if (std::abs(hz / asked_hz[k] - 1.0) > kFarFromAsked)
      result.doubts.push_back(sentence("the mode asked for at ", asked_hz[k], " Hz went to ", hz, " Hz"));
    else if (significance(work.fit, k) < price_of(work, kTermParameters))
      result.doubts.push_back(sentence("the mode asked for at ", asked_hz[k], " Hz does not stand out of the noise"));
  }
}

// Taps with windows, as `stillcut tap` makes them: all lines up to the recorder's limit, whether or not the hammer
// excites them.
bool is_tapped(const FrequencyResponse& response) {
  return response.added_decay_per_s > 0.0 || response.force_error > 0.0;
}

// The first lines of taps hold what the sensors drift and step by over the record, divided by the square of the least
// frequencies.
double first_told_hz(const FrequencyResponse& response) {
  return is_tapped(response) ? kDriftLines * response.frequencies_hz.front() : 0.0;
}

// Far above the highest mode a tapped response is mass alone, told by what little force the hammer has there: its
// errors would be taken out on the stiffness of the lowest modes.
double last_told_hz(const FrequencyResponse& response, const StabilizationChart& chart) {
  const std::vector<ChartPole> agreed = agreed_poles(chart);
  return is_tapped(response) && !agreed.empty() ? kAboveHighest * agreed.back().natural_frequency / kTwoPi : kInfinity;
}

}  // namespace

ModalFit identify_modes(const FrequencyResponse& response, const IdentificationSettings& settings,
                        const std::function<void(double)>& progress) {
  require_sound_response(response);
  FrfLines lines = lines_between(response, std::max(settings.lowest_hz, first_told_hz(response)), settings.highest_hz);
  if (lines.omega.size() < kLeastFittedLines)
    throw std::invalid_argument(
        sentence("only ", lines.omega.size(), " lines in the band, at least ", kLeastFittedLines, " are needed"));
  FrfWeights weights = rough_weights(lines);
  require_receptance(lines, weights);
  ModalFit result;
  result.chart = chart_of(lines, weights, settings.most_order, settings.method);
  if (settings.highest_hz == kInfinity) {
    lines = lines_between(response, std::max(settings.lowest_hz, first_told_hz(response)),
                          last_told_hz(response, result.chart));
    weights = rough_weights(lines);
  }
  if (progress) progress(0.25);
  const SelectedModes work = settings.poles_hz.empty()
                                 ? select_modes(lines, poles_of_chart(result.chart), weights, progress)
                                 : fit_poles(lines, poles_asked(settings.poles_hz, result.chart, lines), weights);
  if (work.fit.model.terms.empty())
    throw std::invalid_argument("no mode stands out of the noise: hit harder, or average more hits");

  result.doubts = response_doubts(lines);
  take_modes(result, work, response.added_decay_per_s, response.force_error);
  fill_residual(result.residual, work.fit.model);
  result.checks = check_responses(lines, work.weights);
  result.lines = lines.lines;
  const std::vector<Eigen::VectorXcd> rest = left_over(work.fit.model, lines);
  double left = 0.0, all = 0.0;
  for (std::size_t e = 0; e < rest.size(); ++e) {
    const FrfEntry& entry = lines.entries[e];
    std::vector<double>& noise =
        result.noise[static_cast<std::size_t>(entry.response)][static_cast<std::size_t>(entry.force)];
    for (const double weight : work.weights[e]) noise.push_back(std::sqrt(2.0 / weight));
    left += rest[e].squaredNorm();
    all += entry.values.squaredNorm();
  }
  result.misfit = std::sqrt(left / all);
  // From line to line: the noise that was fitted with is the remainder itself, and takes whatever is left for noise.
  const std::vector<Eigen::VectorXd> line_noise = noise_of_differences(lines, rest);
  double expected = 0.0;
  for (const Eigen::VectorXd& variance : line_noise) expected += variance.sum();
  const bool structure_left = left > kAboveLineNoise * kAboveLineNoise * expected;
  if (result.misfit > kMostMisfit || (result.misfit > kLeastMisfit && structure_left))
    result.doubts.push_back(sentence(
        "the fit is off by ", 100.0 * result.misfit, " % of the responses, the noise from line to line is ",
        100.0 * std::sqrt(expected / all), " %: modes are missing or wrong; narrow the band, or choose the poles"));
  for (std::string& doubt : reciprocity_doubts(lines, weights_of(line_noise)))
    result.doubts.push_back(std::move(doubt));
  add_doubts(result, work, settings.poles_hz);
  if (progress) progress(1.0);
  return result;
}

ComplexValues fitted_receptance(const ModalFit& fit, int response_axis, int force_axis,
                                const std::vector<double>& frequencies_hz) {
  const auto i = static_cast<std::size_t>(response_axis), j = static_cast<std::size_t>(force_axis);
  ComplexValues values;
  values.reserve(frequencies_hz.size());
  for (const double hz : frequencies_hz) {
    const double w = kTwoPi * hz;
    std::complex<double> sum = fit.residual.compliance[i][j];
    if (fit.residual.inertia[i][j] != 0.0) sum -= fit.residual.inertia[i][j] / (w * w);
    for (const Mode& mode : fit.as_measured) {
      const double s = w / mode.natural_frequency;
      sum += mode.direction[i] * mode.direction[j] / mode.stiffness /
             std::complex<double>(1.0 - s * s, 2.0 * mode.damping_ratio * s);
    }
    values.push_back(sum);
  }
  return values;
}

}  // namespace stillcut
