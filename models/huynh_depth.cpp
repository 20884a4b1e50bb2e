#include "models/huynh_depth.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "models/arm_modes.hpp"
#include "models/eigenvalues.hpp"
#include "models/four_axis_arm.hpp"
#include "models/lobes.hpp"
#include "models/newmark_robot.hpp"
#include "models/part_milling.hpp"

namespace stillcut {
namespace {

constexpr int kSamplesPerTurn = 20, kTurnsApart = 2;
constexpr double kEntryTime = 0.3;                     // s, from the surface to full depth
constexpr double kSlantTime = 1.0, kSettleTime = 0.3;  // s, of the cut in a part
constexpr double kBackingDepth = 3e-3;                 // m of part behind the wall
constexpr int kChords = 4;
constexpr int kDelays = 10;
constexpr double kLeastNorm = 1e-12;  // of the changes' squares: less is not the recurrence's
constexpr double kBeside = 0.01;      // of a depth: how far the simulations beside it are
constexpr std::size_t kFewestPlaces = 40;

// What the robot and the part do from one look at the tool to the next, the place's last kDelays changes under each
// other: [z_k+1; z_k; ...] = A [z_k; z_k-1; ...]. Among the solutions that fit, that of least norm (the ridge) keeps
// what the recurrence does not fix inside the unit circle (Kumaresan and Tufts 1982).
Eigen::MatrixXd recurrence_of(std::span<const Eigen::Vector2d> places) {
  const auto rows = static_cast<Eigen::Index>(places.size()) - 1 - kDelays;
  Eigen::MatrixXd last(rows, 2 * kDelays), next(rows, 2);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const auto change = [&](Eigen::Index i) -> Eigen::Vector2d {
      return places[static_cast<std::size_t>(i + 1)] - places[static_cast<std::size_t>(i)];
    };
    for (Eigen::Index delay = 0; delay < kDelays; ++delay)
      last.block<1, 2>(row, 2 * delay) = change(row + kDelays - 1 - delay).transpose();
    next.row(row) = change(row + kDelays).transpose();
  }
  Eigen::MatrixXd square = last.transpose() * last;
  square.diagonal().array() += kLeastNorm * square.trace();
  Eigen::MatrixXd recurrence = Eigen::MatrixXd::Zero(2 * kDelays, 2 * kDelays);
  recurrence.topRows(2) = square.llt().solve(last.transpose() * next).transpose();
  recurrence.bottomLeftCorner(2 * kDelays - 2, 2 * kDelays - 2).setIdentity();
  return recurrence;
}

std::vector<Mode> modes_at(const HuynhPass& pass) {
  return tool_modes(linear_arm(huynh_robot(), four_axis_angles({}, pass.place)));
}

}  // namespace

DepthLimit huynh_depth_by_lobes(const HuynhPass& pass, double max_depth) {
  const Cut cut = huynh_cut(pass.way, pass.milling);
  LobeSettings settings;
  settings.max_depth = max_depth;
  const std::vector<Mode> modes = modes_at(pass);
  return depth_limits(huynh_tool(), huynh_material(), cut, modes, std::span(&cut.spindle_speed, 1), settings).front();
}

TurnMultiplier turn_multiplier(std::span<const Eigen::Vector2d> places, double turns_apart, double turn_time) {
  if (places.size() < kFewestPlaces) throw std::invalid_argument("a multiplier needs at least 40 places");
  const Eigen::VectorXcd multipliers = eigenvalues(recurrence_of(places));
  Eigen::Index leading = 0;
  multipliers.cwiseAbs().maxCoeff(&leading);
  return {std::pow(std::abs(multipliers[leading]), 1.0 / turns_apart),
          std::abs(std::arg(multipliers[leading])) / (turns_apart * turn_time)};
}

