// Cutting coefficients from slot tests: the milling simulation is the oracle for the mean forces, Table 1 of the
// surface paper for what must come back out of them.
#include "models/slot_coefficients.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "models/milling_simulation.hpp"
#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::array kPaperFeeds{0.02e-3, 0.04e-3, 0.06e-3, 0.08e-3, 0.10e-3};

// Table 1 of Liu et al. 2024.
const Material kTable1{
    .name = "Al7075-T6", .ktc = 1661.8e6, .krc = 1240.8e6, .kac = 19.1e6, .kte = 7.1e3, .kre = 15.9e3, .kae = 2.3e3};

Tool slot_tool(ToolShape shape, double helix_deg = 45.0) {
  Tool tool;
  tool.shape = shape;
  tool.diameter = 8e-3;
  tool.teeth = 2;
  tool.pitch = {0.5 * kTwoPi, 0.5 * kTwoPi};
  tool.helix = deg_to_rad(helix_deg);
  return tool;
}

// Mean force of a slot milled in time by a tool on a structure that does not give way.
Eigen::Vector3d milled_mean(const Tool& tool, double feed, double depth) {
  MillingSetup setup;
  setup.tool = tool;
  setup.material = kTable1;
  setup.cut = {.milling = Milling::slot,
               .radial_depth = tool.diameter,
               .axial_depth = depth,
               .feed_per_tooth = feed,
               .spindle_speed = rpm_to_rad_s(6000)};
  setup.modes = {{kTwoPi * 400, 0.05, 1e12, {1, 0, 0}},
                 {kTwoPi * 400, 0.05, 1e12, {0, 1, 0}},
                 {kTwoPi * 400, 0.05, 1e12, {0, 0, 1}}};
  constexpr int kTurn = 500, kTurns = 2;  // samples
  MillingSimulation cut(setup, 50e3);
  for (int i = 0; i < 2 * kTurn; ++i) cut.advance();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < kTurns * kTurn; ++i) sum += cut.advance().force;
  return sum / (kTurns * kTurn);
}

// Breaks with any sign, any of the eighteen integrals, the edge length under helix, or the shank above a ball.
TEST(SlotCoefficients, MeanForcesAreThoseOfTheMillingSimulation) {
  const SixCoefficients table1 = six_coefficients(kTable1);
  struct Case {
    ToolShape shape;
    double helix_deg, depth;
  };
  for (const auto& [shape, helix, depth] :
       {Case{ToolShape::end, 0, 1e-3}, Case{ToolShape::end, 45, 2e-3}, Case{ToolShape::ball, 45, 1e-3},
        Case{ToolShape::ball, 0, 0.2e-3}, Case{ToolShape::ball, 45, 4e-3}, Case{ToolShape::ball, 30, 6e-3}}) {
    const Tool tool = slot_tool(shape, helix);
    for (const double feed : {0.02e-3, 0.10e-3}) {
      const Eigen::Vector3d milled = milled_mean(tool, feed, depth);
      const Eigen::Vector3d predicted = slot_influence(tool, feed, depth) * table1;
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(predicted[axis], milled[axis], 0.005 * std::max(std::abs(milled[axis]), 0.1 * milled.norm()))
            << (shape == ToolShape::ball ? "ball" : "end") << ", helix " << helix << ", depth " << depth << ", feed "
            << feed << ", axis " << axis;
    }
  }
}

std::vector<SlotTest> noisy_tests(const Tool& tool, int repeats, const std::vector<double>& depths,
                                  const Eigen::Vector3d& noise, std::uint64_t seed) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> normal;
  std::vector<SlotTest> tests;
  for (int repeat = 0; repeat < repeats; ++repeat)
    for (const double depth : depths)
      for (const double feed : kPaperFeeds) {
        SlotTest& test =
            tests.emplace_back(SlotTest{feed, depth, slot_influence(tool, feed, depth) * six_coefficients(kTable1)});
        for (int axis = 0; axis < 3; ++axis) test.mean_force[axis] += noise[axis] * normal(random);
      }
  return tests;
}

// Breaks with an estimate that is off and with standard errors a fifth too small; the next test but one sees them too
// large.
TEST(SlotCoefficients, Table1ComesBackWithinTwoStandardErrorsAsOftenAsItShould) {
  struct Case {
    ToolShape shape;
    std::vector<double> depths;
  };
  constexpr int kSeeds = 150;
  for (const Case& made :
       {Case{ToolShape::ball, {1e-3}}, Case{ToolShape::end, {1e-3}}, Case{ToolShape::ball, {0.5e-3, 1e-3, 2e-3}}}) {
    const Tool tool = slot_tool(made.shape);
    const int repeats = 24 / static_cast<int>(made.depths.size());
    SixCoefficients inside = SixCoefficients::Zero();
    for (int seed = 1; seed <= kSeeds; ++seed) {
      const SlotFit fit = fit_slot_coefficients(
          tool, noisy_tests(tool, repeats, made.depths, {2.0, 1.0, 0.3}, static_cast<std::uint64_t>(seed)));
      const SixCoefficients off = fit.value - six_coefficients(kTable1);
      for (int i = 0; i < 6; ++i) inside[i] += std::abs(off[i]) <= 2.0 * fit.standard_error[i] ? 1.0 : 0.0;
    }
    // At 118 degrees of freedom Student's t lies within 2 with 0.9522; three standard deviations of the count.
    constexpr double kExpected = 0.9522;
    const double mean = kExpected * kSeeds, spread = std::sqrt(kSeeds * kExpected * (1.0 - kExpected));
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(inside[i], mean, 3.0 * spread) << "coefficient " << i;
    // Coefficients share axes, so the sum spreads by at most as much as six equal ones: their worst.
    EXPECT_NEAR(inside.sum() / 6.0, mean, 2.0 * spread);
  }
}

