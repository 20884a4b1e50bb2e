#include "models/path_patterns.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "models/machining.hpp"
#include "models/pattern_passes.hpp"
#include "models/pattern_spiral.hpp"
#include "models/plane_pieces.hpp"

namespace stillcut {
namespace {

constexpr double kMostPasses = 10'000;    // across the region
constexpr double kStraight = 1e-7;        // m, off a line that is still straight
constexpr double kLongestLink = 2.0;      // tool diameters: more is faster through the air
constexpr double kSamePlace = 1e-9;       // m
constexpr double kWidthTolerance = 1e-3;  // of the tool, to which the region's widest place is sought

std::string length_in_mm(double length) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g mm", 1e3 * length);
  return text;
}

// Its lower left and its upper right corner.
std::pair<Eigen::Vector2d, Eigen::Vector2d> box_around(const Contour& contour) {
  Eigen::Vector2d low = contour.front(), high = low;
  for (const Eigen::Vector2d& point : contour) low = low.cwiseMin(point), high = high.cwiseMax(point);
  return {low, high};
}

void check(const Region& region, double angle, const PatternSettings& settings) {
  const double diameter = 2.0 * settings.tool_radius;
  if (!(diameter > 0.0 && std::isfinite(diameter)))
    throw std::invalid_argument("a tool " + length_in_mm(diameter) + " across cuts nothing; give its diameter");
  if (!(settings.step_over > 0.0 && settings.step_over <= diameter))
    throw std::invalid_argument("a step over of " + length_in_mm(settings.step_over) +
                                " is out of range; give one above 0 and up to the tool's diameter, " +
                                length_in_mm(diameter));
  if (settings.milling != Milling::down && settings.milling != Milling::up)
    throw std::invalid_argument("a pattern is down or up milling; give one of the two");
  if (!(std::isfinite(settings.z) && settings.clearance >= 0.0 && std::isfinite(settings.clearance)))
    throw std::invalid_argument("the tip's height or its clearance is no height; give numbers in mm, clearance from 0");
  if (!std::isfinite(angle)) throw std::invalid_argument("the pattern's angle is no number; give it in degrees");
  const auto [low, high] = box_around(region.polygon);
  if ((high - low).maxCoeff() > kMostPasses * settings.step_over)
    throw std::invalid_argument("a step over of " + length_in_mm(settings.step_over) +
                                " makes more than 10000 passes; give a larger one");
}

[[noreturn]] void refuse_tool(const Region& region, const PatternSettings& settings) {
  double fits = 0.0, too_large = settings.tool_radius;
  while (too_large - fits > kWidthTolerance * settings.tool_radius) {
    const double middle = 0.5 * (fits + too_large);
    (tool_centre_pieces(region, middle, settings.face).empty() ? too_large : fits) = middle;
  }
  throw std::invalid_argument("the tool, " + length_in_mm(2.0 * settings.tool_radius) +
                              " across, does not fit into the region, whose widest place takes " +
                              length_in_mm(2.0 * fits) + "; take a smaller tool or widen the region");
}

bool inward(PatternKind kind) { return kind == PatternKind::periphery_in || kind == PatternKind::spiral_in; }
bool lines(PatternKind kind) { return kind == PatternKind::zig || kind == PatternKind::zig_zag; }

Contour without_straight_points(const Contour& points) {
  Contour result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!result.empty() && (points[i] - result.back()).norm() < kSamePlace) continue;
    if (result.size() > 1) {
      const Eigen::Vector2d& a = result[result.size() - 2];
      const Eigen::Vector2d way = points[i] - a, part = result.back() - a;
      const double off = std::abs(way.x() * part.y() - way.y() * part.x()) / way.norm();
      if (off < kStraight && part.dot(way) > 0.0 && part.norm() < way.norm()) result.pop_back();
    }
    result.push_back(points[i]);
  }
  return result;
}

PlanePieces in_window(const PlanePieces& pieces, const Region& region, const PatternWindow& window) {
  const auto [low, high] = box_around(region.polygon);
  const double left = std::max(window.x_begin, low.x()), right = std::min(window.x_end, high.x());
  const double bottom = std::max(window.y_begin, low.y()), top = std::min(window.y_end, high.y());
  if (!(left < right && bottom < top)) return {};
  const PlanePiece frame{{{left, bottom}, {right, bottom}, {right, top}, {left, top}}, {}};
  return common_to(pieces, std::span(&frame, 1));
}

// Puts passes end to end: a link where the tool may stay down, otherwise up, across and down.
class PatternWriter {
 public:
  explicit PatternWriter(const PatternSettings& settings) : settings_(settings) {}

