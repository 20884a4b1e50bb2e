#include "tools/plot_legend.hpp"

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

namespace stillcut::plot {
namespace {

constexpr double kSample = 28.0, kApart = 16.0, kRowHeight = 18.0;

struct Entry {
  const std::string* label;
  std::function<void(double from, double to, double y)> sample;  // drawn between two x, around y
  double x = 0.0;                                                // of the label's left end
  int row = 0;                                                   // above the title's line
};

// What is labelled: lines, then markers, areas and bands.
std::vector<Entry> entries_of(Canvas& canvas, const Panel& panel) {
  std::vector<Entry> entries;
  const auto add = [&](const std::string& label, auto&& sample) {
    if (!label.empty()) entries.push_back({&label, sample});
  };
  for (const Line& line : panel.lines)
    add(line.label, [&](double a, double b, double y) {
      canvas.segment(a, y, b, y, line.color, std::max(1.5, line.width), line.dashed);
    });
  for (const Scatter& points : panel.points)
    add(points.label, [&](double a, double b, double y) {
      canvas.marker(0.5 * (a + b), y, std::max(6.0, points.size), points.color, points.marker);
    });
  for (const Area& area : panel.areas)
    add(area.label, [&](double a, double b, double y) {
      canvas.rectangle({a, y - 6, b, y + 5}, area.color, area.opacity);
    });
  for (const Band& band : panel.bands)
    add(band.label, [&](double a, double b, double y) {
      canvas.rectangle({a, y - 6, b, y + 5}, band.color, std::min(1.0, band.opacity * 1.5));
    });
  return entries;
}

// Places the entries from the last to the first, right to left, and in a further row where the line is full.
std::vector<Entry> placed_entries(Canvas& canvas, Box box, const Panel& panel) {
  std::vector<Entry> entries = entries_of(canvas, panel);
  double x = box.right, left = box.left + canvas.text_width(panel.title, kPanelText, true) + kApart;
  int row = 0;
  for (auto entry = entries.rbegin(); entry != entries.rend(); ++entry) {
    const double width = canvas.text_width(*entry->label, kSmallText);
    if (x - width - kSample < left && x < box.right) {
      x = box.right, left = box.left;
      ++row;
    }
    entry->x = x - width;
    entry->row = row;
    x = entry->x - kSample - kApart;
  }
  return entries;
}

}  // namespace

double legend_overhang(Canvas& canvas, Box box, const Panel& panel) {
  int row = 0;
  for (const Entry& entry : placed_entries(canvas, box, panel)) row = std::max(row, entry.row);
  return row * kRowHeight;
}

void draw_legend(Canvas& canvas, Box box, const Panel& panel) {
  for (const Entry& entry : placed_entries(canvas, box, panel)) {
    const double y = box.top - 10 - entry.row * kRowHeight;
    canvas.text(entry.x, y + 4, *entry.label, {.size = kSmallText});
    if (panel.image)  // as the data's ground is
      canvas.rectangle({entry.x - 30, y - 7, entry.x - 4, y + 6}, scale_color(0.25));
    entry.sample(entry.x - kSample, entry.x - 6, y);
  }
}

}  // namespace stillcut::plot