// Breaks where forces simulated in time, with noise on them, and not the model itself, lead elsewhere.
TEST(SlotCoefficients, Table1ComesBackFromForcesMilledInTimeWithNoise) {
  for (const ToolShape shape : {ToolShape::ball, ToolShape::end}) {
    const Tool tool = slot_tool(shape);
    std::vector<SlotTest> milled;
    for (const double feed : kPaperFeeds) milled.push_back({feed, 1e-3, milled_mean(tool, feed, 1e-3)});
    int inside = 0;
    constexpr int kSeeds = 50;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      std::mt19937_64 random{static_cast<std::uint64_t>(seed)};
      std::normal_distribution<double> normal;
      std::vector<SlotTest> tests;
      for (int repeat = 0; repeat < 4; ++repeat)
        for (SlotTest test : milled) {
          for (int axis = 0; axis < 3; ++axis) test.mean_force[axis] += 0.5 * normal(random);
          tests.push_back(test);
        }
      const SlotFit fit = fit_slot_coefficients(tool, tests);
      const SixCoefficients off = fit.value - six_coefficients(kTable1);
      for (int i = 0; i < 6; ++i) inside += std::abs(off[i]) <= 2.0 * fit.standard_error[i] ? 1 : 0;
    }
    // Student's t at 18 degrees of freedom: 0.9392. Slopes and intercepts of three axes, each pair strongly tied.
    EXPECT_NEAR(inside / (6.0 * kSeeds), 0.9392, 3.0 * std::sqrt(0.9392 * 0.0608 / (3.0 * kSeeds)));
  }
}

// Breaks with standard errors that do not follow the number of tests.
TEST(SlotCoefficients, StandardErrorsShrinkWithTheRootOfTheNumberOfTests) {
  const Tool tool = slot_tool(ToolShape::ball);
  const auto mean_error = [&](int repeats) {
    SixCoefficients sum = SixCoefficients::Zero();
    SixCoefficients square = SixCoefficients::Zero();
    constexpr int kSeeds = 120;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      const SlotFit fit = fit_slot_coefficients(
          tool, noisy_tests(tool, repeats, {1e-3}, {1.0, 1.0, 1.0}, static_cast<std::uint64_t>(1000 * repeats + seed)));
      sum += fit.standard_error / kSeeds;
      square += (fit.value - six_coefficients(kTable1)).cwiseAbs2() / kSeeds;
    }
    return std::pair{sum, SixCoefficients{square.cwiseSqrt()}};
  };
  const auto [few, few_off] = mean_error(4);
  const auto [many, many_off] = mean_error(36);
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(few[i] / few_off[i], 1.0, 0.2) << i;       // three of what 120 tell
    EXPECT_NEAR(few[i] / many[i], 3.0, 0.1) << i;          // what is said
    EXPECT_NEAR(few_off[i] / many_off[i], 3.0, 0.6) << i;  // what happens: rms of 120, 7 % each
  }
}

// Breaks with weights that a quiet axis does not deserve, or that are not found.
TEST(SlotCoefficients, ExactForcesGiveExactCoefficientsAtAnyDepthsAndUnequalNoise) {
  for (const ToolShape shape : {ToolShape::ball, ToolShape::end}) {
    const Tool tool = slot_tool(shape);
    const SlotFit fit = fit_slot_coefficients(tool, noisy_tests(tool, 1, {0.5e-3, 5e-3}, {0, 0, 0}, 1));
    const SixCoefficients table1 = six_coefficients(kTable1);
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(fit.value[i], table1[i], 1e-7 * std::abs(table1[i])) << i;
    for (const AxisFit& axis : fit.axes) EXPECT_NEAR(axis.r_squared, 1.0, 1e-9);
    EXPECT_THAT(doubts(fit, tool, noisy_tests(tool, 1, {0.5e-3, 5e-3}, {0, 0, 0}, 1)), IsEmpty());
  }
}