  void add(const PatternPass& pass, const PlanePiece* room) {
    const Contour points = without_straight_points(pass.points);
    if (path.moves.empty()) {
      at_ = above(points.front());
      move(down(points.front()), false, std::nullopt);
    } else if (room != nullptr && linked(*room, points.front())) {
      move(down(points.front()), true, Milling::slot);
    } else {
      move(above(at_.head<2>()), false, std::nullopt);
      move(above(points.front()), false, std::nullopt);
      move(down(points.front()), false, std::nullopt);
    }
    for (const Eigen::Vector2d& point : points) move(down(point), true, pass.milling);
  }

  void finish() {
    if (!path.moves.empty()) move(above(at_.head<2>()), false, std::nullopt);
  }

  ToolPath path;

 private:
  [[nodiscard]] Eigen::Vector3d down(const Eigen::Vector2d& point) const { return {point.x(), point.y(), settings_.z}; }
  [[nodiscard]] Eigen::Vector3d above(const Eigen::Vector2d& point) const {
    return {point.x(), point.y(), settings_.z + settings_.clearance};
  }
  [[nodiscard]] bool linked(const PlanePiece& room, const Eigen::Vector2d& to) const {
    const Eigen::Vector2d from = at_.head<2>();
    return (to - from).norm() <= kLongestLink * 2.0 * settings_.tool_radius && stays_inside(room, from, to);
  }
  void move(const Eigen::Vector3d& to, bool cutting, std::optional<Milling> milling) {
    if (to == at_) return;
    PathMove next;
    next.from = at_;
    next.to = at_ = to;
    next.cutting = cutting;
    next.milling = milling;
    path.moves.push_back(next);
  }

  PatternSettings settings_;
  Eigen::Vector3d at_ = Eigen::Vector3d::Zero();
};

}  // namespace

std::string pattern_name(PatternKind kind, double angle) {
  switch (kind) {
    case PatternKind::periphery_in:
      return "periphery in";
    case PatternKind::periphery_out:
      return "periphery out";
    case PatternKind::spiral_in:
      return "spiral in";
    case PatternKind::spiral_out:
      return "spiral out";
    case PatternKind::zig:
    case PatternKind::zig_zag:
      break;
  }
  const double rounded = std::round(100.0 * rad_to_deg(angle)) / 100.0 + 0.0;  // no minus before a zero
  char text[40];
  std::snprintf(text, sizeof text, "%s %.10g", kind == PatternKind::zig ? "zig" : "zig-zag", rounded);
  return text;
}

ToolPath make_pattern(const Region& given, PatternKind kind, double angle, const PatternSettings& settings) {
  const Region region = checked_region(given);
  check(region, angle, settings);
  PlanePieces pieces = tool_centre_pieces(region, settings.tool_radius, settings.face);
  if (settings.window) pieces = in_window(pieces, region, *settings.window);

  struct Placed {
    PatternPass pass;
    std::size_t piece;
  };
  std::vector<Placed> placed;
  // From the polygon's first point on, so that a region that is turned has its path turned.
  Eigen::Vector2d at = region.polygon.front();
  std::vector<std::size_t> left(pieces.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
  while (!left.empty()) {
    const auto distance = [&](std::size_t i) { return (nearest_on(pieces[i].outer, at).point - at).norm(); };
    const auto next =
        std::min_element(left.begin(), left.end(), [&](auto a, auto b) { return distance(a) < distance(b); });
    const PlanePiece& piece = pieces[*next];
    auto passes = lines(kind) ? line_passes(piece, kind == PatternKind::zig_zag, angle, settings)
                              : loop_passes(piece, kind == PatternKind::spiral_in || kind == PatternKind::spiral_out,
                                            at, settings);
    for (PatternPass& pass : passes) placed.push_back({std::move(pass), *next});
    if (!placed.empty()) at = placed.back().pass.points.back();
    left.erase(next);
  }
  if (placed.empty() && !settings.window) refuse_tool(region, settings);
  // What goes inward with uncut material inside goes outward, taken backward, with it outside, on the same hand.
  if (!lines(kind) && !inward(kind)) {
    std::reverse(placed.begin(), placed.end());
    for (Placed& each : placed) std::reverse(each.pass.points.begin(), each.pass.points.end());
  }

  PatternWriter writer(settings);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const bool may_link = kind != PatternKind::zig && i > 0 && placed[i - 1].piece == placed[i].piece;
    writer.add(placed[i].pass, may_link ? &pieces[placed[i].piece] : nullptr);
  }
  writer.finish();
  writer.path.name = pattern_name(kind, angle);
  return std::move(writer.path);
}

}  // namespace stillcut
