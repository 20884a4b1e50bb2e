#include "models/surface_sweep.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

namespace stillcut {
namespace {

constexpr double kPaperShare = 0.2;      // section 2.4: max(dx, dy) <= 1/5 min(f_z, step-over)
constexpr double kMostStepsATurn = 1e7;  // a turn: finer than any grid that fits into memory
// Turns are cut in this order: every 16th, what is left of every 4th, the rest. The surface is then nearly finished
// early and most of the later patches are seen to lie above it. The order changes nothing else: a minimum is one.
constexpr std::array<std::int64_t, 3> kStrides{16, 4, 1};

// Edge points at most `spacing` apart, from the tip upward, as far as they come within `low` of the surface when the
// tool turns.
std::vector<EdgePoint> edge_points(const CutterMotion& motion, double spacing, double low) {
  const Tool& tool = motion.tool;
  const double radius = 0.5 * tool.diameter, inclination = motion.inclination();
  std::vector<EdgePoint> points;
  const auto divide = [&](double from, double to, double longest, auto point) {
    const int count = std::max(1, static_cast<int>(std::ceil((to - from) / longest)));
    for (int i = 0; i <= count; ++i) points.push_back(point(from + (to - from) * i / count));
  };
  if (tool.shape == ToolShape::ball) {
    const double away = std::acos(std::clamp(1.0 - low / radius, 0.0, 1.0));
    const double from = std::max(0.0, inclination - away), to = std::min(0.5 * std::numbers::pi, inclination + away);
    const double slant = std::hypot(1.0, std::pow(std::sin(to), 2) * std::tan(tool.helix));  // edge over profile
    divide(from, to, spacing / (radius * slant), [&](double kappa) { return ball_edge_point(tool, kappa); });
    return points;
  }
  const double inner = inclination > 0.0 ? std::max(0.0, radius - low / std::sin(inclination)) : 0.0;
  divide(inner, radius, spacing, [&](double at) { return bottom_edge_point(tool, at); });
  const double slant = std::hypot(1.0, std::tan(tool.helix));
  divide(0.0, std::min(low / std::cos(inclination), tool.diameter), spacing / slant,
         [&](double height) { return wall_edge_point(tool, height); });
  return points;
}

}  // namespace

double coarsest_spacing(const Cut& cut) { return kPaperShare * std::min(cut.feed_per_tooth, step_over_of(cut)); }

std::vector<CutterPass> passes_over(const CutterMotion& motion, const Cut& cut, double along, double across,
                                    double turn_time) {
  const double step_over = step_over_of(cut);
  const double run_in = swept_heights(motion, cut).reach + kTwoPi * motion.feed_rate / motion.spindle_speed;
  const double before = std::ceil(run_in / step_over), after = std::ceil((across + run_in) / step_over);
  return parallel_passes(motion, cut, -run_in, along + 2.0 * run_in, -before * step_over,
                         static_cast<std::size_t>(before + after) + 1, turn_time);
}

SurfaceSweep::SurfaceSweep(CutterMotion motion, const Cut& cut, double spacing_along, double spacing_across,
                           bool allow_coarse)
    : motion_{std::move(motion)},
      swept_{swept_heights(motion_, cut)},
      spacing_along_{spacing_along},
      spacing_across_{spacing_across} {
  const double coarser = std::max(spacing_along, spacing_across), coarsest = coarsest_spacing(cut);
  if (!(std::min(spacing_along, spacing_across) > 0.0 && std::isfinite(coarser)))
    throw std::invalid_argument("grid: its spacing must be a positive number");
  if (!allow_coarse && coarser > coarsest * (1.0 + 1e-9)) {
    std::array<char, 160> text{};
    (void)std::snprintf(text.data(), text.size(),
                        "grid: %.4g mm between points is too coarse for this feed and step-over; at most %.4g mm",
                        1e3 * coarser, 1e3 * coarsest);
    throw std::invalid_argument(text.data());
  }
  place_edge_points(std::min(spacing_along, spacing_across));
  find_windows();
}

// Edge points, and so many steps a turn, that neither an edge point in a step nor a piece of the edge is longer than a
// cell.
void SurfaceSweep::place_edge_points(double spacing) {
  const std::vector<EdgePoint> points = edge_points(motion_, spacing, swept_.highest + swept_.beside.z());
  const Eigen::Vector3d scale(1.0 / spacing_along_, 1.0 / spacing_across_, 1.0);
  points_ = edge_rows(motion_, points, spacing_along_, spacing_across_);
  double radius = 0.0;
  for (const EdgePoint& point : points) radius = std::max(radius, point.radius);
  const double travel =
      kTwoPi * (radius + motion_.tool.runout +
                (motion_.feed_rate + motion_.displacement.speed) / motion_.spindle_speed);  // m a turn
  const double steps = std::ceil(travel / spacing);
  if (!(steps < kMostStepsATurn)) throw std::invalid_argument("grid: too fine for this tool");
  steps_per_turn_ = std::max<std::int64_t>(8, static_cast<std::int64_t>(steps));

  std::vector<EdgePoint> knots(knot_count(points.size()));
  for (std::size_t k = 0; k < knots.size(); ++k) knots[k] = points[knot_point(k, points.size())];
  knots_ = edge_rows(motion_, knots, spacing_along_, spacing_across_);
  const double turn = kSheetSteps * kTwoPi / static_cast<double>(steps_per_turn_);
  // The feed is even; what the vibration strays from a straight line its speed bounds. An upright end mill's bottom has
  // one height, to the bit; else what rounding takes is far below 1 pm.
  const double strays = 0.5 * motion_.displacement.speed * turn / motion_.spindle_speed;
  for (const SheetSag& sag : sheet_sag(points, turn, motion_.tool.runout))
    for (int i = 0; i < 3; ++i) {
      const double far = sag.in(motion_.orientation.row(i)) + strays;
      sag_[static_cast<std::size_t>(i)].push_back((far > 0.0 ? far + 1e-12 : 0.0) * scale[i]);
    }
}

// Of each step of a turn the edge points, from the first to the last, that come low enough there.
std::vector<EdgeRange> SurfaceSweep::low_points() const {
  const auto& [fixed, sine, cosine] = points_[2];
  const double low = swept_.highest + swept_.beside.z();
  std::vector<EdgeRange> result(static_cast<std::size_t>(steps_per_turn_));
  for (std::int64_t k = 0; k < steps_per_turn_; ++k) {
    const double phi = kTwoPi * static_cast<double>(k) / static_cast<double>(steps_per_turn_);
    const double s = std::sin(phi), c = std::cos(phi);
    EdgeRange& range = result[static_cast<std::size_t>(k)];
    for (std::size_t i = 0; i < fixed.size(); ++i) {
      if (fixed[i] + sine[i] * s + cosine[i] * c > low) continue;
      if (range.begin == range.end) range.begin = static_cast<int>(i);
      range.end = static_cast<int>(i) + 1;
    }
  }
  return result;
}

void SurfaceSweep::find_windows() {
  const std::vector<EdgeRange> low = low_points();
  const std::int64_t turn = steps_per_turn_;
  const auto at = [turn](std::int64_t k) { return static_cast<std::size_t>((k % turn + turn) % turn); };
  // A patch has four corners: a range takes in those of the steps beside it, and a point more at each end.
  ranges_.assign(low.size(), {});
  for (std::int64_t k = 0; k < turn; ++k) {
    EdgeRange& range = ranges_[at(k)];
    for (std::int64_t beside = k - 1; beside <= k + 1; ++beside) {
      const EdgeRange& other = low[at(beside)];
      if (other.begin == other.end) continue;
      range = range.begin == range.end ? other
                                       : EdgeRange{std::min(range.begin, other.begin), std::max(range.end, other.end)};
    }
    if (range.begin == range.end) continue;
    range = {std::max(0, range.begin - 1), std::min(static_cast<int>(points_[0].fixed.size()), range.end + 1)};
  }
  const auto empty = [&](std::int64_t k) { return ranges_[at(k)].begin == ranges_[at(k)].end; };
  std::int64_t gap = 0;
  while (gap < turn && !empty(gap)) ++gap;
  if (gap == turn) windows_.push_back({.first = 0, .last = turn});  // the edge is low all around
  for (std::int64_t k = gap; gap < turn && k < gap + turn; ++k) {
    if (empty(k)) continue;
    Window window{.first = k, .last = k};
    while (!empty(window.last + 1)) ++window.last;
    windows_.push_back(window);
    k = window.last;
  }
  for (Window& window : windows_) {
    window.low_x = window.low_y = std::numeric_limits<double>::infinity();
    window.high_x = window.high_y = -window.low_x;
    for (std::int64_t k = window.first; k <= window.last; ++k) {
      const double phi = kTwoPi * static_cast<double>(at(k)) / static_cast<double>(turn);
      for (int i = ranges_[at(k)].begin; i < ranges_[at(k)].end; ++i) {
        const auto n = static_cast<std::size_t>(i);
        const auto along = [&](const EdgeAxis& axis) {
          return axis.fixed[n] + axis.sine[n] * std::sin(phi) + axis.cosine[n] * std::cos(phi);
        };
        const double x = along(points_[0]), y = along(points_[1]);
        window.low_x = std::min(window.low_x, x), window.high_x = std::max(window.high_x, x);
        window.low_y = std::min(window.low_y, y), window.high_y = std::max(window.high_y, y);
      }
    }
  }
}

// Whether an edge can come over a tile in a window of the turn that begins `begun` s after the pass.
bool SurfaceSweep::touches(const CutterPass& pass, double begun, const Window& window, const MapTile& tile) const {
  const double sign = pass.reversed ? -1.0 : 1.0, travel = sign * motion_.feed_rate * begun / spacing_along_;
  const double two_turns =
      2.0 * kTwoPi / motion_.spindle_speed * motion_.feed_rate / spacing_along_;  // a window's last
  const double x = pass.begin / spacing_along_ + travel, y = pass.across / spacing_across_;
  const double beside_x = swept_.beside.x() / spacing_along_ + two_turns + 1.0,
               beside_y = swept_.beside.y() / spacing_across_ + 1.0;
  return x + window.high_x + beside_x >= static_cast<double>(tile.along_begin) &&
         x + window.low_x - beside_x <= static_cast<double>(tile.along_end) &&
         y + window.high_y + beside_y >= static_cast<double>(tile.across_begin) &&
         y + window.low_y - beside_y <= static_cast<double>(tile.across_end);
}

// The edge at a step, counted from where the tooth's angle was 0 before the pass began: edge_position() for the points
// or knots that the row asks for.
void SurfaceSweep::place(const CutterPass& pass, std::size_t tooth, std::int64_t step, const EdgeRows& edge,
                         EdgeRow& row) const {
  const double step_angle = kTwoPi / static_cast<double>(steps_per_turn_), tooth_angle = motion_.tooth_angle[tooth];
  const std::int64_t in_turn = (step % steps_per_turn_ + steps_per_turn_) % steps_per_turn_;
  const double phi = step_angle * static_cast<double>(in_turn);
  const double time = (step_angle * static_cast<double>(step) - pass.angle - tooth_angle) / motion_.spindle_speed;
  const Eigen::Vector3d beside =
      motion_.orientation * runout_offset(motion_.tool, phi - tooth_angle, motion_.axial_offset[tooth]) +
      displacement_at(motion_, pass.time + time);
  const double x = pass.begin + (pass.reversed ? -1.0 : 1.0) * motion_.feed_rate * time + beside.x();
  place_row(edge, std::sin(phi), std::cos(phi),
            {x / spacing_along_, (pass.across + beside.y()) / spacing_across_, beside.z()}, row);
}

// What a tooth sweeps in a pass.
struct SurfaceSweep::Sheet {
  const SurfaceSweep& sweep;
  const CutterPass& pass;
  std::size_t tooth;

