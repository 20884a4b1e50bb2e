// Modes of structures that are known, out of their noisy responses (issue 10, point 1; docs/modal-identification.md has
// the whole table, of identification_campaign).
#include "models/modal_identification.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "identification_tally.hpp"
#include "tests/sanitized.hpp"

namespace stillcut {
namespace {

Mode mode_at(double hz, double damping, double stiffness, Eigen::Vector3d u) {
  u.normalize();
  return {kTwoPi * hz, damping, stiffness, {u[0], u[1], u[2]}};
}

std::vector<Mode> robot_with_tool() {
  return {mode_at(12.0, 0.03, 1.2e6, {1.0, 0.3, -0.2}), mode_at(55.0, 0.04, 3e6, {0.2, 1.0, 0.1}),
          mode_at(498.0, 0.03, 2e7, {1.0, 0.1, 0.0}), mode_at(508.0, 0.03, 1.8e7, {-0.1, 1.0, 0.0})};
}

MeasuredStructure measured_robot(const MeasuringPlan& plan = {.spacing_hz = 0.5, .lines = 1600}) {
  std::mt19937_64 random(7);
  return measured(robot_with_tool(), plan, random);
}

std::string refusal(const FrequencyResponse& response, const IdentificationSettings& settings = {}) {
  try {
    static_cast<void>(identify_modes(response, settings));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(ModalIdentification, ErrorsAreThoseOfTheCramerRaoBound) {
  for (const auto& [noise, db] : {std::pair{NoiseKind::even, 60.0}, std::pair{NoiseKind::relative, 30.0},
                                  std::pair{NoiseKind::of_acceleration, 60.0}}) {
    IdentificationTally tally;
    for (unsigned seed = 1; seed <= (test::kSanitized ? 2 : 12); ++seed) {
      std::mt19937_64 random(seed);
      const MeasuringPlan plan{noise, db, 3, 0.5, 4096};
      const MeasuredStructure structure = measured(random_modes(random), plan, random);
      count_modes(tally, structure, identify_modes(structure.response), db);
    }
    ASSERT_GT(tally.found, test::kSanitized ? 4 : 30);
    EXPECT_EQ(tally.told, tally.tellable);
    EXPECT_EQ(tally.spurious, 0);
    EXPECT_EQ(tally.kept, tally.asked);
    for (std::size_t k = 0; k < kModeFigures; ++k) {
      EXPECT_LT(std::sqrt(tally.squares[k] / tally.found), 1.4) << "figure " << k << " at " << db << " dB";
      if (!test::kSanitized) {
        EXPECT_GT(tally.covered[k], 0.87 * tally.found) << "figure " << k << " at " << db << " dB";
      }
    }
  }
}

TEST(ModalIdentification, PolynomialsLeadToTheSameModes) {
  const MeasuredStructure structure = measured_robot();
  const ModalFit lscf = identify_modes(structure.response),
                 other = identify_modes(structure.response, {.method = PoleMethod::polynomials});
  ASSERT_EQ(other.modes.size(), lscf.modes.size());
  for (std::size_t r = 0; r < lscf.modes.size(); ++r)
    for (const double error : errors_of(other.modes[r].mode, lscf.modes[r].mode)) EXPECT_LT(std::abs(error), 1e-5);
}

TEST(ModalIdentification, TheOperatorsPolesAreFittedAndNoOthers) {
  const MeasuredStructure structure = measured_robot();
  const ModalFit fit = identify_modes(structure.response, {.lowest_hz = 300.0, .poles_hz = {495.0, 510.0}});
  ASSERT_EQ(fit.modes.size(), 2U);
  for (std::size_t r = 0; r < 2; ++r) {
    const ModeFigures error = errors_of(fit.modes[r].mode, structure.modes[2 + r]);
    EXPECT_LT(std::abs(error[0]), 1e-3);
    EXPECT_LT(std::abs(error[2]), 2e-2);
  }
  const ModalFit odd = identify_modes(structure.response, {.poles_hz = {12, 55, 200, 498, 508}});
  EXPECT_THAT(odd.doubts, testing::Contains(testing::HasSubstr("asked for at 200 Hz")));
}

TEST(ModalIdentification, WhatLiesOutsideTheBandIsNoMode) {
  const MeasuredStructure structure = measured_robot();
  const ModalFit fit = identify_modes(structure.response, {.lowest_hz = 30.0, .highest_hz = 200.0});
  ASSERT_EQ(fit.modes.size(), 1U);
  EXPECT_LT(std::abs(errors_of(fit.modes[0].mode, structure.modes[1])[2]), 0.01);
  EXPECT_GT(fit.residual.compliance[0][0], 0.0);
  EXPECT_GT(fit.residual.inertia[0][0], 0.0);
}

TEST(ModalIdentification, FittedResponseGoesThroughTheMeasuredOne) {
  const MeasuredStructure structure = measured_robot();
  const ModalFit fit = identify_modes(structure.response);
  const ComplexValues fitted = fitted_receptance(fit, 1, 0, structure.response.frequencies_hz);
  double off = 0.0;
  for (std::size_t n = 0; n < fitted.size(); ++n)
    off += std::norm((fitted[n] - structure.response.receptance[1][0][n]) / fit.noise[1][0][n]);
  EXPECT_NEAR(off / static_cast<double>(fitted.size()), 1.0, 0.2);
  EXPECT_NEAR(fit.misfit, 1e-3, 2e-4);
}

TEST(ModalIdentification, DampingOfAnExponentialWindowIsTakenOff) {
  std::vector<Mode> windowed;
  const double decay = 1.5;
  for (const Mode& own : robot_with_tool()) {
    // The mode that the window makes of it: damped frequency and modal mass stay (docs/tap-tests.md).
    const double w = own.natural_frequency, rate = own.damping_ratio * w, mass = own.stiffness / (w * w);
    const double square = w * w - rate * rate + (rate + decay) * (rate + decay);
    windowed.push_back({std::sqrt(square), (rate + decay) / std::sqrt(square), mass * square, own.direction});
  }
  std::mt19937_64 random(3);
  MeasuredStructure structure = measured(windowed, {.spacing_hz = 0.5, .lines = 1600}, random);
  structure.response.added_decay_per_s = decay;
  const ModalFit fit = identify_modes(structure.response);
  ASSERT_EQ(fit.modes.size(), 4U);
  for (std::size_t r = 0; r < 4; ++r) {
    const ModeFigures error = errors_of(fit.modes[r].mode, robot_with_tool()[r]), stated = stated_errors(fit.modes[r]);
    for (std::size_t k = 0; k < kModeFigures; ++k) EXPECT_LT(std::abs(error[k]), 3.5 * stated[k]) << r << ' ' << k;
  }
  structure.response.added_decay_per_s = 4.0;  // more than the lowest has
  EXPECT_THAT(identify_modes(structure.response).doubts, testing::Contains(testing::HasSubstr("record longer")));
}

TEST(ModalIdentification, WhatWasNotMeasuredIsSaid) {
  MeasuredStructure structure = measured_robot();
  FrequencyResponse direct = structure.response;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      if (i != j || i == 2) direct.receptance[i][j].clear();
  const ModalFit fit = identify_modes(direct);
  EXPECT_THAT(fit.doubts, testing::Contains(testing::HasSubstr("nothing was measured along z")));
  EXPECT_THAT(fit.doubts, testing::Contains(testing::HasSubstr("signs")));
  for (const IdentifiedMode& mode : fit.modes) EXPECT_EQ(mode.mode.direction[2], 0.0);
  direct.receptance[0][0].clear();
  direct.receptance[0][2] = structure.response.receptance[0][2];
  EXPECT_THAT(refusal(direct), testing::HasSubstr("leave stiffness along x open"));
}

TEST(ModalIdentification, AGapBetweenTheLinesIsSaid) {
  MeasuredStructure structure = measured_robot();
  FrequencyResponse gap;
  for (std::size_t n = 0; n < structure.response.frequencies_hz.size(); ++n) {
    if (n > 200 && n < 260) continue;
    gap.frequencies_hz.push_back(structure.response.frequencies_hz[n]);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) gap.receptance[i][j].push_back(structure.response.receptance[i][j][n]);
  }
  const ModalFit fit = identify_modes(gap);
  EXPECT_EQ(fit.modes.size(), 4U);
  EXPECT_THAT(fit.doubts, testing::Contains(testing::HasSubstr("nothing was measured between 100.5 and 130.5 Hz")));
}

TEST(ModalIdentification, AResponseMeasuredBothWaysThatDiffersIsSaid) {
  const auto tells = testing::Contains(testing::HasSubstr("xy and yx differ"));
  MeasuredStructure structure = measured_robot();
  EXPECT_THAT(identify_modes(structure.response).doubts, testing::IsEmpty());
  for (std::complex<double>& value : structure.response.receptance[0][1]) value = -value;
  EXPECT_THAT(identify_modes(structure.response).doubts, tells);
  for (std::complex<double>& value : structure.response.receptance[0][1]) value = 0.0;
  EXPECT_THAT(identify_modes(structure.response).doubts, tells);
}

TEST(ModalIdentification, MoreModesThanAreFittedAreSaid) {
  std::vector<Mode> many;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  double hz = 20.0;
  for (int r = 0; r < 60; ++r, hz *= 1.06)
    many.push_back(mode_at(hz, 0.01, 1e7, {normal(random), normal(random), normal(random)}));
  const MeasuredStructure structure = measured(many, {.force_axes = 1, .spacing_hz = 1.0, .lines = 700}, random);
  EXPECT_THAT(identify_modes(structure.response).doubts, testing::Contains(testing::HasSubstr("modes are missing")));
}

TEST(ModalIdentification, FrequenciesThatAreNotInHertzAreSaid) {
  MeasuredStructure structure = measured_robot();
  for (double& hz : structure.response.frequencies_hz) hz *= 1e-3;
  EXPECT_THAT(identify_modes(structure.response).doubts, testing::Contains(testing::HasSubstr("in Hz?")));
}

TEST(ModalIdentification, AModeAskedForManyTimesIsFiniteOrLeftOut) {
  FrequencyResponse response = measured_robot({.spacing_hz = 1.0, .lines = 1000}).response;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      if (i + j > 0) response.receptance[i][j].clear();
  bool left_out = false;
  for (const double hz : {12.0, 55.0, 200.0, 498.0}) {
    const ModalFit fit = identify_modes(response, {.poles_hz = {hz, hz, hz}});
    for (const Mode& mode : fit.as_measured) EXPECT_TRUE(std::isfinite(mode.stiffness)) << hz;
    left_out = left_out || fit.as_measured.size() < 3;
  }
  EXPECT_TRUE(left_out);
}

TEST(ModalIdentification, WhatIsNoReceptanceIsRefused) {
  const MeasuredStructure structure = measured_robot();
  const auto turned = [&](auto&& by) {
    FrequencyResponse response = structure.response;
    for (auto& row : response.receptance)
      for (ComplexValues& entry : row)
        for (std::size_t n = 0; n < entry.size(); ++n) entry[n] = by(entry[n], kTwoPi * response.frequencies_hz[n]);
    return response;
  };
  using Complex = std::complex<double>;
  EXPECT_THAT(refusal(turned([](Complex h, double) { return -h; })), testing::HasSubstr("wrong sign"));
  EXPECT_THAT(refusal(turned([](Complex h, double w) { return -w * w * h; })), testing::HasSubstr("accelerance"));
  EXPECT_THAT(refusal(turned([](Complex h, double w) { return Complex(0.0, w) * h; })), testing::HasSubstr("mobility"));
  EXPECT_THAT(refusal(turned([](Complex h, double) { return 1.0 / h; })), testing::HasSubstr("swapped"));
}

TEST(ModalIdentification, NoiseAloneHasNoModes) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  MeasuredStructure structure = measured_robot();
  for (auto& row : structure.response.receptance)
    for (ComplexValues& entry : row)
      for (std::complex<double>& value : entry) value = 1e-7 * std::complex<double>(normal(random), normal(random));
  EXPECT_THAT(refusal(structure.response), testing::HasSubstr("no mode stands out of the noise"));
}

TEST(ModalIdentification, TooFewLinesAndPolesOutsideAreRefused) {
  const MeasuredStructure structure = measured_robot();
  EXPECT_THAT(refusal(structure.response, {.lowest_hz = 100.0, .highest_hz = 105.0}),
              testing::HasSubstr("only 11 lines in the band"));
  EXPECT_THAT(refusal(structure.response, {.poles_hz = {55.0, 5000.0}}), testing::HasSubstr("5000 Hz"));
}

TEST(PeakPicking, ReadsASingleModeOffItsPeak) {
  std::mt19937_64 random(1);
  const MeasuredStructure structure =
      measured({mode_at(120.0, 0.02, 4e6, {1.0, 1.0, 0.0})}, {NoiseKind::even, 90.0, 3, 0.05, 8000}, random);
  const std::vector<Mode> modes = pick_peaks(structure.response);
  ASSERT_EQ(modes.size(), 1U);
  const ModeFigures error = errors_of(modes[0], structure.modes[0]);
  EXPECT_LT(std::abs(error[0]), 1e-3);
  EXPECT_LT(std::abs(error[1]), 0.01);
  EXPECT_LT(std::abs(error[2]), 0.01);
  EXPECT_LT(error[3], 0.01);
}

}  // namespace
}  // namespace stillcut
