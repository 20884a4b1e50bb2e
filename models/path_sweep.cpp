#include "models/path_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include "models/multiversion.hpp"

namespace stillcut {
namespace {

constexpr double kEquator = 0.5 * std::numbers::pi;
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kFinestTurn = 1e7;       // steps: finer than any grid that fits into memory
constexpr std::size_t kLooksASide = 100;  // at the envelope, to learn how steep the contact is

// [begin, end) of `out` becomes a p + b q + c r + beside.
STILLCUT_MULTIVERSION void place_points(const double* a, const double* b, const double* c, double p, double q, double r,
                                        double beside, double* out, int begin, int end) {
  for (int i = begin; i < end; ++i) out[i] = (a[i] * p + b[i] * q) + (c[i] * r + beside);
}

// Every 16th turn, then every 4th that is left, then the rest: see surface_sweep.cpp.
int order_of(std::size_t turn) { return turn % 16 == 0 ? 0 : turn % 4 == 0 ? 1 : 2; }

void check_spacing(double coarser, double finer, double coarsest, bool allow_coarse) {
  if (!(finer > 0.0 && std::isfinite(coarser)))
    throw std::invalid_argument("grid: its spacing must be a positive number");
  if (allow_coarse || coarser <= coarsest * (1.0 + 1e-9)) return;
  char text[160];
  (void)std::snprintf(text, sizeof text,
                      "grid: %.4g mm between points is too coarse for the slowest feed of the path; at most %.4g mm",
                      1e3 * coarser, 1e3 * coarsest);
  throw std::invalid_argument(text);
}

}  // namespace

PathSweep::PathSweep(CutterPath path, const HeightMap& map, const Eigen::Vector2d& origin, bool allow_coarse)
    : path_{std::move(path)},
      envelope_{path_, origin},
      origin_{origin},
      spacing_along_{map.spacing_along},
      spacing_across_{map.spacing_across} {
  const double finer = std::min(spacing_along_, spacing_across_);
  check_spacing(std::max(spacing_along_, spacing_across_), finer, coarsest_spacing(path_), allow_coarse);
  choose_steps(map);
  place_edge_points(finer);
}

// So many steps a turn that an edge point where the ball touches travels at most a cell in one.
void PathSweep::choose_steps(const HeightMap& map) {
  HeightMap thin;  // its heights are not asked for
  const auto thinned = [](std::size_t points, double spacing, std::size_t& left, double& wider) {
    left = std::min(points, kLooksASide);
    wider = left > 1 ? spacing * static_cast<double>(points - 1) / static_cast<double>(left - 1) : spacing;
  };
  thinned(map.along, map.spacing_along, thin.along, thin.spacing_along);
  thinned(map.across, map.spacing_across, thin.across, thin.spacing_across);
  double kappa = -1.0;
  for (const EnvelopePoint& point : envelope_.over(thin, {0, thin.along, 0, thin.across}))
    if (!std::isnan(point.height)) kappa = std::max(kappa, std::min(point.kappa, kEquator));
  if (kappa < 0.0) throw std::invalid_argument("tool path: it does not come to the rectangle of the map");
  double slowest = kInfinite;
  for (const PathPiece& piece : path_.pieces)
    if (piece.feeds) slowest = std::min(slowest, piece.spindle_speed);
  const double contact_radius = 0.5 * path_.tool.diameter * std::sin(kappa) + path_.tool.runout;
  const double travel = kTwoPi * (contact_radius + path_.fastest_radian + path_.displacement.speed / slowest);
  const double steps = std::ceil(travel / std::min(spacing_along_, spacing_across_));
  if (!(steps < kFinestTurn)) throw std::invalid_argument("grid: too fine for this tool");
  steps_per_turn_ = std::max<std::int64_t>(8, static_cast<std::int64_t>(steps));
  // What the tool goes on in a step counts too: a stretch's last row may lie in the next piece.
  const double step = kTwoPi / static_cast<double>(steps_per_turn_);
  stray_ = farthest_beside(path_) + 2.0 * step * path_.fastest_radian + 1e-9;
}

void PathSweep::place_edge_points(double spacing) {
  const double radius = 0.5 * path_.tool.diameter, slant = std::hypot(1.0, std::tan(path_.tool.helix));
  const int count = std::max(1, static_cast<int>(std::ceil(kEquator * radius * slant / spacing)));
  for (int i = 0; i <= count; ++i) points_.push_back(ball_edge_point(path_.tool, kEquator * i / count));
  const auto put = [](Edge& edge, const EdgePoint& point) {
    edge[0].push_back(point.radius * std::cos(point.lag));
    edge[1].push_back(point.radius * std::sin(point.lag));
    edge[2].push_back(point.height);
  };
  for (const EdgePoint& point : points_) put(columns_, point);
  for (std::size_t k = 0; k < knot_count(points_.size()); ++k) put(knots_, points_[knot_point(k, points_.size())]);
  const double turn = kSheetSteps * kTwoPi / static_cast<double>(steps_per_turn_);
  double speed = 0.0;  // m a radian that a straight line between two steps may miss: feed round a corner, vibration
  for (const PathPiece& piece : path_.pieces)
    if (piece.feeds) speed = std::max(speed, path_.displacement.speed / piece.spindle_speed);
  for (const SheetSag& sag : sheet_sag(points_, turn, path_.tool.runout))
    sag_.push_back(std::hypot(sag.across, sag.along) + 0.5 * turn * (2.0 * path_.fastest_radian + speed) + 1e-12);
}

double PathSweep::axis_turn(const Stretch& stretch) const {
  const PathPiece& piece = path_.pieces[stretch.piece];
  return piece.axis_turn * (stretch.end - stretch.begin) / (piece.duration * piece.spindle_speed);
}

std::vector<PathSweep::Stretch> PathSweep::stretches_over(const MapTile& tile) const {
  const double half_x = 0.5 * spacing_along_ * static_cast<double>(tile.along_end - 1 - tile.along_begin),
               half_y = 0.5 * spacing_across_ * static_cast<double>(tile.across_end - 1 - tile.across_begin);
  const double x = origin_.x() + spacing_along_ * static_cast<double>(tile.along_begin) + half_x,
               y = origin_.y() + spacing_across_ * static_cast<double>(tile.across_begin) + half_y;
  const double radius = 0.5 * path_.tool.diameter;
  std::vector<Stretch> result;
  std::size_t turn = 0;
  for (std::size_t n = 0; n < path_.pieces.size(); ++n) {
    const PathPiece& piece = path_.pieces[n];
    if (!piece.feeds) continue;
    const double whole = piece.duration * piece.spindle_speed;
    const auto turns = static_cast<std::size_t>(std::max(1.0, std::ceil(whole / kTwoPi)));
    const bool comes_on = n > 0 && path_.pieces[n - 1].feeds;
    // A ball as long as the piece, wide enough for a turning axis: is the tile near at all?
    const BallStroke all =
        ball_stroke(ball_pose(path_, piece, 0.0).centre, ball_pose(path_, piece, piece.duration).centre,
                    radius * (1.0 + piece.axis_turn) + stray_);
    if (!(lowest_in_box(all, x, y, half_x, half_y) < kInfinite)) {
      turn += turns;
      continue;
    }
    for (std::size_t k = 0; k < turns; ++k, ++turn) {
      const double from = static_cast<double>(k) / static_cast<double>(turns),
                   to = static_cast<double>(k + 1) / static_cast<double>(turns);
      Stretch stretch;
      stretch.piece = n;
      stretch.begin = piece.angle + from * whole;
      stretch.end = piece.angle + to * whole;
      stretch.comes_on = k > 0 || comes_on;
      stretch.order = order_of(turn);
      const double arc = axis_turn(stretch);
      stretch.body = ball_stroke(ball_pose(path_, piece, from * piece.duration).centre,
                                 ball_pose(path_, piece, to * piece.duration).centre,
                                 radius + stray_ + 0.125 * radius * arc * arc);
      stretch.lowest = lowest_in_box(stretch.body, x, y, half_x, half_y);
      if (stretch.lowest < kInfinite) result.push_back(stretch);
    }
  }
  std::sort(result.begin(), result.end(), [](const Stretch& a, const Stretch& b) {
    return a.order != b.order ? a.order < b.order : a.lowest < b.lowest;
  });
  return result;
}

// Of the blocks that the ball may lower, where on the ball they lie.
ContactWindow PathSweep::contact(const Stretch& stretch, const PatchCanvas& canvas) const {
  const PathPiece& piece = path_.pieces[stretch.piece];
  const double radius = 0.5 * path_.tool.diameter, tan_helix = std::tan(path_.tool.helix);
  const double middle = 0.5 * (stretch.begin + stretch.end) - piece.angle;
  const Eigen::Matrix3d to_tool = ball_pose(path_, piece, middle / piece.spindle_speed).orientation.transpose();
  const double cell = std::max(spacing_along_, spacing_across_), turned = axis_turn(stretch);
  ContactWindow window;
  for (std::size_t b = 0; b < canvas.blocks(); ++b) {
    const PatchCanvas::Block block = canvas.block(b);
    const double x = origin_.x() + block.x * spacing_along_, y = origin_.y() + block.y * spacing_across_;
    const double half_x = block.half_x * spacing_along_, half_y = block.half_y * spacing_across_;
    if (!(lowest_in_box(stretch.body, x, y, half_x, half_y) < block.highest)) continue;
    const BallStroke& body = stretch.body;
    const Eigen::Vector2d from_begin(x - body.from.x(), y - body.from.y());
    const double share = body.length > 0.0
                             ? std::clamp((from_begin.x() * body.ux + from_begin.y() * body.uy) / body.length, 0.0, 1.0)
                             : 0.0;
    Eigen::Vector2d away = from_begin - share * body.way.head<2>();
    // Any centre of the stretch, any point of the block, runout and vibration anywhere.
    const double far = away.norm(), room = std::hypot(half_x, half_y) + body.length + stray_ + 2.0 * cell;
    const auto slope = [radius](double distance) { return std::asin(std::clamp(distance / radius, 0.0, 1.0)); };
    const double around = slope(far + room) - slope(far - room) + turned;
    if (far > radius) away *= radius / far;
    const Eigen::Vector3d outward(away.x(), away.y(), -std::sqrt(std::max(0.0, radius * radius - away.squaredNorm())));
    const Eigen::Vector3d in_tool = to_tool * outward / radius;
    window.add(std::acos(std::clamp(-in_tool.z(), -1.0, 1.0)), std::atan2(in_tool.x(), in_tool.y()), around, tan_helix);
  }
  return window;
}

// edge_position() of the points or knots that the row asks for, at a step counted from spindle angle 0 of the tooth.
// The step lies in the piece or, at its end, in one that follows; steps before and behind what feeds are its begin and
// end.
void PathSweep::place(std::size_t n, std::size_t tooth, std::int64_t step, const Edge& edge, EdgeRow& row) const {
  const double step_angle = kTwoPi / static_cast<double>(steps_per_turn_), tooth_angle = path_.tooth_angle[tooth];
  const double exact = step_angle * static_cast<double>(step) - tooth_angle;
  double spindle = std::max(exact, path_.pieces[n].angle);
  while (n + 1 < path_.pieces.size() && path_.pieces[n + 1].feeds && spindle >= path_.pieces[n + 1].angle) ++n;
  const PathPiece& piece = path_.pieces[n];
  spindle = std::min(spindle, piece.angle + piece.duration * piece.spindle_speed);
  const double elapsed = (spindle - piece.angle) / piece.spindle_speed;
  const BallPose pose = ball_pose(path_, piece, elapsed);
  const Eigen::Matrix3d& o = pose.orientation;
  const std::int64_t in_turn = (step % steps_per_turn_ + steps_per_turn_) % steps_per_turn_;
  const double phi = spindle == exact ? step_angle * static_cast<double>(in_turn) : spindle + tooth_angle;
  const double s = std::sin(phi), c = std::cos(phi);
  Eigen::Vector3d beside = pose.centre + o * runout_offset(path_.tool, phi - tooth_angle, path_.axial_offset[tooth]);
  if (path_.displacement.at) beside += path_.displacement.at(piece.time + elapsed);
  beside.head<2>() -= origin_;
  const std::array scale{1.0 / spacing_along_, 1.0 / spacing_across_, 1.0};
  const std::array out{&row.x, &row.y, &row.z};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    place_points(edge[0].data(), edge[1].data(), edge[2].data(), scale[i] * (o(axis, 0) * s + o(axis, 1) * c),
                 scale[i] * (o(axis, 1) * s - o(axis, 0) * c), scale[i] * o(axis, 2), scale[i] * beside[axis],
                 out[i]->data(), row.begin, row.end);
  }
}

