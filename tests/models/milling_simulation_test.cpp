#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <tuple>

#include "models/cut_schedule.hpp"

namespace stillcut {
namespace {

using std::numbers::pi;

Mode mode_of(double frequency_hz, double damping_ratio, double stiffness, std::array<double, 3> direction) {
  return {kTwoPi * frequency_hz, damping_ratio, stiffness, direction};
}

Tool end_mill(int teeth, double diameter) {
  Tool tool;
  tool.teeth = teeth;
  tool.diameter = diameter;
  tool.pitch.assign(static_cast<std::size_t>(teeth), kTwoPi / teeth);
  return tool;
}

// Stiff enough that the tool's own motion does not change the chip.
std::vector<Mode> rigid_structure() {
  return {mode_of(400, 0.05, 1e12, {1, 0, 0}), mode_of(400, 0.05, 1e12, {0, 1, 0}),
          mode_of(400, 0.05, 1e12, {0, 0, 1})};
}

MillingSetup slotting(int teeth) {
  MillingSetup setup;
  setup.tool = end_mill(teeth, 0.02);
  setup.material = {.name = "", .ktc = 800e6, .krc = 300e6, .kac = 100e6, .kte = 12e3, .kre = 9e3, .kae = 2e3};
  setup.cut = {.milling = Milling::slot,
               .radial_depth = 0.02,
               .axial_depth = 1.5e-3,
               .feed_per_tooth = 0.1e-3,
               .spindle_speed = rpm_to_rad_s(6000)};
  setup.modes = rigid_structure();
  return setup;
}

Eigen::Vector3d mean_force(const MillingSetup& setup, double rate_hz, double seconds) {
  MillingSimulation cut(setup, rate_hz);
  for (int i = 0; i < static_cast<int>(0.1 * rate_hz); ++i) cut.advance();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const int samples = static_cast<int>(seconds * rate_hz);
  for (int i = 0; i < samples; ++i) sum += cut.advance().force;
  return sum / samples;
}

// Mean forces of a slot per revolution, Altintas' closed form with the signs of docs/conventions.md.
Eigen::Vector3d slot_mean_force(const Material& m, int teeth, double depth, double feed) {
  const double n = teeth;
  return {-n * depth * (m.krc * feed / 4 + m.kre / pi), n * depth * (m.ktc * feed / 4 + m.kte / pi),
          -n * depth * (m.kac * feed / pi + m.kae / 2)};
}

TEST(MillingSimulation, MeanSlottingForceIsTheClosedForm) {
  for (const int teeth : {1, 2, 3, 5}) {
    const MillingSetup setup = slotting(teeth);
    const Eigen::Vector3d expected = slot_mean_force(setup.material, teeth, 1.5e-3, 0.1e-3);
    const Eigen::Vector3d mean = mean_force(setup, 50e3, 0.1);
    EXPECT_LT((mean - expected).norm(), 2e-3 * expected.norm()) << teeth << " teeth: " << mean.transpose();
  }
}

TEST(MillingSimulation, HelixAndRunoutLeaveTheMeanShearForceOfASlotUnchanged) {
  MillingSetup setup = slotting(3);
  setup.material.kte = setup.material.kre = setup.material.kae = 0.0;
  const Eigen::Vector3d expected = slot_mean_force(setup.material, 3, 1.5e-3, 0.1e-3);
  setup.tool.helix = deg_to_rad(30);
  setup.tool.runout = 5e-6;
  EXPECT_LT((mean_force(setup, 50e3, 0.1) - expected).norm(), 5e-3 * expected.norm());
}

TEST(MillingSimulation, ForcesTurnWithTheFeedDirection) {
  MillingSetup setup = slotting(2);
  const Eigen::Vector3d along_x = mean_force(setup, 50e3, 0.1);
  setup.cut.feed_direction = deg_to_rad(90);
  const Eigen::Vector3d along_y = mean_force(setup, 50e3, 0.1);
  EXPECT_NEAR(along_y.x(), -along_x.y(), 1e-6 * along_x.norm());
  EXPECT_NEAR(along_y.y(), along_x.x(), 1e-6 * along_x.norm());
  EXPECT_NEAR(along_y.z(), along_x.z(), 1e-6 * along_x.norm());
}

TEST(MillingSimulation, MeanDeflectionInAStableCutIsTheMeanForceOverTheStiffness) {
  MillingSetup setup = slotting(3);
  setup.modes = {mode_of(700, 0.04, 2e7, {1, 0, 0}), mode_of(650, 0.04, 2e7, {0, 1, 0})};
  setup.cut.axial_depth = 0.3e-3;
  MillingSimulation cut(setup, 50e3);
  for (int i = 0; i < 25000; ++i) cut.advance();
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
  for (int i = 0; i < 10000; ++i) displacement += cut.advance().displacement / 10000;
  const Eigen::Vector3d force = slot_mean_force(setup.material, 3, 0.3e-3, 0.1e-3);
  EXPECT_NEAR(displacement.x(), force.x() / 2e7, 0.01 * force.norm() / 2e7);
  EXPECT_NEAR(displacement.y(), force.y() / 2e7, 0.01 * force.norm() / 2e7);
}

// Growth of a small disturbance, a factor a tooth period: the same cut with and without a hammer blow, subtracted. In a
// cut that never leaves the part this is the spectral radius of the linear theory.
double growth_per_tooth_period(MillingSetup setup, double rate_hz, double settle_s, double periods) {
  MillingSimulation quiet(setup, rate_hz);
  const double tooth_period = kTwoPi / (setup.cut.spindle_speed * setup.tool.teeth);
  MillingSimulation struck(setup, rate_hz);
  struck.structure().strike({1e-4, 1e-4, 0.0});
  const auto samples_of = [&](double seconds) { return static_cast<int>(std::lround(seconds * rate_hz)); };
  const auto level = [&](double seconds) {  // rms of the difference
    double sum = 0.0;
    for (int i = 0; i < samples_of(seconds); ++i)
      sum += (struck.advance().displacement - quiet.advance().displacement).squaredNorm();
    return std::sqrt(sum);
  };
  level(settle_s);
  const double window = 4 * tooth_period;
  const double before = level(window);
  level(periods * tooth_period - window);
  return std::pow(level(window) / before, 1.0 / periods);
}

MillingSetup robot_like(double feed_direction_deg, double rpm, double depth) {
  MillingSetup setup;
  setup.tool = end_mill(2, 0.025);
  setup.material = {.name = "", .ktc = 8e8, .krc = 3e8};
  setup.cut = {.milling = Milling::down,
               .radial_depth = 0.0125,
               .axial_depth = depth,
               .feed_per_tooth = 0.2e-3,
               .spindle_speed = rpm_to_rad_s(rpm),
               .feed_direction = deg_to_rad(feed_direction_deg)};
  setup.modes = {mode_of(55, 0.04, 3e6, {1, 0, 0}), mode_of(500, 0.03, 2e7, {1, 0, 0}),
                 mode_of(125, 0.035, 6e6, {0, 1, 0}), mode_of(520, 0.03, 1.8e7, {0, 1, 0})};
  return setup;
}

// Spectral radii of a converged Floquet solution (Chebyshev collocation with breakpoints at entry and exit), made
// independently of this code: modes at 55, 125, 500 and 520 Hz, half-immersion down-milling.
TEST(MillingSimulation, DisturbancesDecayAsFastAsTheSpectralRadiusSays) {
  const std::array<std::tuple<double, double, double, double>, 5> points{{{0, 3000, 1e-3, 0.899011948},
                                                                          {30, 3000, 1e-3, 0.882356867},
                                                                          {45, 3000, 1e-3, 0.883212442},
                                                                          {90, 3000, 1e-3, 0.896254268},
                                                                          {90, 3300, 2e-3, 0.832502154}}};
  for (const auto& [direction, rpm, depth, radius] : points) {
    const double growth = growth_per_tooth_period(robot_like(direction, rpm, depth), 31.2e3, 0.2, 60);
    EXPECT_NEAR(growth, radius, 0.006) << direction << " deg, " << rpm << " rpm";
  }
}

MillingSetup one_mode(double immersion, double rpm, double depth) {
  MillingSetup setup;
  setup.tool = end_mill(2, 0.02);
  setup.material = {.name = "", .ktc = 6e8, .krc = 2e8};
  setup.cut = {.milling = Milling::down,
               .radial_depth = immersion * 0.02,
               .axial_depth = depth,
               .feed_per_tooth = 0.1e-3,
               .spindle_speed = rpm_to_rad_s(rpm)};
  const double w = kTwoPi * 922;
  setup.modes = {mode_of(922, 0.011, 0.03993 * w * w, {1, 0, 0})};
  return setup;
}

// From the same Floquet solution: one mode in the feed direction.
struct ReferencePoint {
  Milling milling;
  double immersion, rpm, depth, spectral_radius;
};

TEST(MillingSimulation, VerdictAgreesWithTheFloquetReference) {
  const std::array<ReferencePoint, 10> points{{{Milling::down, 0.05, 5000, 0.5e-3, 0.6889},
                                               {Milling::down, 0.1, 10000, 1e-3, 0.5820},
                                               {Milling::down, 0.5, 5000, 0.5e-3, 0.8124},
                                               {Milling::down, 0.5, 10000, 1e-3, 0.3855},
                                               {Milling::up, 0.1, 5000, 0.5e-3, 0.8175},
                                               {Milling::down, 0.1, 20000, 5e-3, 1.3587},
                                               {Milling::down, 1.0, 5000, 0.5e-3, 1.0740},
                                               {Milling::down, 1.0, 10000, 1e-3, 1.2325},
                                               {Milling::up, 0.5, 5000, 0.5e-3, 1.3059},
                                               {Milling::up, 0.5, 10000, 1e-3, 1.3800}}};
  for (const ReferencePoint& point : points) {
    MillingSetup setup = one_mode(point.immersion, point.rpm, point.depth);
    setup.cut.milling = point.milling;
    const double growth = growth_per_tooth_period(setup, 40e3, 0.0, point.spectral_radius < 1.2 ? 20 : 6);
    EXPECT_EQ(growth < 1.0, point.spectral_radius < 1.0)
        << point.immersion << " of D, " << point.rpm << " rpm: " << growth << " for " << point.spectral_radius;
  }
}

TEST(MillingSimulation, ChatterEndsWhereTheToolJumpsOutOfTheCut) {
  MillingSetup setup = one_mode(1.0, 10000, 2e-3);
  MillingSimulation cut(setup, 40e3);
  double largest = 0.0;
  int out_of_contact = 0;
  for (int i = 0; i < 80000; ++i) {
    const MillingState& state = cut.advance();
    ASSERT_GE(state.chip, 0.0);
    largest = std::max(largest, std::abs(state.displacement.x()));
    if (state.chip == 0.0) ++out_of_contact;
  }
  EXPECT_GT(largest, 0.1e-3);       // grown to the size of the feed per tooth ...
  EXPECT_LT(largest, 1e-3);         // ... and held there: without loss of contact it would grow without bound
  EXPECT_GT(out_of_contact, 1000);  // the two teeth of a slot leave the part only by jumping out
}

TEST(MillingSimulation, NoForceAndNoChipInTheAir) {
  MillingSetup setup = slotting(2);
  const CutSchedule schedule{{{0, 0}, {0.1, 0}, {0.1, 1e-3}, {0.2, 1e-3}, {0.2, 0}}, {}};
  setup = scheduled(setup, schedule);
  MillingSimulation cut(setup, 20e3);
  for (int i = 1; i < 6000; ++i) {
    const MillingState& state = cut.advance(conditions_at(setup, schedule, i / 20e3));
    if (state.time < 0.0999 || state.time > 0.2001) {
      ASSERT_EQ(state.force.norm(), 0.0) << state.time;
      ASSERT_EQ(state.chip, 0.0);
    }
    if (state.time > 0.11 && state.time < 0.19) {
      ASSERT_GT(state.force.norm(), 0.0) << state.time;
      ASSERT_LE(state.chip, 0.1001e-3);
    }
  }
}

TEST(MillingSimulation, SamplesAreEquallySpacedAndFollowTheSpeedSchedule) {
  MillingSetup setup = slotting(2);
  const CutSchedule schedule{{}, {{0.05, rpm_to_rad_s(6000)}, {0.15, rpm_to_rad_s(5000)}}};
  setup = scheduled(setup, schedule);
  MillingSimulation cut(setup, 25.6e3);
  for (int i = 1; i <= 5120; ++i) {
    const MillingState& state = cut.advance(conditions_at(setup, schedule, i / 25.6e3));
    ASSERT_DOUBLE_EQ(state.time, i / 25.6e3);
    ASSERT_NEAR(rad_s_to_rpm(state.spindle_speed), 6000 - 10000 * std::clamp(state.time - 0.05, 0.0, 0.1), 1e-6);
  }
}

TEST(MillingSimulation, TheSameSeedGivesTheSameBitsAndAnotherDoesNot) {
  MillingSetup setup = robot_like(30, 3000, 1e-3);
  setup.force_noise = 0.05;
  const auto last = [&] {
    MillingSimulation cut(setup, 20e3);
    for (int i = 0; i < 4000; ++i) cut.advance();
    return cut.state();
  };
  const MillingState first = last(), second = last();
  EXPECT_EQ(first.displacement, second.displacement);
  EXPECT_EQ(first.force, second.force);
  setup.seed = 2;
  EXPECT_NE(last().displacement, first.displacement);
}

TEST(MillingSimulation, RefusesWhatItCannotSimulate) {
  const MillingSetup good = slotting(2);
  EXPECT_THROW(MillingSimulation(good, 7.9e3), std::invalid_argument);  // 20 a period of 400 Hz is 8 kHz
  EXPECT_NO_THROW(MillingSimulation(good, 8.0e3));
  const auto refused = [&](auto change) {
    MillingSetup setup = good;
    change(setup);
    EXPECT_THROW(MillingSimulation(setup, 20e3), std::invalid_argument);
  };
  refused([](MillingSetup& s) { s.modes.clear(); });
  refused([](MillingSetup& s) { s.modes[0].damping_ratio = 1.0; });
  refused([](MillingSetup& s) { s.modes[0].stiffness = 0.0; });
  refused([](MillingSetup& s) { s.tool.pitch.clear(); });
  refused([](MillingSetup& s) { s.cut.spindle_speed = 0.0; });
  refused([](MillingSetup& s) { s.slowest = 1.0; });
  refused([](MillingSetup& s) { s.cut.axial_depth = std::nan(""); });
  EXPECT_THROW(scheduled(good, {{{0, 1e-3}, {1, -1e-3}}, {}}), std::invalid_argument);
  EXPECT_THROW(scheduled(good, {{{1, 1e-3}, {0, 1e-3}}, {}}), std::invalid_argument);
  EXPECT_THROW(scheduled(good, {{}, {{0, std::nan("")}}}), std::invalid_argument);
  MillingSimulation cut(good, 20e3);
  const auto refused_while_running = [&](auto change) {
    MillingConditions conditions = cut.conditions();
    change(conditions);
    EXPECT_THROW(cut.advance(conditions), std::invalid_argument);
    EXPECT_EQ(cut.state().time, 0.0);
  };
  refused_while_running([](MillingConditions& c) { c.axial_depth = 2e-3; });
  refused_while_running([](MillingConditions& c) { c.spindle_speed *= 1.1; });
  refused_while_running([](MillingConditions& c) { c.milling = Milling::up, c.radial_depth = 0.03; });
  refused_while_running([](MillingConditions& c) { c.milling = Milling::up, c.radial_depth = 0.0; });
  refused_while_running([](MillingConditions& c) { c.feed_per_tooth = -1e-6; });
}

}  // namespace
}  // namespace stillcut