// Runout: shear coefficients hold, edge coefficients fall by the share that is told. Breaks with either claim.
TEST(SlotCoefficients, RunoutLeavesShearCoefficientsAlone) {
  Tool tool = slot_tool(ToolShape::end);
  tool.runout = 5e-6;
  std::vector<SlotTest> milled;
  for (const double feed : {0.04e-3, 0.07e-3, 0.10e-3}) milled.push_back({feed, 1e-3, milled_mean(tool, feed, 1e-3)});
  const SlotFit fit = fit_slot_coefficients(tool, milled);
  EXPECT_NEAR(fit.value[0], kTable1.ktc, 0.02 * kTable1.ktc);
  EXPECT_NEAR(fit.value[4] / kTable1.kre, 1.0, 0.1);
  EXPECT_NEAR(arc_out_of_cut(tool, 0.04e-3), std::asin(0.25) / std::numbers::pi, 1e-9);
  EXPECT_THAT(doubts(fit, tool, milled), ElementsAre(HasSubstr("runout keeps teeth out of 8 %")));
  EXPECT_EQ(arc_out_of_cut(slot_tool(ToolShape::end), 1e-6), 0.0);
}

std::string refusal_of(const Tool& tool, const std::vector<SlotTest>& tests) {
  return message_of<std::invalid_argument>([&] { (void)fit_slot_coefficients(tool, tests); });
}

TEST(SlotCoefficients, RefusesTestsThatCannotTellTheCoefficientsApart) {
  const Tool ball = slot_tool(ToolShape::ball);
  std::vector<SlotTest> tests = noisy_tests(ball, 1, {1e-3, 2e-3}, {1, 1, 1}, 1);
  EXPECT_EQ(refusal_of(ball, tests), "");
  EXPECT_THAT(refusal_of(ball, {tests[0], tests[1]}), HasSubstr("at least 3"));
  EXPECT_THAT(refusal_of(ball, {tests[0]}), HasSubstr("1 slot test leaves"));
  for (SlotTest& test : tests) test.feed_per_tooth = 0.05e-3;
  EXPECT_THAT(refusal_of(ball, tests), HasSubstr("one feed per tooth"));
  tests[0].feed_per_tooth = 0.05002e-3;
  EXPECT_THAT(refusal_of(slot_tool(ToolShape::end), tests), HasSubstr("too close"));
  std::vector<SlotTest> flat = noisy_tests(ball, 1, {1e-3}, {0, 0, 0}, 1);
  for (SlotTest& test : flat) test.mean_force.z() = 0.0;
  EXPECT_THAT(refusal_of(ball, flat), HasSubstr("measure fz"));
}

// An end mill without axial forces still gives the other four; says that it did not measure.
TEST(SlotCoefficients, EndMillWithoutAxialForces) {
  const Tool tool = slot_tool(ToolShape::end);
  std::vector<SlotTest> tests = noisy_tests(tool, 4, {1e-3}, {0.1, 0.1, 0}, 1);
  for (SlotTest& test : tests) test.mean_force.z() = 0.0;
  const SlotFit fit = fit_slot_coefficients(tool, tests);
  EXPECT_EQ(fit.value[2], 0.0);
  EXPECT_EQ(fit.standard_error[5], 0.0);
  EXPECT_NEAR(fit.value[0], kTable1.ktc, 0.01 * kTable1.ktc);
  EXPECT_TRUE(std::isnan(fit.axes[2].r_squared));
  EXPECT_THAT(doubts(fit, tool, tests), ElementsAre(HasSubstr("fz is zero")));
}

template <class Change>
std::vector<std::string> doubts_after(Change change) {
  const Tool tool = slot_tool(ToolShape::ball);
  std::vector<SlotTest> tests = noisy_tests(tool, 3, {0.5e-3, 1e-3, 2e-3}, {0.2, 0.2, 0.2}, 7);
  for (SlotTest& test : tests) change(test);
  return doubts(fit_slot_coefficients(tool, tests), tool, tests);
}

TEST(SlotCoefficients, DoubtsWhatCannotBe) {
  using Test = SlotTest&;
  EXPECT_THAT(doubts_after([](Test) {}), IsEmpty());
  EXPECT_THAT(doubts_after([](Test t) { t.mean_force *= -1.0; }), Contains(HasSubstr("forces on the workpiece")));
  EXPECT_THAT(doubts_after([](Test t) { t.mean_force.y() *= -1.0; }), Contains(HasSubstr("fy has the wrong sign")));
  EXPECT_THAT(doubts_after([](Test t) {
                t.mean_force.x() *= -1.0;
                t.mean_force.z() *= -1.0;
              }),
              Contains(HasSubstr("krc is negative")));
  EXPECT_THAT(doubts_after([](Test t) { t.mean_force.y() *= 1.0 + 4e3 * t.feed_per_tooth; }),
              Contains(HasSubstr("fy is no straight line")));
  EXPECT_THAT(doubts_after([](Test t) { t.mean_force *= 1.0 + 0.1e-3 / t.axial_depth; }),
              Contains(HasSubstr("does not follow the axial depth")));
}

}  // namespace
}  // namespace stillcut
