#include "models/surface_milling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "models/edge_force.hpp"

namespace stillcut {
namespace {

constexpr double kLargestTurnAStep = 0.0175;   // rad: one degree
constexpr double kStepsAPeriod = 60.0;         // of the highest mode
constexpr double kLargestPiece = 0.0125;       // rad of the profile: the chord's height over the arc is R/51 000
constexpr double kChipCorrelationTime = 1e-3;  // s: a tooth's way through the cut; each chip has its own
constexpr double kBallRoom = 1.1;              // of the depth: vibration lets an edge reach above the stock
// Points of the map that the chip is measured before the edge: between points behind it, which are cut, and points
// before it, which are not, there is no height to be had. The force comes so much early, and nothing else changes.
constexpr double kAhead = 1.5;
constexpr double kLargestAhead = 0.3;  // rad, near the tip
constexpr double kSlowestEdge = 1e-3;  // m/s: the very tip stands still, process damping divides by it
constexpr double kFarOff = 0.1;        // of the diameter off the path: no cut is like that

// Of the chord between two points of an edge.
EdgePoint middle_of(const EdgePoint& a, const EdgePoint& b) {
  const double x = 0.5 * (a.radius * std::cos(a.lag) + b.radius * std::cos(b.lag)),
               y = 0.5 * (a.radius * std::sin(a.lag) + b.radius * std::sin(b.lag));
  return {std::hypot(x, y), 0.5 * (a.height + b.height), std::atan2(y, x)};
}

}  // namespace

double longest_step(const CutterMotion& motion, double highest_mode_hz) {
  const double turn = kLargestTurnAStep / motion.spindle_speed;
  return highest_mode_hz > 0.0 ? std::min(turn, 1.0 / (kStepsAPeriod * highest_mode_hz)) : turn;
}

SurfaceMilling::SurfaceMilling(SurfaceMillingSetup setup, Stock& stock, Structure& structure)
    : setup_{std::move(setup)},
      stock_{stock},
      structure_{structure},
      canvas_{stock.map, {0, stock.map.along, 0, stock.map.across}},
      to_points_{1.0 / stock.map.spacing_along, 1.0 / stock.map.spacing_across, 1.0},
      random_{setup_.seed} {
  const Tool& tool = setup_.motion.tool;
  if (tool.shape != ToolShape::ball) throw std::invalid_argument("milling on a height map needs a ball end");
  const double radius = 0.5 * tool.diameter;
  const double up_to =
      std::min(0.25 * kTwoPi,
               setup_.motion.inclination() + std::acos(1.0 - std::min(kBallRoom * setup_.axial_depth / radius, 1.0)));
  const int count = static_cast<int>(std::ceil(up_to / kLargestPiece));
  elements_ = edge_elements(tool, radius * (1.0 - std::cos(up_to)), count);
  std::vector<EdgePoint> points;
  for (int i = 0; i <= count; ++i) points.push_back(ball_edge_point(tool, up_to * i / count));
  std::vector<EdgePoint> ahead;
  const double away = kAhead * std::max(stock.map.spacing_along, stock.map.spacing_across);
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    ahead.push_back(middle_of(points[i], points[i + 1]));
    ahead_angle_.push_back(std::min(kLargestAhead, away / ahead.back().radius));
    ahead.back().lag -= ahead_angle_.back();
  }
  ahead_ = edge_rows(setup_.motion, ahead, stock.map.spacing_along, stock.map.spacing_across);
  nodes_ = edge_rows(setup_.motion, points, stock.map.spacing_along, stock.map.spacing_across);
  const std::vector<double> blank(nodes_[0].fixed.size());
  before_.assign(static_cast<std::size_t>(tool.teeth),
                 {blank, blank, blank, 0, static_cast<int>(nodes_[0].fixed.size())});
  after_ = before_;
  probe_ = before_.front();
  --probe_.end;
  cutting_.resize(before_.size());
  steps_ahead_ = 2 + static_cast<int>(kLargestAhead / (setup_.motion.spindle_speed * setup_.step));
}

// edge_position() of these points of an edge, x and y in points of the stock.
void SurfaceMilling::place(const EdgeRows& points, double time, const Eigen::Vector3d& displacement, std::size_t tooth,
                           EdgeRow& row) const {
  const CutterMotion& motion = setup_.motion;
  const double spindle = pass_.angle + motion.spindle_speed * time;
  const Eigen::Vector3d beside =
      Eigen::Vector3d(pass_.begin + (pass_.reversed ? -1.0 : 1.0) * motion.feed_rate * time - stock_.origin_x,
                      pass_.across - stock_.origin_y, 0.0) +
      motion.orientation * runout_offset(motion.tool, spindle, motion.axial_offset[tooth]) +
      motion.from_workpiece * displacement;
  const double phi = spindle + motion.tooth_angle[tooth];
  place_row(points, std::sin(phi), std::cos(phi), beside.cwiseProduct(to_points_), row);
}

