#include "tools/plot_patterns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "models/places.hpp"

namespace stillcut {
namespace {

constexpr std::array<plot::Color, 6> kGroupColors{plot::kBlue,   plot::kVermilion, plot::kGreen,
                                                  plot::kPurple, plot::kOrange,    plot::kSkyBlue};

std::string plot_number(double value, int decimals) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

struct Extent {
  double x_low = kInfinity, x_high = -kInfinity, y_low = kInfinity, y_high = -kInfinity;  // mm
  void take(double x, double y) {
    x_low = std::min(x_low, x), x_high = std::max(x_high, x);
    y_low = std::min(y_low, y), y_high = std::max(y_high, y);
  }
};

// A square figure of the workpiece's plane, as long along X as along Y.
plot::Figure plane_figure(plot::Panel panel, Extent extent) {
  const double half = 0.5 * 1.12 * std::max({extent.x_high - extent.x_low, extent.y_high - extent.y_low, 1.0});
  const double x = 0.5 * (extent.x_low + extent.x_high), y = 0.5 * (extent.y_low + extent.y_high);
  panel.y = {"Y, mm", y - half, y + half};
  plot::Figure figure;
  figure.x = {"X, mm", x - half, x + half};
  figure.panels = {std::move(panel)};
  figure.width = 900;
  figure.height = 980;
  return figure;
}

void add_stroke(plot::Line& line, double x0, double y0, double x1, double y1) {
  line.x.insert(line.x.end(), {x0, x1, kNaN});
  line.y.insert(line.y.end(), {y0, y1, kNaN});
}

// The region's polygon and islands, in grey.
void add_outline(const PatternStudy& study, plot::Panel& panel, Extent& extent) {
  if (!study.region) return;
  std::vector<Contour> contours{study.region->polygon};
  contours.insert(contours.end(), study.region->islands.begin(), study.region->islands.end());
  for (const Contour& contour : contours) {
    plot::Line line;
    for (std::size_t i = 0; i <= contour.size(); ++i) {
      const Eigen::Vector2d& point = contour[i % contour.size()];
      line.x.push_back(1e3 * point.x());
      line.y.push_back(1e3 * point.y());
      extent.take(1e3 * point.x(), 1e3 * point.y());
    }
    line.color = plot::kGrey;
    line.width = 1.0;
    panel.lines.push_back(std::move(line));
  }
}

bool is_line(const RatedPattern& pattern) { return pattern.source == PatternSource::lines; }

double reach_mm(const PatternStudy& study) {
  std::vector<Eigen::Vector2d> places;
  for (const LocationLimits& location : study.table.locations) places.push_back(location.place);
  const double reach = reach_of(places);
  return std::isfinite(reach) ? 1e3 * reach : 20.0;
}

}  // namespace

plot::Figure ranking_figure(const PatternStudy& study) {
  constexpr std::size_t kLinesShown = 6;  // beside the landmarks and the other patterns: names need their room
  std::vector<const RatedPattern*> shown;
  for (const RatedPattern& pattern : study.patterns) {
    const bool line = is_line(pattern);
    const auto lines = static_cast<std::size_t>(
        std::count_if(shown.begin(), shown.end(), [](const RatedPattern* other) { return is_line(*other); }));
    const bool landmark = pattern.name == "zig 0" || pattern.name == "zig 90";
    if (!line || landmark || lines < kLinesShown) shown.push_back(&pattern);
  }
  if (!study.optimized.path.moves.empty()) shown.insert(shown.begin(), &study.optimized);
  plot::Panel panel;
  plot::Axis names{"", 0.4, static_cast<double>(shown.size()) + 0.6};
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const double middle = static_cast<double>(i) + 1.0, value = 100.0 * shown[i]->rating.asi;
    names.names.push_back(shown[i]->name);
    plot::Area bar;
    bar.x = {middle - 0.36, middle + 0.36};
    bar.low = {0.0, 0.0};
    bar.high = {value, value};
    bar.opacity = 0.85;
    bar.color = is_line(*shown[i]) ? plot::kBlue : shown[i] == &study.optimized ? plot::kGreen : plot::kOrange;
    panel.areas.push_back(bar);
    panel.notes.push_back({middle - 0.3, value + 1.5, plot_number(value, 1), plot::kInk});
  }
  panel.y = {"absolute stability index, %", 0.0, 112.0};
  plot::Figure figure;
  figure.title = "Patterns ranked by what they leave of each location's best direction";
  figure.subtitle = "mean of a_abs along the pattern over a_abs of the best direction there";
  figure.x = names;
  figure.panels = {std::move(panel)};
  figure.width = 1500;
  figure.height = 560;
  return figure;
}

