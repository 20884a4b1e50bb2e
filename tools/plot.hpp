// Pictures of cuts: charts stacked in panels over one axis, drawn by cairo to .svg or .png. A figure is a plain value
// that says what is to be seen; write_figure lays it out and draws it. A command that draws the same figure writes the
// same bytes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dsp/numbers.hpp"

namespace stillcut::plot {

struct Color {
  double red = 0.0, green = 0.0, blue = 0.0;  // 0..1
};

// Told apart by colour-blind readers too: the palette of Okabe and Ito (2008).
inline constexpr Color kInk{0.13, 0.13, 0.15}, kGrey{0.55, 0.55, 0.58}, kOrange{0.902, 0.624, 0.0},
    kSkyBlue{0.337, 0.706, 0.914}, kGreen{0.0, 0.620, 0.451}, kYellow{0.941, 0.894, 0.259}, kBlue{0.0, 0.447, 0.698},
    kVermilion{0.835, 0.369, 0.0}, kPurple{0.800, 0.475, 0.655};

struct Line {
  std::vector<double> x, y;  // same length; NaN breaks the line
  Color color = kBlue;
  double width = 1.4;
  bool dashed = false;
  double opacity = 1.0;
  std::string label;  // in the legend; empty: not there
};

enum class Marker { disc, diamond, cross };

struct Scatter {
  std::vector<double> x, y;
  Color color = kVermilion;
  double size = 5.0;  // diameter, px
  std::string label;
  Marker marker = Marker::disc;
};

struct Band {  // a stretch of the x axis, shaded
  double begin = 0.0, end = 0.0;
  Color color = kSkyBlue;
  double opacity = 0.18;
  std::string label;
  double bottom = 0.0, top = 1.0;  // share of the panel's height
};

struct Area {                        // between two lines, shaded
  std::vector<double> x, low, high;  // same length
  Color color = kSkyBlue;
  double opacity = 0.25;
  std::string label;
};

struct EventMark {  // a moment: vertical line through the panel, its text at the top
  double x = 0.0;
  std::string text;
  Color color = kInk;
};

struct Limit {  // a horizontal dashed line, its text at the left end
  double y = 0.0;
  std::string text;
  Color color = kVermilion;
  double text_at = 0.0;  // or this share of the panel's width further right, beside another limit's text
};

struct Note {  // text in the panel at a point of the data
  double x = 0.0, y = 0.0;
  std::string text;
  Color color = kInk;
};

// Values on a grid in colours from dark (low) to bright (high), white where NaN. Drawn under everything else of the
// panel.
struct Image {
  double x_begin = 0.0, x_end = 0.0, y_begin = 0.0, y_end = 0.0;
  int columns = 0, rows = 0;
  std::vector<float> values;  // rows * columns, the row of y_begin first
  double low = 0.0, high = 1.0;
  std::string scale_label;  // e.g. "dB re 1 m/s²"
};

struct Axis {
  std::string label;                 // with unit
  double min = kNaN, max = min;      // NaN: from the data
  bool logarithmic = false;          // y axes only; what is not above zero stands at the lower end
  std::vector<std::string> names{};  // x axes only: what stands at 1, 2, ... instead of numbers
};

struct Panel {
  std::string title;
  Axis y;
  std::optional<Axis> x{};  // its own, where it shows something else than the figure's other panels
  double height = 1.0;      // share of the figure's height, relative to the other panels
  bool same_scale = false;  // x and y are of one kind and drawn to one scale: the panel shrinks to it
  std::optional<Image> image;
  std::vector<Band> bands;
  std::vector<Area> areas;
  std::vector<Line> lines;
  std::vector<Scatter> points;
  std::vector<Limit> limits;
  std::vector<EventMark> events;
  std::vector<Note> notes;
};

struct Figure {
  std::string title, subtitle;
  Axis x;  // shared by all panels that have none of their own
  std::vector<Panel> panels;
  int width = 1200, height = 900;  // px; a .png has 1.5 times as many
};

// Throws InputError unless the name ends in .svg or .png: for a command to call before its long work.
void check_picture_name(const std::filesystem::path& file);

// Draws to `file`, .svg or .png by its name. Throws InputError for another name or a file that cannot be written.
void write_figure(const Figure& figure, const std::filesystem::path& file);

// The same into bytes, of an SVG or a PNG file, to be part of a page. Throws InputError.
enum class Format { svg, png };
[[nodiscard]] std::string figure_bytes(const Figure& figure, Format format);

}  // namespace stillcut::plot
