// Ball-end milling on a height map against what does not know of one: the closed form of a slot's mean force, the
// volume that left the map, the simulation with a surface about the tool's axis.
#include "models/surface_milling.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "models/milling_simulation.hpp"
#include "models/modal_structure.hpp"
#include "models/slot_coefficients.hpp"
#include "models/surface_sweep.hpp"

namespace stillcut {
namespace {

using ::testing::HasSubstr;

const Material kAluminium{
    .name = "Al7075-T6", .ktc = 1661.8e6, .krc = 1240.8e6, .kac = 19.1e6, .kte = 7.1e3, .kre = 15.9e3, .kae = 2.3e3};

Tool ball() {
  return {.shape = ToolShape::ball,
          .diameter = 8e-3,
          .teeth = 2,
          .pitch = {0.5 * kTwoPi, 0.5 * kTwoPi},
          .helix = deg_to_rad(45)};
}

Cut cut_of(double depth, double feed) {
  return {.milling = Milling::down,
          .radial_depth = 0.1e-3,
          .axial_depth = depth,
          .feed_per_tooth = feed,
          .spindle_speed = rpm_to_rad_s(6000)};
}

std::vector<Mode> equal_modes(double frequency_hz, double damping, double stiffness) {
  const double w = kTwoPi * frequency_hz;
  return {{w, damping, stiffness, {1, 0, 0}}, {w, damping, stiffness, {0, 1, 0}}, {w, damping, stiffness, {0, 0, 1}}};
}

// A flat part of the cut's depth, wide enough for one slot of this length along y = 0.
Stock flat_stock(const Tool& tool, const Cut& cut, double length) {
  Stock stock;
  const double reach = contact_reach(tool, cut.axial_depth) + 0.2e-3;
  stock.map.spacing_along = stock.map.spacing_across = 10e-6;
  stock.map.along = static_cast<std::size_t>((length + 2.0 * reach) / 10e-6);
  stock.map.across = static_cast<std::size_t>(2.0 * reach / 10e-6);
  stock.map.heights.assign(stock.map.along * stock.map.across, cut.axial_depth);
  stock.origin_x = stock.origin_y = -reach;
  return stock;
}

struct MilledSlot {
  Eigen::Vector3d mean_force = Eigen::Vector3d::Zero(), mean = mean_force, rms = mean_force;
};

MilledSlot mill_slot(const Tool& tool, const Cut& cut, const std::vector<Mode>& modes, double settle_turns,
                     double turns) {
  const CutterMotion motion = cutter_motion(tool, cut);
  const double turn = kTwoPi / motion.spindle_speed, length = motion.feed_rate * turn * (settle_turns + turns);
  const double step = turn / 360.0;
  Stock stock = flat_stock(tool, cut, length);
  ModalStructure structure(modes, step);
  SurfaceMilling milling({motion, kAluminium, cut.axial_depth, step}, stock, structure);
  const CutterPass pass{.length = length};
  cut_up_to_begin(tool, pass, stock);
  milling.begin(pass);
  MilledSlot slot;
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (int i = 0; i < static_cast<int>(360 * settle_turns); ++i) milling.advance();
  const int count = static_cast<int>(360 * turns);
  for (int i = 0; i < count; ++i) {
    milling.advance();
    slot.mean_force += milling.force() / count;
    slot.mean += milling.displacement() / count;
    squares += milling.displacement().cwiseAbs2() / count;
  }
  slot.rms = (squares - slot.mean.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
  return slot;
}

// Breaks with a wrong frame, chip, edge length, or an engagement that is not the ball's. The closed form takes a
// tooth's path for a circle, which leaves out f_z^2 / 2R of the chip's height: hence small feeds.
TEST(SurfaceMilling, MeanForceOfASlotIsTheClosedForm) {
  for (const double depth : {0.5e-3, 1.0e-3})
    for (const double feed : {0.01e-3, 0.02e-3}) {
      const Cut cut = cut_of(depth, feed);
      const MilledSlot slot = mill_slot(ball(), cut, equal_modes(500, 0.05, 1e12), 4, 4);
      const Eigen::Vector3d expected = slot_influence(ball(), feed, depth) * six_coefficients(kAluminium);
      EXPECT_LT((slot.mean_force - expected).norm(), 0.03 * expected.norm()) << depth << " " << feed << "\n"
                                                                             << slot.mean_force.transpose() << "\n"
                                                                             << expected.transpose();
    }
}

// The same slot with the surface kept about the tool's axis: static deflection and forced vibration. Breaks with
// regeneration that is missing, or a displacement that does not reach the chip.
TEST(SurfaceMilling, ForcedVibrationAgreesWithTheSurfaceAboutTheAxis) {
  const Cut cut = cut_of(0.5e-3, 0.02e-3);
  const std::vector<Mode> modes = equal_modes(900, 0.05, 5e7);
  const MilledSlot slot = mill_slot(ball(), cut, modes, 30, 10);
  MillingSetup setup;
  setup.tool = ball();
  setup.material = kAluminium;
  setup.cut = cut;
  setup.cut.milling = Milling::slot;
  setup.cut.radial_depth = 8e-3;
  setup.modes = modes;
  MillingSimulation other(setup, 36e3);
  for (int i = 0; i < 30 * 360; ++i) other.advance();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), squares = mean;
  for (int i = 0; i < 3600; ++i) {
    const Eigen::Vector3d displacement = other.advance().displacement;
    mean += displacement / 3600;
    squares += displacement.cwiseAbs2() / 3600;
  }
  const Eigen::Vector3d rms = (squares - mean.cwiseAbs2()).cwiseSqrt();
  EXPECT_LT((slot.mean - mean).norm(), 0.03 * mean.norm()) << slot.mean.transpose() << "\n" << mean.transpose();
  EXPECT_LT((slot.rms - rms).norm(), 0.05 * rms.norm()) << slot.rms.transpose() << "\n" << rms.transpose();
}

double volume(const Stock& stock) {
  double sum = 0.0;
  for (const double height : stock.map.heights) sum += height;
  return sum * stock.map.spacing_along * stock.map.spacing_across;
}

// What the chips add up to is what the map has lost, however the tool is inclined, runs out and vibrates. Breaks with
// stock that vanishes without a chip, or a chip from stock that is left.
TEST(SurfaceMilling, ChipsAddUpToWhatTheMapLoses) {
  std::mt19937 random(3);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int i = 0; i < 12; ++i) {
    Tool tool = ball();
    tool.runout = between(0.0, 10e-6);
    tool.axial_runout = between(0.0, 5e-6);
    Cut cut = cut_of(between(0.2e-3, 0.6e-3), between(0.04e-3, 0.1e-3));
    cut.milling = random() % 2 == 0 ? Milling::up : Milling::down;
    cut.step_over = between(0.1e-3, 0.4e-3);
    cut.tilt = deg_to_rad(between(-20, 20));
    cut.lead = deg_to_rad(between(-20, 20));
    const CutterMotion motion = cutter_motion(tool, cut);
    const double side = cut.milling == Milling::up ? 1.0 : -1.0;
    const std::vector<CutterPass> passes{{.length = 2e-3}, {.length = 2e-3, .across = side * cut.step_over}};
    Stock stock = stock_for(tool, cut, passes);
    const double step = longest_step(motion, 600);
    ModalStructure structure(equal_modes(between(200, 600), 0.05, 5e7), step);
    SurfaceMilling milling({motion, kAluminium, cut.axial_depth, step}, stock, structure);
    cut_up_to_begin(tool, passes[0], stock);
    milling.begin(passes[0]);
    while (milling.time() * motion.feed_rate < 0.5e-3) milling.advance();
    const double before = volume(stock), removed = milling.removed();
    while (milling.time() * motion.feed_rate < 1.5e-3) milling.advance();
    const double lost = before - volume(stock);
    EXPECT_GT(lost, 0.0);
    EXPECT_NEAR(milling.removed() - removed, lost, 0.04 * lost) << i;
  }
}

TEST(SurfaceMilling, OnlyForBallEnds) {
  Tool tool = ball();
  tool.shape = ToolShape::end;
  const Cut cut = cut_of(0.5e-3, 0.1e-3);
  Stock stock = flat_stock(tool, cut, 1e-3);
  ModalStructure structure(equal_modes(500, 0.05, 1e6), 1e-5);
  EXPECT_THROW(SurfaceMilling({cutter_motion(tool, cut), kAluminium, 0.5e-3, 1e-5}, stock, structure),
               std::invalid_argument);
}

// A cut that no structure holds ends with the reason, not with numbers without meaning.
TEST(SurfaceMilling, MotionThatRunsAwayIsSaid) {
  const Cut cut = cut_of(2e-3, 0.1e-3);
  try {
    (void)mill_slot(ball(), cut, equal_modes(60, 0.01, 5e4), 20, 1);
    FAIL() << "the cut was held";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("leaves its path"));
  }
}

}  // namespace
}  // namespace stillcut