  [[nodiscard]] std::size_t points() const { return sweep.points_[0].fixed.size(); }
  [[nodiscard]] EdgeRange range(std::int64_t first, std::int64_t last) const {
    const std::int64_t turn = sweep.steps_per_turn_;
    EdgeRange all;
    for (std::int64_t step = first; step <= last; ++step) {
      const EdgeRange& range = sweep.ranges_[static_cast<std::size_t>((step % turn + turn) % turn)];
      if (range.begin == range.end) continue;
      all = all.begin == all.end ? range : EdgeRange{std::min(all.begin, range.begin), std::max(all.end, range.end)};
    }
    return all;
  }
  [[nodiscard]] double sag(int knot, int axis) const {
    return sweep.sag_[static_cast<std::size_t>(axis)][static_cast<std::size_t>(knot)];
  }
  void place(std::int64_t step, int begin, int end, EdgeRow& row) const {
    row.begin = begin, row.end = end;
    sweep.place(pass, tooth, step, sweep.points_, row);
  }
  void place_knots(std::int64_t step, int begin, int end, EdgeRow& row) const {
    row.begin = begin, row.end = end;
    sweep.place(pass, tooth, step, sweep.knots_, row);
  }
};

SweepCount SurfaceSweep::sweep(HeightMap& map, const MapTile& tile, std::span<const CutterPass> passes) const {
  PatchCanvas canvas(map, tile);
  SheetRows rows(points_[0].fixed.size());
  const double step_angle = kTwoPi / static_cast<double>(steps_per_turn_);
  for (std::size_t level = 0; level < kStrides.size(); ++level)
    for (const CutterPass& pass : passes)
      for (std::size_t tooth = 0; tooth < motion_.tooth_angle.size(); ++tooth) {
        const double begin_angle = pass.angle + motion_.tooth_angle[tooth];
        const double end_angle = begin_angle + motion_.spindle_speed * pass.length / motion_.feed_rate;
        const auto first_step = static_cast<std::int64_t>(std::ceil(begin_angle / step_angle));
        const auto last_step = static_cast<std::int64_t>(std::floor(end_angle / step_angle));
        const auto first_turn = static_cast<std::int64_t>(std::floor(begin_angle / kTwoPi)) - 1;
        for (std::int64_t turn = first_turn; turn * steps_per_turn_ <= last_step; ++turn) {
          const std::int64_t number = turn - first_turn;
          if (number % kStrides[level] != 0 || (level > 0 && number % kStrides[level - 1] == 0)) continue;
          const double begun = (kTwoPi * static_cast<double>(turn) - begin_angle) / motion_.spindle_speed;
          for (const Window& window : windows_) {
            if (!touches(pass, begun, window, tile)) continue;
            const std::int64_t first = std::max(first_step, turn * steps_per_turn_ + window.first),
                               last = std::min(last_step, turn * steps_per_turn_ + window.last);
            if (first >= last) continue;
            sweep_sheet(Sheet{*this, pass, tooth}, first, last, swept_.highest, canvas, rows);
            canvas.settle();
          }
        }
      }
  return canvas.count();
}

}  // namespace stillcut