TurnMultiplier huynh_multiplier_in_time(const HuynhPass& pass, double depth, double seconds) {
  MillingSetup setup;
  setup.tool = huynh_tool();
  setup.material = huynh_material();
  setup.cut = huynh_cut(pass.way, pass.milling);
  setup.cut.axial_depth = 0.0;
  setup.deepest = depth;
  setup.modes = modes_at(pass);
  setup.structure = [&](double step) {
    return std::make_unique<NewmarkRobot>(huynh_robot(), holding(four_axis_angles({}, pass.place)), step);
  };
  const double turn_time = kTwoPi / setup.cut.spindle_speed;
  MillingSimulation milling(setup, kSamplesPerTurn / turn_time);
  const auto samples_in = [&](double time) {
    return static_cast<int>(std::lround(time / turn_time)) * kSamplesPerTurn;
  };
  const int entry = samples_in(kEntryTime), watched = samples_in(seconds);
  MillingConditions now = milling.conditions();
  for (int i = 1; i <= entry; ++i) {
    now.axial_depth = depth * (static_cast<double>(i) / entry);
    milling.advance(now);
  }
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i < watched; ++i) {
    milling.advance();
    if (i % (kTurnsApart * kSamplesPerTurn) == 0) places.emplace_back(milling.state().displacement.head<2>());
  }
  return turn_multiplier(places, kTurnsApart, turn_time);
}

double huynh_depth_in_time(const HuynhPass& pass, double near) {
  const double low = (1.0 - kBeside) * near, high = (1.0 + kBeside) * near;
  const double at_low = std::log(huynh_multiplier_in_time(pass, low).modulus);
  const double at_high = std::log(huynh_multiplier_in_time(pass, high).modulus);
  if (!(at_low < 0.0 && at_high > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  return low - at_low * (high - low) / (at_high - at_low);
}

TurnMultiplier huynh_multiplier_in_part(const HuynhPass& pass, double depth, double seconds) {
  const Cut cut = huynh_cut(pass.way, pass.milling);
  const double speed = cut.feed_per_tooth * 2.0 * cut.spindle_speed / kTwoPi, radius = 0.5 * huynh_tool().diameter;
  const Eigen::Vector2d feed(std::cos(cut.feed_direction), std::sin(cut.feed_direction)), cross(-feed.y(), feed.x());
  const Eigen::Vector2d start = pass.place.head<2>();
  const double side = pass.milling == Milling::up ? 1.0 : -1.0, slant = speed * kSlantTime;
  const auto corner = [&](double along, double across) -> Eigen::Vector2d {
    return start + along * feed + side * across * cross;
  };
  const double face = radius - cut.radial_depth, back = radius + kBackingDepth;
  const double end = slant + speed * (kSettleTime + seconds) + 2.0 * radius;
  PartMillingSetup setup;
  setup.tool = huynh_tool();
  setup.material = huynh_material();
  setup.part = {{corner(0.0, radius), corner(slant, face), corner(end, face), corner(end, back), corner(0.0, back)}};
  setup.axial_depth = depth;
  setup.spindle_speed = cut.spindle_speed;
  setup.steps_per_turn = pass.steps_per_turn;
  setup.chords = kChords;
  setup.path = [=](double time) -> Eigen::Vector2d { return start + speed * time * feed; };
  setup.structure = [&](double step) {
    return std::make_unique<NewmarkRobot>(huynh_robot(), holding(four_axis_angles({}, pass.place)), step);
  };
  PartMilling milling(setup);
  const double turn_time = kTwoPi / cut.spindle_speed;
  const auto apart = std::lround(kTurnsApart * pass.steps_per_turn);
  const auto steps = std::lround((kSlantTime + kSettleTime + seconds) / milling.step());
  std::vector<Eigen::Vector2d> places;
  for (long i = 1; i <= steps; ++i) {
    const MillingState& state = milling.advance();
    if (state.time > kSlantTime + kSettleTime && i % apart == 0) places.emplace_back(state.displacement.head<2>());
  }
  return turn_multiplier(places, kTurnsApart, turn_time);
}

double huynh_depth_in_part(const HuynhPass& pass, double near) {
  const auto growth = [&](double depth) { return std::log(huynh_multiplier_in_part(pass, depth).modulus); };
  double low = 0.8 * near, high = 1.2 * near, at_low = growth(low), at_high = growth(high);
  if (!(at_low < 0.0 && at_high > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < 3; ++i) {  // halved, then straight: the growth has kinks where another mode takes the lead
    const double middle = i < 2 ? 0.5 * (low + high) : low - at_low * (high - low) / (at_high - at_low);
    const double at_middle = growth(middle);
    (at_middle < 0.0 ? low : high) = middle;
    (at_middle < 0.0 ? at_low : at_high) = at_middle;
  }
  return low - at_low * (high - low) / (at_high - at_low);
}

}  // namespace stillcut
