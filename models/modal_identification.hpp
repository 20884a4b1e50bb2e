// Modes from measured frequency responses: how many there are, their frequency, damping, stiffness and direction, and
// how sure each figure is. docs/modal-identification.md has the equations.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "dsp/numbers.hpp"
#include "models/dynamics_map.hpp"
#include "models/frequency_response.hpp"
#include "models/response_checks.hpp"
#include "models/stabilization_chart.hpp"

namespace stillcut {

// One standard deviation of every figure of a mode, in the units of Mode.
struct ModeDeviation {
  double natural_frequency = 0.0;  // rad/s
  double damping_ratio = 0.0;
  double stiffness = 0.0;  // N/m
  double direction = 0.0;  // rad, root mean square angle off the true direction
};

struct IdentifiedMode {
  Mode mode;  // the direction's largest component is positive
  ModeDeviation deviation;
};

// Motion below and above the band, beside the modes: mass line and static compliance of each measured entry.
//   residual(w) = -inertia/w^2 + compliance
struct ResidualTerms {
  std::array<std::array<double, 3>, 3> inertia{};     // 1/kg, 0: none
  std::array<std::array<double, 3>, 3> compliance{};  // m/N, 0: none
};

struct IdentificationSettings {
  double lowest_hz = 0.0, highest_hz = kInfinity;  // the band that is fitted
  int most_order = 12;                             // of the stabilization chart: pairs of poles an octave
  std::vector<double> poles_hz{};                  // the operator's choice; empty: chosen by the chart
  PoleMethod method = PoleMethod::lscf;            // what the chart is made of
};

struct ModalFit {
  std::vector<IdentifiedMode> modes;  // rising frequency; what an exponential window added to their decay is off
  std::vector<Mode> as_measured;      // with it: what goes through the measured responses
  ResidualTerms residual;
  StabilizationChart chart;
  ResponseChecks checks;
  std::vector<std::size_t> lines;                           // of the response, that were fitted
  std::array<std::array<std::vector<double>, 3>, 3> noise;  // m/N at those lines: root mean square error of H
  double misfit = 0.0;              // root mean square of the difference, over that of the response
  std::vector<std::string> doubts;  // whole sentences for the operator
};

// `progress` is told the share done, 0 to 1. Throws std::invalid_argument, in words for the operator, for a response
// that is not sound, a band with too few lines, directions that the measured entries leave open altogether, poles
// asked for outside the band, and where no mode stands out of the noise.
[[nodiscard]] ModalFit identify_modes(const FrequencyResponse& response, const IdentificationSettings& settings = {},
                                      const std::function<void(double)>& progress = {});

// The fitted receptance of an entry, m/N: modes as measured and residual terms.
[[nodiscard]] ComplexValues fitted_receptance(const ModalFit& fit, int response_axis, int force_axis,
                                              const std::vector<double>& frequencies_hz);

}  // namespace stillcut