// How far the stock stands above a point, m; x and y in points. Nothing does beside the map.
double SurfaceMilling::stock_above(double x, double y, double z) const {
  const HeightMap& map = stock_.map;
  if (!(x >= 0.0 && y >= 0.0)) return 0.0;
  const auto i = static_cast<std::size_t>(x), j = static_cast<std::size_t>(y);
  if (i + 1 >= map.along || j + 1 >= map.across) return 0.0;
  const double part_x = x - static_cast<double>(i), part_y = y - static_cast<double>(j);
  const double* row = &map.heights[j * map.along + i];
  const double* next = row + map.along;
  const double low = row[0] + part_x * (row[1] - row[0]), high = next[0] + part_x * (next[1] - next[0]);
  return low + part_y * (high - low) - z;
}

// The force of a tooth where it will be: on the middles of the chords between its nodes, a little ahead.
void SurfaceMilling::add_load(std::size_t tooth, double time, const Eigen::Vector3d& displacement) {
  const CutterMotion& motion = setup_.motion;
  place(ahead_, time, displacement, tooth, probe_);
  const Eigen::Vector3d velocity =
      motion.orientation.transpose() * (motion.from_workpiece * ((displacement - displacement_) / setup_.step));
  const double tooth_angle = pass_.angle + motion.spindle_speed * time + motion.tooth_angle[tooth];
  Cutting& cutting = cutting_[tooth];
  if (cutting.steps_left > 0 && --cutting.steps_left == 0) cutting = {};
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    if (probe_.z[i] > setup_.axial_depth) continue;
    const double above = stock_above(probe_.x[i], probe_.y[i], probe_.z[i]);
    if (!(above > 0.0)) continue;
    const EdgeElement& edge = elements_[i];
    const double phi = tooth_angle - edge.lag + ahead_angle_[i];
    const Eigen::Vector2d outward(std::sin(phi), std::cos(phi));
    const double down = -motion.orientation.row(2).dot(
        Eigen::RowVector3d(edge.sin_kappa * outward.x(), edge.sin_kappa * outward.y(), -edge.cos_kappa));
    if (!(down > 0.0)) continue;
    const int n = static_cast<int>(i);
    cutting.begin = cutting.steps_left > 0 ? std::min(cutting.begin, n) : n;
    cutting.end = cutting.steps_left > 0 ? std::max(cutting.end, n + 1) : n + 1;
    cutting.steps_left = steps_ahead_;
    const double chip = above * down, speed = motion.spindle_speed * 0.5 * motion.tool.diameter * edge.sin_kappa;
    load_ += edge_force(setup_.material, edge, outward, chip, {velocity, std::max(speed, kSlowestEdge)});
    chip_ = std::max(chip_, chip);
    removed_ += chip * edge.chip_width * speed * setup_.step;
  }
}

void SurfaceMilling::begin(const CutterPass& pass) {
  pass_ = pass;
  time_ = 0.0;
  displacement_ = structure_.displacement();
  for (std::size_t tooth = 0; tooth < before_.size(); ++tooth) place(nodes_, 0.0, displacement_, tooth, before_[tooth]);
}

// The displacement is predicted with the last force held, the chip there gives the force, the force moves the
// structure, and what the edges swept on their real way is cut away (as in models/milling_simulation).
void SurfaceMilling::advance() {
  const CutterMotion& motion = setup_.motion;
  const double time = time_ + setup_.step;
  const Eigen::Vector3d predicted = structure_.displacement_after(force_, force_);
  if (setup_.force_noise > 0.0) {
    const double kept = std::exp(-setup_.step / kChipCorrelationTime);
    std::normal_distribution<double> normal;
    force_variation_ = kept * force_variation_ + setup_.force_noise * std::sqrt(1.0 - kept * kept) * normal(random_);
  }
  load_.setZero();
  chip_ = 0.0;
  for (std::size_t tooth = 0; tooth < cutting_.size(); ++tooth) add_load(tooth, time, predicted);
  force_ = (1.0 + force_variation_) * (motion.from_workpiece.transpose() * (motion.orientation * load_));
  structure_.advance(force_, force_);
  displacement_ = structure_.displacement();
  if (!(displacement_.norm() < kFarOff * motion.tool.diameter))
    throw std::runtime_error(
        "the tool leaves its path by more than a tenth of its diameter; the cut is unstable or the force too large");
  for (std::size_t tooth = 0; tooth < cutting_.size(); ++tooth) {
    place(nodes_, time, displacement_, tooth, after_[tooth]);
    if (const Cutting& cutting = cutting_[tooth]; cutting.steps_left > 0) {
      // A node more at each end, where the stock stands between two of them.
      EdgeRow& row = after_[tooth];
      row.begin = std::max(0, cutting.begin - 1);
      row.end = std::min(static_cast<int>(nodes_[0].fixed.size()), cutting.end + 2);
      canvas_.sweep(before_[tooth], row, std::numeric_limits<double>::infinity());
      row.begin = 0;
      row.end = static_cast<int>(nodes_[0].fixed.size());
    }
    std::swap(before_[tooth], after_[tooth]);
  }
  time_ = time;
}

}  // namespace stillcut
