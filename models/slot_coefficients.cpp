#include "models/slot_coefficients.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "models/edge_elements.hpp"

namespace stillcut {
namespace {

constexpr int kElements = 200;              // of an edge: what it leaves of a ball's integrals is below a part in 10^5
constexpr std::size_t kFewestTests = 3;     // two are met exactly by any line: no residual, no standard error
constexpr double kApart = 1e-9;             // m: feeds closer than this are one
constexpr double kWorstCondition = 1000.0;  // feeds that span some 0.2 % of their mean
constexpr double kLargestWeightRatio = 50.0;  // of two axes' scatter: so few tests cannot know a larger one
constexpr int kMostWeighings = 50;
constexpr double kSettledScatter = 1e-6;  // change of the scatter in a round, relative

using SlotVector = Eigen::VectorXd;
using SlotMatrix = Eigen::MatrixXd;

// Rows 3 i .. 3 i + 2 are the axes of test i.
struct SlotEquations {
  SlotMatrix design;
  SlotVector force;
};

SlotEquations slot_equations(const Tool& tool, const std::vector<SlotTest>& tests) {
  const auto count = static_cast<Eigen::Index>(tests.size());
  SlotEquations equations{SlotMatrix(3 * count, 6), SlotVector(3 * count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const SlotTest& test = tests[static_cast<std::size_t>(i)];
    equations.design.middleRows<3>(3 * i) = slot_influence(tool, test.feed_per_tooth, test.axial_depth);
    equations.force.segment<3>(3 * i) = test.mean_force;
  }
  return equations;
}

SlotVector axis_of(const SlotVector& all, Eigen::Index axis) {
  SlotVector one(all.size() / 3);
  for (Eigen::Index i = 0; i < one.size(); ++i) one[i] = all[3 * i + axis];
  return one;
}

void check_tests(const Tool& tool, const std::vector<SlotTest>& tests) {
  if (tests.size() < kFewestTests)
    throw std::invalid_argument(std::to_string(tests.size()) +
                                (tests.size() == 1 ? " slot test leaves" : " slot tests leave") +
                                " nothing to judge the fit by; give at least 3, at 2 or more feeds per tooth");
  const auto [slowest, fastest] =
      std::minmax_element(tests.begin(), tests.end(),
                          [](const SlotTest& a, const SlotTest& b) { return a.feed_per_tooth < b.feed_per_tooth; });
  if (fastest->feed_per_tooth - slowest->feed_per_tooth < kApart)
    throw std::invalid_argument(
        "all tests have one feed per tooth: shear and edge coefficients cannot be told apart; add tests at other "
        "feeds");
  const bool no_axial =
      std::all_of(tests.begin(), tests.end(), [](const SlotTest& test) { return test.mean_force.z() == 0.0; });
  if (no_axial && tool.shape == ToolShape::ball)
    throw std::invalid_argument(
        "all axial forces are zero: radial and axial coefficients of a ball end cannot be told apart; measure fz");
}

// A weighted least-squares solution in orthonormal columns.
struct WeightedFit {
  SlotVector value;
  SlotMatrix basis;     // of the weighted equations' column space
  SlotMatrix to_value;  // weighted forces to coefficients
  SlotVector residual;  // weighted
  double condition = 1.0;
};

WeightedFit weighted_fit(const SlotEquations& equations, const SlotVector& weight) {
  const SlotMatrix rows = weight.asDiagonal() * equations.design;
  const SlotVector scale = rows.colwise().norm().cwiseMax(std::numeric_limits<double>::min()).cwiseInverse();
  const Eigen::JacobiSVD<SlotMatrix> svd(rows * scale.asDiagonal(), Eigen::ComputeThinU | Eigen::ComputeThinV);
  WeightedFit fit;
  fit.condition = svd.singularValues()[0] / svd.singularValues()[5];
  if (!(fit.condition < kWorstCondition))
    throw std::invalid_argument(
        "the feeds per tooth lie too close to each other to tell the coefficients apart; spread them, as from 0.02 to "
        "0.1 mm");
  fit.basis = svd.matrixU();
  fit.to_value =
      scale.asDiagonal() * svd.matrixV() * svd.singularValues().cwiseInverse().asDiagonal() * svd.matrixU().transpose();
  const SlotVector force = weight.cwiseProduct(equations.force);
  fit.value = fit.to_value * force;
  fit.residual = force - rows * fit.value;
  return fit;
}

// Scatter of an axis from its residuals (unweighted) and the freedom that the fit leaves it.
void judge_scatter(const WeightedFit& fit, const SlotVector& weight, std::array<AxisFit, 3>& axes) {
  const SlotVector leverage = fit.basis.rowwise().squaredNorm();
  const SlotVector residual = fit.residual.cwiseQuotient(weight);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    AxisFit& of = axes[static_cast<std::size_t>(axis)];
    const SlotVector left = axis_of(residual, axis);
    of.freedom = static_cast<double>(left.size()) - axis_of(leverage, axis).sum();
    of.scatter = std::sqrt(left.squaredNorm() / std::max(of.freedom, 1e-3));
  }
}

SlotVector row_values(const std::array<AxisFit, 3>& axes, Eigen::Index rows, double least) {
  SlotVector values(rows);
  for (Eigen::Index i = 0; i < rows; ++i) values[i] = std::max(axes[static_cast<std::size_t>(i % 3)].scatter, least);
  return values;
}

double largest_scatter(const std::array<AxisFit, 3>& axes) {
  return std::max({axes[0].scatter, axes[1].scatter, axes[2].scatter});
}

// Standard deviations of a normal distribution that are as rare as `t` at this freedom (Wallace 1959).
double as_normal(double t, double freedom) {
  return std::sqrt(freedom * std::log1p(t * t / freedom)) * (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
}

// Would one more column, only in this axis, take away much of the residual?
ResidualPattern pattern_in(const WeightedFit& fit, const SlotVector& weight, const AxisFit& of, Eigen::Index axis,
                           const SlotVector& column, double largest_force) {
  constexpr double kNothingNew = 1e-6;  // of the column's square: the model has it already
  if (of.freedom < 1.5 || !(of.scatter > 0.0) || !(largest_force > 0.0)) return {};
  SlotVector all = SlotVector::Zero(weight.size());
  for (Eigen::Index i = 0; i < column.size(); ++i) all[3 * i + axis] = column[i] * weight[3 * i + axis];
  const SlotVector fresh = all - fit.basis * (fit.basis.transpose() * all);
  if (!(fresh.squaredNorm() > kNothingNew * all.squaredNorm())) return {};
  const double size = fresh.dot(fit.residual) / fresh.squaredNorm();
  const double unit = weight[axis] * of.scatter;  // of the weighted residuals of this axis
  const double before = of.freedom * unit * unit, freedom = of.freedom - 1.0;
  const double after = std::max(before - size * size * fresh.squaredNorm(), 1e-12 * before);
  const double t = size * fresh.norm() / std::sqrt(after / freedom);
  return {as_normal(t, freedom), std::abs(size) * column.cwiseAbs().maxCoeff() / largest_force};
}

// Grows with the square of a quantity beside the depth: a curve over the feed where `what` is the feed, more or less
// than in proportion where it is the depth.
SlotVector depth_times_square(const std::vector<SlotTest>& tests, double SlotTest::*what) {
  SlotVector column(static_cast<Eigen::Index>(tests.size()));
  double mean = 0.0;
  for (const SlotTest& test : tests) mean += test.*what / static_cast<double>(tests.size());
  for (Eigen::Index i = 0; i < column.size(); ++i) {
    const SlotTest& test = tests[static_cast<std::size_t>(i)];
    const double off = test.*what / mean - 1.0;
    column[i] = test.axial_depth * (what == &SlotTest::axial_depth ? off : off * off);
  }
  return column;
}

void judge_axes(const std::vector<SlotTest>& tests, const SlotEquations& equations, const WeightedFit& fit,
                const SlotVector& weight, std::array<AxisFit, 3>& axes) {
  const SlotVector bent_by_feed = depth_times_square(tests, &SlotTest::feed_per_tooth);
  const SlotVector bent_by_depth = depth_times_square(tests, &SlotTest::axial_depth);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    AxisFit& of = axes[static_cast<std::size_t>(axis)];
    const SlotVector force = axis_of(equations.force, axis);
    const double total = (force.array() - force.mean()).matrix().squaredNorm();
    const double left = axis_of(fit.residual.cwiseQuotient(weight), axis).squaredNorm();
    if (total > 0.0) of.r_squared = 1.0 - left / total;
    const double largest = force.cwiseAbs().maxCoeff();
    of.feed_squared = pattern_in(fit, weight, of, axis, bent_by_feed, largest);
    of.depth_squared = pattern_in(fit, weight, of, axis, bent_by_depth, largest);
  }
}

}  // namespace

SixCoefficients six_coefficients(const Material& m) { return {m.ktc, m.krc, m.kac, m.kte, m.kre, m.kae}; }

Eigen::Matrix<double, 3, 6> slot_influence(const Tool& tool, double feed_per_tooth, double axial_depth) {
  double width_s = 0.0, width_ss = 0.0, width_sc = 0.0, length = 0.0, length_s = 0.0, length_c = 0.0;
  const int count = tool.shape == ToolShape::ball ? kElements : 1;
  for (const EdgeElement& edge : edge_elements(tool, axial_depth, count)) {
    width_s += edge.chip_width * edge.sin_kappa;
    width_ss += edge.chip_width * edge.sin_kappa * edge.sin_kappa;
    width_sc += edge.chip_width * edge.sin_kappa * edge.cos_kappa;
    length += edge.edge_length;
    length_s += edge.edge_length * edge.sin_kappa;
    length_c += edge.edge_length * edge.cos_kappa;
  }
  // edge_force with the chip f sin phi sin kappa: over 0..pi sin^2 gives pi/2, sin 2, sin cos and cos nothing; a turn
  // is 2 pi.
  const double quarter = 0.25 * tool.teeth * feed_per_tooth, over_pi = tool.teeth / std::numbers::pi;
  const double chip_over_pi = over_pi * feed_per_tooth, half = 0.5 * tool.teeth;
  Eigen::Matrix<double, 3, 6> influence;
  influence << 0.0, -quarter * width_ss, -quarter * width_sc, 0.0, -over_pi * length_s, -over_pi * length_c,  //
      quarter * width_s, 0.0, 0.0, over_pi * length, 0.0, 0.0,                                                //
      0.0, chip_over_pi * width_sc, -chip_over_pi * width_ss, 0.0, half * length_c, -half * length_s;
  return influence;
}

double arc_out_of_cut(const Tool& tool, double feed_per_tooth) {
  double share = 0.0, angle = 0.0;
  const auto reach = [&](double at) { return tool.runout * std::cos(at - tool.runout_angle); };
  for (const double pitch : tool.pitch) {  // from this tooth to the next, which meets what this one left
    const double own_feed = feed_per_tooth * tool.teeth * pitch / kTwoPi;
    const double shorter = std::max(0.0, reach(angle) - reach(angle + pitch));
    share += 2.0 / std::numbers::pi * std::asin(std::min(1.0, shorter / own_feed)) / tool.teeth;
    angle += pitch;
  }
  return share;
}

SlotFit fit_slot_coefficients(const Tool& tool, const std::vector<SlotTest>& tests) {
  check_tests(tool, tests);
  const SlotEquations equations = slot_equations(tool, tests);
  const Eigen::Index rows = equations.force.size();
  SlotFit result;
  SlotVector weight = SlotVector::Ones(rows);
  WeightedFit fit = weighted_fit(equations, weight);
  judge_scatter(fit, weight, result.axes);
  for (int round = 0; round < kMostWeighings; ++round) {
    const double largest = largest_scatter(result.axes);
    if (!(largest > 0.0)) break;  // exact: any weights will do
    const SlotVector before = row_values(result.axes, rows, largest / kLargestWeightRatio);
    weight = largest * before.cwiseInverse();
    fit = weighted_fit(equations, weight);
    judge_scatter(fit, weight, result.axes);
    const SlotVector now = row_values(result.axes, rows, largest_scatter(result.axes) / kLargestWeightRatio);
    if ((now - before).cwiseAbs().maxCoeff() < kSettledScatter * largest) break;
  }
  judge_axes(tests, equations, fit, weight, result.axes);
  result.value = fit.value;
  const SlotVector spread = weight.cwiseProduct(row_values(result.axes, rows, 0.0));
  result.standard_error = (fit.to_value * spread.asDiagonal()).rowwise().norm();
  result.condition = fit.condition;
  const SlotVector residual = fit.residual.cwiseQuotient(weight);
  for (Eigen::Index i = 0; i < rows; i += 3) result.residual.emplace_back(residual.segment<3>(i));
  return result;
}

}  // namespace stillcut
