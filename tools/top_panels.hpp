// The panels of `stillcut top`: each draws what was heard of one matter in a rectangle.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/cell_view.hpp"
#include "tools/styled_text.hpp"
#include "tools/top_screen.hpp"

namespace stillcut {

// Text, drawn for a width, or a picture, drawn for a width in any number of rows.
struct TopPanel {
  std::string title;
  std::vector<TextLine> lines;
  int least = 4;  // rows below the title without which it is better on another page
  std::function<std::vector<TextLine>(int rows)> picture;

  [[nodiscard]] int wanted() const { return picture ? 10 : static_cast<int>(lines.size()); }
};

// Speeds, chatter, indicator, margin: always shown, a row each.
std::vector<TextLine> reading_lines(const CellView& view, const TopScene& scene, int columns);

TopPanel spectrum_panel(const CellView& view, int sensor, int columns);
TopPanel lobes_panel(const CellView& view, int columns);
TopPanel corrections_panel(const CellView& view, int columns);
TopPanel events_panel(const CellView& view, int columns);
TopPanel sensors_panel(const CellView& view, int columns);
TopPanel losses_panel(const CellView& view, std::int64_t unreadable, int columns);
TopPanel latency_panel(const CellView& view);
TopPanel spread_panel(const CellView& view);

// A panel without anything to show yet.
TopPanel empty_panel(std::string title, const char* why);

// "11220 rpm", "speed variation of 10.0 % at 2.00 Hz", "stop", ...
std::string asked_text(const Correction& correction);
// "; limited by: speed range, path", or nothing.
std::string limits_text(std::int32_t limited_by);
std::string list_of(const std::vector<std::string>& names);

// "11220 rpm", or "unknown" for what is not finite.
std::string number_text(const char* format, double value, const char* otherwise = "unknown");
// "12:03:04.123", local time.
std::string clock_text(std::int64_t stamp_ns);
// A scale from `low` to `high` between brackets, `columns` wide, with marks at values; those beyond stand at its ends.
struct ScaleMark {
  double value;
  char mark;
  Ink ink;
};
TextLine scale_line(double low, double high, const std::vector<ScaleMark>& marks, int columns);

}  // namespace stillcut