plot::Figure field_figure(const PatternStudy& study) {
  plot::Panel panel;
  Extent extent;
  const double half = 0.36 * reach_mm(study);
  std::vector<plot::Line> groups(std::min(study.field.groups.size(), kGroupColors.size()));
  plot::Line best;
  best.color = plot::kGrey;
  best.dashed = true;
  best.width = 1.2;
  for (std::size_t i = 0; i < study.table.locations.size(); ++i) {
    const ChosenDirection& choice = study.field.locations[i];
    const double x = 1e3 * study.table.locations[i].place.x(), y = 1e3 * study.table.locations[i].place.y();
    extent.take(x - half, y - half);
    extent.take(x + half, y + half);
    const auto stroke = [&](plot::Line& line, double direction) {
      const double dx = half * std::cos(direction), dy = half * std::sin(direction);
      add_stroke(line, x - dx, y - dy, x + dx, y + dy);
    };
    stroke(groups[std::min(choice.group, groups.size() - 1)], choice.chosen);
    if (choice.outlier) stroke(best, choice.best);
  }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    groups[g].color = kGroupColors[g];
    groups[g].width = 3.0;
    groups[g].label = "group of " + plot_number(rad_to_deg(study.field.groups[g].direction), 0) + "°";
    panel.lines.push_back(groups[g]);
  }
  if (!best.x.empty()) {
    best.label = "an outlier's own best";
    panel.lines.push_back(best);
  }
  add_outline(study, panel, extent);
  plot::Line patches;
  patches.color = plot::kInk;
  patches.width = 0.8;
  patches.label = "patches of the plan";
  for (const PlannedPatch& patch : study.plan.patches) {
    if (study.plan.patches.size() < 2) break;
    const double left = std::max(1e3 * patch.x_begin, extent.x_low), right = std::min(1e3 * patch.x_end, extent.x_high);
    const double low = std::max(1e3 * patch.y_begin, extent.y_low), high = std::min(1e3 * patch.y_end, extent.y_high);
    add_stroke(patches, left, low, right, low);
    add_stroke(patches, right, low, right, high);
    add_stroke(patches, right, high, left, high);
    add_stroke(patches, left, high, left, low);
    panel.notes.push_back({left + 0.02 * (extent.x_high - extent.x_low), high - 0.03 * (extent.y_high - extent.y_low),
                           plot_number(rad_to_deg(patch.direction), 0) + "°", plot::kInk});
  }
  if (!patches.x.empty()) panel.lines.push_back(patches);
  plot::Figure figure = plane_figure(std::move(panel), extent);
  figure.title = "Feed direction to choose at each location";
  figure.subtitle =
      "highest limit at any speed; outliers brought back to what is nearly as good and fits the neighbours";
  return figure;
}

plot::Figure common_lobes_figure(const PatternStudy& study, const RatedPattern& pattern) {
  plot::Panel panel;
  std::vector<double> rpm;
  for (const double speed : study.table.speeds) rpm.push_back(rad_s_to_rpm(speed));
  const std::vector<const DirectionCurve*> curves = curves_along(study.table, pattern.on.cuts);
  const auto in_mm = [&](std::vector<double> limits) {
    for (double& limit : limits) limit = 1e3 * std::min(limit, study.table.max_depth);
    return limits;
  };
  double highest = 0.0;
  for (const DirectionCurve* curve : curves) {
    plot::Line line;
    line.x = rpm;
    line.y = in_mm(curve->limits);
    line.color = plot::kSkyBlue;
    line.width = 1.0;
    line.opacity = 0.6;
    if (curve == curves.front()) line.label = "at each location";
    highest = std::max(highest, *std::max_element(line.y.begin(), line.y.end()));
    panel.lines.push_back(std::move(line));
  }
  const std::vector<double> common = common_limits(curves, study.table.max_depth);
  plot::Area stable;
  stable.x = rpm;
  stable.low.assign(rpm.size(), 0.0);
  stable.high = in_mm(common);
  stable.color = plot::kGreen;
  stable.label = "stable at all of them";
  panel.areas.push_back(stable);
  const Pocket pocket = deepest_pocket(common, study.table.speeds);
  panel.points.push_back({{rad_s_to_rpm(pocket.speed)}, {1e3 * pocket.depth}, plot::kVermilion, 8.0, "common pocket"});
  panel.y = {"axial depth, mm", 0.0, std::min(1.05 * highest, 6e3 * pocket.depth + 1e-3)};
  plot::Figure figure;
  figure.title = pattern.name + ": lobes of all locations along the path";
  figure.subtitle = "common pocket " + plot_number(1e3 * pocket.depth, 3) + " mm at " +
                    plot_number(rad_s_to_rpm(pocket.speed), 0) + " rpm";
  figure.x = {"spindle speed, rpm"};
  figure.panels = {std::move(panel)};
  figure.height = 620;
  return figure;
}

