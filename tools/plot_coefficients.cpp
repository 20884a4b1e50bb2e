#include "tools/plot_coefficients.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace stillcut {
namespace {

constexpr std::array kDepthColors{plot::kBlue,   plot::kVermilion, plot::kGreen,
                                  plot::kOrange, plot::kPurple,    plot::kSkyBlue};
constexpr std::array kAxisTitles{"Along the feed, x", "Across the feed, y", "Along the tool's axis, z"};
constexpr double kBeyond = 1.06;  // of the largest feed: where the lines end

std::vector<double> depths_of(const std::vector<SlotTest>& tests) {
  std::vector<double> depths;
  depths.reserve(tests.size());
  for (const SlotTest& test : tests) depths.push_back(test.axial_depth);
  std::sort(depths.begin(), depths.end());
  depths.erase(std::unique(depths.begin(), depths.end()), depths.end());
  return depths;
}

std::string depth_label(double depth) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%g mm deep", depth * 1e3);
  return text.data();
}

std::string panel_title(std::size_t axis, const AxisFit& fit) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "%s: R² %.4f, scatter %.3g N", kAxisTitles.at(axis), fit.r_squared,
                fit.scatter);
  return text.data();
}

}  // namespace

plot::Figure slot_figure(const std::string& subtitle, const Tool& tool, const std::vector<SlotTest>& tests,
                         const SlotFit& fit) {
  double fastest = 0.0;
  for (const SlotTest& test : tests) fastest = std::max(fastest, test.feed_per_tooth);
  const std::vector<double> depths = depths_of(tests);
  plot::Figure figure;
  figure.title = "Mean forces on the tool in slots";
  figure.subtitle = subtitle;
  figure.x.label = "feed per tooth [mm]";
  figure.x.min = 0.0;
  figure.x.max = kBeyond * fastest * 1e3;
  figure.height = 1000;
  for (std::size_t axis = 0; axis < fit.axes.size(); ++axis) {
    plot::Panel& panel = figure.panels.emplace_back();
    panel.title = panel_title(axis, fit.axes.at(axis));
    panel.y.label = "force [N]";
    for (std::size_t d = 0; d < depths.size(); ++d) {
      const plot::Color color = kDepthColors.at(d % kDepthColors.size());
      plot::Line line{.x = {}, .y = {}, .color = color, .label = axis == 0 ? depth_label(depths[d]) : ""};
      for (const double feed : {0.0, kBeyond * fastest}) {
        line.x.push_back(feed * 1e3);
        line.y.push_back((slot_influence(tool, feed, depths[d]) * fit.value)[static_cast<Eigen::Index>(axis)]);
      }
      plot::Scatter points{.x = {}, .y = {}, .color = color, .label = ""};
      for (const SlotTest& test : tests) {
        if (test.axial_depth != depths[d]) continue;
        points.x.push_back(test.feed_per_tooth * 1e3);
        points.y.push_back(test.mean_force[static_cast<Eigen::Index>(axis)]);
      }
      panel.lines.push_back(std::move(line));
      panel.points.push_back(std::move(points));
    }
  }
  return figure;
}

}  // namespace stillcut