// What a tooth sweeps in a stretch.
struct PathSweep::Sheet {
  const PathSweep& sweep;
  const Stretch& stretch;
  const ContactWindow& window;
  std::size_t tooth;

  [[nodiscard]] std::size_t points() const { return sweep.points_.size(); }
  [[nodiscard]] EdgeRange range(std::int64_t first, std::int64_t last) const {
    const double step_angle = kTwoPi / static_cast<double>(sweep.steps_per_turn_);
    const std::int64_t in_turn = (first % sweep.steps_per_turn_ + sweep.steps_per_turn_) % sweep.steps_per_turn_;
    const double from = step_angle * static_cast<double>(in_turn);
    const ContactWindow::Kappas kappas = window.between(from, from + step_angle * static_cast<double>(last - first));
    if (kappas.empty()) return {};
    const double pieces = static_cast<double>(points() - 1), per_radian = pieces / kEquator;
    return {static_cast<int>(std::max(0.0, std::floor(kappas.low * per_radian) - 1.0)),
            static_cast<int>(std::min(pieces, std::ceil(kappas.high * per_radian) + 1.0)) + 1};
  }
  [[nodiscard]] double sag(int knot, int axis) const {
    const double sag = sweep.sag_[static_cast<std::size_t>(knot)];
    return axis == 0 ? sag / sweep.spacing_along_ : axis == 1 ? sag / sweep.spacing_across_ : sag;
  }
  void place(std::int64_t step, int begin, int end, EdgeRow& row) const {
    row.begin = begin, row.end = end;
    sweep.place(stretch.piece, tooth, step, sweep.columns_, row);
  }
  void place_knots(std::int64_t step, int begin, int end, EdgeRow& row) const {
    row.begin = begin, row.end = end;
    sweep.place(stretch.piece, tooth, step, sweep.knots_, row);
  }
};

SweepCount PathSweep::sweep(HeightMap& map, const MapTile& tile) const {
  PatchCanvas canvas(map, tile);
  SheetRows rows(points_.size());
  const double step_angle = kTwoPi / static_cast<double>(steps_per_turn_);
  double highest = canvas.highest();
  for (const Stretch& stretch : stretches_over(tile)) {
    if (!(stretch.lowest < highest)) continue;
    const ContactWindow window = contact(stretch, canvas);
    if (window.empty()) continue;
    for (std::size_t tooth = 0; tooth < path_.tooth_angle.size(); ++tooth) {
      const double begin = (stretch.begin + path_.tooth_angle[tooth]) / step_angle,
                   end = (stretch.end + path_.tooth_angle[tooth]) / step_angle;
      const double first = stretch.comes_on ? std::ceil(begin) : std::floor(begin), last = std::ceil(end);
      sweep_sheet(Sheet{*this, stretch, window, tooth}, static_cast<std::int64_t>(first),
                  static_cast<std::int64_t>(last), kInfinite, canvas, rows);
      canvas.settle();
    }
    highest = canvas.highest();
  }
  return canvas.count();
}

}  // namespace stillcut