plot::Figure path_figure(const PatternStudy& study, const RatedPattern& pattern, double axial_depth,
                         double spindle_speed) {
  struct Class {
    double above = 0.0;  // margin
    plot::Color color{};
    const char* label = "";
  };
  static constexpr std::array<Class, 4> kClasses{{{0.5, plot::kBlue, "margin over 50 %"},
                                                  {0.2, plot::kGreen, "20 to 50 %"},
                                                  {0.0, plot::kOrange, "0 to 20 %"},
                                                  {-kInfinity, plot::kVermilion, "chatters"}}};
  std::vector<Eigen::Vector2d> places;
  for (const LocationLimits& location : study.table.locations) places.push_back(location.place);
  const double piece = 1e-3 * reach_mm(study) / 4.0;
  std::array<plot::Line, kClasses.size()> lines;
  plot::Line air, links;
  Extent extent;
  const bool to_and_fro =
      std::any_of(pattern.on.cuts.begin(), pattern.on.cuts.end(), [](const LocalCut& cut) { return cut.alternating; });
  for (const PathMove& move : pattern.path.moves) {
    const Eigen::Vector2d from = move.from.head<2>(), way = move.to.head<2>() - from;
    if (way.norm() < 1e-9) continue;
    extent.take(1e3 * move.from.x(), 1e3 * move.from.y());
    extent.take(1e3 * move.to.x(), 1e3 * move.to.y());
    if (move.cutting && move.milling == Milling::slot) {
      add_stroke(links, 1e3 * move.from.x(), 1e3 * move.from.y(), 1e3 * move.to.x(), 1e3 * move.to.y());
      continue;
    }
    if (!move.cutting) {
      add_stroke(air, 1e3 * move.from.x(), 1e3 * move.from.y(), 1e3 * move.to.x(), 1e3 * move.to.y());
      continue;
    }
    const double speed = std::isnan(move.spindle_speed) ? spindle_speed : move.spindle_speed;
    const int pieces = std::max(1, static_cast<int>(std::ceil(way.norm() / piece)));
    for (int i = 0; i < pieces; ++i) {
      const Eigen::Vector2d a = from + way * (static_cast<double>(i) / pieces), b = from + way * ((i + 1.0) / pieces);
      const std::size_t location = nearest_place(0.5 * (a + b), places);
      const double margin =
          limit_along(study.table, location, std::atan2(way.y(), way.x()), speed, to_and_fro) / axial_depth - 1.0;
      std::size_t c = 0;
      while (margin < kClasses[c].above) ++c;
      add_stroke(lines[c], 1e3 * a.x(), 1e3 * a.y(), 1e3 * b.x(), 1e3 * b.y());
    }
  }
  plot::Panel panel;
  add_outline(study, panel, extent);
  air.color = plot::kGrey;
  air.width = 0.5;
  air.opacity = 0.5;
  air.dashed = true;
  panel.lines.push_back(air);
  links.color = plot::kGrey;
  links.width = 2.2;
  links.label = links.x.empty() ? "" : "links, cut to both sides: not rated";
  panel.lines.push_back(links);
  for (std::size_t c = 0; c < kClasses.size(); ++c) {
    lines[c].color = kClasses[c].color;
    lines[c].width = 2.2;
    lines[c].label = lines[c].x.empty() ? "" : kClasses[c].label;
    panel.lines.push_back(lines[c]);
  }
  plot::Figure figure = plane_figure(std::move(panel), extent);
  figure.title = pattern.name + ", coloured by its margin against chatter";
  figure.subtitle = "a_lim / a − 1 at " + plot_number(1e3 * axial_depth, 3) + " mm of depth";
  return figure;
}

}  // namespace stillcut
