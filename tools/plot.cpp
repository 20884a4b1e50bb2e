#include "tools/plot.hpp"

#include <algorithm>
#include <cmath>

#include "tools/plot_canvas.hpp"
#include "tools/plot_legend.hpp"
#include "tools/plot_scale.hpp"

namespace stillcut::plot {
namespace {

constexpr double kLeft = 92, kRight = 28, kScaleRight = 92, kTop = 24, kAbove = 10, kBottom = 52, kBetween = 20,
                 kTitleRoom = 20;
constexpr double kSmall = kSmallText, kMiddle = kPanelText, kLarge = 19.0;
constexpr Color kGrid{0.90, 0.90, 0.92}, kFrame{0.45, 0.45, 0.48};

// From data to px in one panel.
struct View {
  Box box;
  Range x, y;  // y: of the logarithms on a logarithmic axis
  bool logarithmic = false;
  const std::vector<std::string>* names = nullptr;  // of the x axis
  [[nodiscard]] double px(double value) const { return box.left + (value - x.low) / x.span() * box.width(); }
  [[nodiscard]] double py(double value) const {
    const double at = !logarithmic ? value : value > 0.0 ? std::log10(value) : std::isnan(value) ? value : y.low;
    return box.bottom - (at - y.low) / y.span() * box.height();
  }
};

// Shrinks the box so that a step along x and along y is as long.
void draw_to_scale(View& view) {
  const double scale = std::min(view.box.width() / view.x.span(), view.box.height() / view.y.span());
  view.box.right = view.box.left + scale * view.x.span();
  view.box.bottom = view.box.top + scale * view.y.span();
}

struct Tick {
  double value;
  std::string text;
};

std::vector<Tick> ticks_of(Range range, int count, bool logarithmic) {
  std::vector<Tick> result;
  const std::vector<double> at = logarithmic ? decade_ticks(range) : ticks(range, count);
  for (const double value : at) {
    if (logarithmic) {
      result.push_back({std::pow(10.0, value), decade_text(value)});
    } else {
      result.push_back({value, tick_text(value, at.size() > 1 ? at[1] - at[0] : 1.0)});
    }
  }
  return result;
}

// Names at 1, 2, ..., so many of them as have room.
std::vector<Tick> name_ticks(const View& view) {
  constexpr double kCharacter = 7.5;  // px, about
  std::size_t longest = 1;
  for (const std::string& name : *view.names) longest = std::max(longest, name.size());
  const double room = view.box.width() / view.x.span(), wanted = kCharacter * static_cast<double>(longest + 2);
  const auto step = static_cast<std::size_t>(std::max(1.0, std::ceil(wanted / room)));
  std::vector<Tick> result;
  for (std::size_t i = 0; i < view.names->size(); i += step)
    result.push_back({static_cast<double>(i + 1), (*view.names)[i]});
  return result;
}

std::vector<Tick> x_ticks(const View& view) {
  constexpr double kRoom = 60.0;  // px, of a number
  const int count = std::clamp(static_cast<int>(view.box.width() / kRoom), 3, 12);
  return view.names->empty() ? ticks_of(view.x, count, false) : name_ticks(view);
}
std::vector<Tick> y_ticks(const View& view) {
  return ticks_of(view.y, std::max(3, static_cast<int>(view.box.height() / 34)), view.logarithmic);
}

const Axis& x_axis(const Figure& figure, const Panel& panel) { return panel.x ? *panel.x : figure.x; }

// Of a panel's own axis, or of all panels that share the figure's.
Range x_range(const Figure& figure, const Panel* own) {
  std::vector<const std::vector<double>*> data;
  std::vector<double> ends;
  for (const Panel& panel : figure.panels) {
    if (own != nullptr ? &panel != own : panel.x.has_value()) continue;
    for (const Line& line : panel.lines) data.push_back(&line.x);
    for (const Scatter& points : panel.points) data.push_back(&points.x);
    if (panel.image) ends.insert(ends.end(), {panel.image->x_begin, panel.image->x_end});
  }
  data.push_back(&ends);
  return axis_range(own != nullptr ? *own->x : figure.x, data, 0.0);
}

Range y_range(const Panel& panel) {
  std::vector<const std::vector<double>*> data;
  std::vector<double> levels;
  for (const Line& line : panel.lines) data.push_back(&line.y);
  for (const Scatter& points : panel.points) data.push_back(&points.y);
  for (const Limit& limit : panel.limits) levels.push_back(limit.y);
  if (panel.image) return axis_range({.label = "", .min = panel.image->y_begin, .max = panel.image->y_end}, data, 0.0);
  data.push_back(&levels);
  return axis_range(panel.y, data, 0.07);
}

void draw_grid(Canvas& canvas, const View& view) {
  for (const Tick& x : x_ticks(view))
    canvas.segment(view.px(x.value), view.box.top, view.px(x.value), view.box.bottom, kGrid, 1.0, false);
  for (const Tick& y : y_ticks(view))
    canvas.segment(view.box.left, view.py(y.value), view.box.right, view.py(y.value), kGrid, 1.0, false);
}

void draw_axes(Canvas& canvas, const View& view, const Panel& panel, const Axis& x, bool last) {
  for (const Tick& y : y_ticks(view)) {
    canvas.segment(view.box.left - 4, view.py(y.value), view.box.left, view.py(y.value), kFrame, 1.0, false);
    canvas.text(view.box.left - 8, view.py(y.value) + 4, y.text, {.size = kSmall, .align = Align::right});
  }
  for (const Tick& tick : x_ticks(view)) {
    const double at = view.px(tick.value);
    canvas.segment(at, view.box.bottom, at, view.box.bottom + 4, kFrame, 1.0, false);
    if (last) canvas.text(at, view.box.bottom + 18, tick.text, {.size = kSmall, .align = Align::center});
  }
  canvas.outline(view.box, kFrame, 1.0);
  const double middle = 0.5 * (view.box.top + view.box.bottom);
  canvas.text(24, middle, panel.y.label, {.size = kMiddle, .align = Align::center, .upright = true});
  canvas.text(view.box.left, view.box.top - 6, panel.title, {.size = kMiddle, .bold = true});
  if (last)
    canvas.text(0.5 * (view.box.left + view.box.right), view.box.bottom + 40, x.label,
                {.size = kMiddle, .align = Align::center});
}

void draw_color_scale(Canvas& canvas, const View& view, const Image& image) {
  const Box bar{view.box.right + 12, view.box.top, view.box.right + 24, view.box.bottom};
  Image ramp{.x_begin = 0,
             .x_end = 1,
             .y_begin = 0,
             .y_end = 1,
             .columns = 1,
             .rows = 128,
             .values = {},
             .low = 0,
             .high = 127,
             .scale_label = ""};
  for (int i = 0; i < ramp.rows; ++i) ramp.values.push_back(static_cast<float>(i));
  canvas.image(bar, ramp);
  canvas.outline(bar, kFrame, 1.0);
  const Range range{image.low, image.high};
  for (const Tick& level : ticks_of(range, static_cast<int>(bar.height() / 40), false)) {
    const double y = bar.bottom - (level.value - range.low) / range.span() * bar.height();
    canvas.text(bar.right + 5, y + 4, level.text, {.size = kSmall - 1});
  }
  canvas.text(bar.right + 46, 0.5 * (bar.top + bar.bottom), image.scale_label,
              {.size = kSmall, .align = Align::center, .upright = true});
}

std::vector<double> mapped(std::vector<double> values, auto&& map) {
  std::transform(values.begin(), values.end(), values.begin(), map);
  return values;
}

void draw_line(Canvas& canvas, const View& view, const Line& line) {
  const Line few = decimated(line, view.x, static_cast<int>(view.box.width() * 1.5));
  canvas.polyline(mapped(few.x, [&](double v) { return view.px(v); }),
                  mapped(few.y, [&](double v) { return view.py(v); }), few);
}

void draw_data(Canvas& canvas, const View& view, const Panel& panel) {
  canvas.clip(view.box);
  if (panel.image) canvas.rectangle(view.box, scale_color(0.0));
  for (const Band& band : panel.bands)
    canvas.rectangle({view.px(band.begin), view.box.bottom - band.top * view.box.height(), view.px(band.end),
                      view.box.bottom - band.bottom * view.box.height()},
                     band.color, band.opacity);
  if (!panel.image) draw_grid(canvas, view);
  for (const Area& area : panel.areas)
    canvas.area(mapped(area.x, [&](double v) { return view.px(v); }),
                mapped(area.low, [&](double v) { return view.py(v); }),
                mapped(area.high, [&](double v) { return view.py(v); }), area.color, area.opacity);
  if (const auto& image = panel.image; image && image->columns > 0 && image->rows > 0)
    canvas.image({view.px(image->x_begin), view.py(image->y_end), view.px(image->x_end), view.py(image->y_begin)},
                 *image);
  for (const Line& line : panel.lines) draw_line(canvas, view, line);
  for (const Scatter& points : panel.points)
    for (std::size_t i = 0; i < points.x.size(); ++i)
      if (std::isfinite(points.x[i]) && std::isfinite(points.y[i]))
        canvas.marker(view.px(points.x[i]), view.py(points.y[i]), points.size, points.color, points.marker);
  for (const Limit& limit : panel.limits) {
    canvas.segment(view.box.left, view.py(limit.y), view.box.right, view.py(limit.y), limit.color, 1.3, true);
    const double above = view.py(limit.y) - view.box.top > 18.0 ? -5.0 : 15.0;  // or below it at the panel's upper edge
    canvas.text(view.box.left + 8 + limit.text_at * view.box.width(), view.py(limit.y) + above, limit.text,
                {.size = kSmall, .color = limit.color, .halo = true});
  }
  for (const EventMark& event : panel.events)
    canvas.segment(view.px(event.x), view.box.top, view.px(event.x), view.box.bottom, event.color, 1.3, false);
  canvas.unclip();
}

// Texts of events side by side where they would run into each other: the later one goes a line lower.
void draw_texts(Canvas& canvas, const View& view, const Panel& panel) {
  std::vector<double> row_end;
  for (const EventMark& event : panel.events) {
    if (event.text.empty() || event.x < view.x.low || event.x > view.x.high) continue;
    const double width = canvas.text_width(event.text, kSmall) + 10, x = view.px(event.x);
    const bool leftward = x + width > view.box.right;
    const double begin = leftward ? x - width : x;
    std::size_t row = 0;
    while (row < row_end.size() && row_end[row] > begin) ++row;
    if (row == row_end.size()) row_end.push_back(0.0);
    row_end[row] = begin + width;
    canvas.text(x + (leftward ? -5 : 5), view.box.top + 15 + 15 * static_cast<double>(row), event.text,
                {.size = kSmall, .color = event.color, .align = leftward ? Align::right : Align::left, .halo = true});
  }
  for (const Note& note : panel.notes) {
    const double x = view.px(note.x), width = canvas.text_width(note.text, kSmall);
    const Align align = x + width > view.box.right ? Align::right : Align::left;
    canvas.text(x, view.py(note.y), note.text, {.size = kSmall, .color = note.color, .align = align, .halo = true});
  }
}

// under_titles: room between them, or the upper edge, and the first panel, px.
void draw_figure(const Figure& figure, double under_titles, Canvas& canvas) {
  double top = kTop;
  if (!figure.title.empty()) canvas.text(kLeft, top += 14, figure.title, {.size = kLarge, .bold = true});
  if (!figure.subtitle.empty()) canvas.text(kLeft, top += 24, figure.subtitle, {.size = kMiddle, .color = kFrame});
  top += under_titles;

  double shares = 0.0;
  bool with_scale = false;
  for (const Panel& panel : figure.panels) {
    shares += panel.height;
    with_scale = with_scale || panel.image;
  }
  const double right = figure.width - (with_scale ? kScaleRight : kRight);
  double gaps = 0.0;
  const auto room_above = [&](const Panel& panel) {
    return kBetween + kTitleRoom + legend_overhang(canvas, {kLeft, 0.0, right, 0.0}, panel);
  };
  // An axis is written below the last of the panels that share it.
  const auto shows_axis = [&](std::size_t p) {
    return p + 1 == figure.panels.size() || figure.panels[p].x || figure.panels[p + 1].x;
  };
  for (std::size_t p = 0; p < figure.panels.size(); ++p)
    gaps += room_above(figure.panels[p]) + (shows_axis(p) ? kBottom : 0.0);
  const double room = figure.height - top - gaps;
  const Range shared = x_range(figure, nullptr);
  for (std::size_t p = 0; p < figure.panels.size(); ++p) {
    const Panel& panel = figure.panels[p];
    top += room_above(panel);
    const double bottom = top + room * panel.height / shares;
    const Axis& x = x_axis(figure, panel);
    View view{{kLeft, top, right, bottom},
              panel.x ? x_range(figure, &panel) : shared,
              y_range(panel),
              panel.y.logarithmic,
              &x.names};
    if (panel.same_scale) draw_to_scale(view);
    draw_data(canvas, view, panel);
    draw_axes(canvas, view, panel, x, shows_axis(p));
    if (panel.image) draw_color_scale(canvas, view, *panel.image);
    draw_texts(canvas, view, panel);
    draw_legend(canvas, view.box, panel);
    top = bottom + (shows_axis(p) ? kBottom : 0.0);
  }
  canvas.finish();
}

}  // namespace

void write_figure(const Figure& figure, const std::filesystem::path& file) {
  Canvas canvas(file, figure.width, figure.height);
  draw_figure(figure, kAbove, canvas);
}

std::string figure_bytes(const Figure& figure, Format format) {
  std::string bytes;
  Canvas canvas(bytes, format, figure.width, figure.height);
  // Without a title there is nothing for the panels to stand off from: the page has its own.
  draw_figure(figure, figure.title.empty() ? -kBetween : kAbove, canvas);
  return bytes;
}

}  // namespace stillcut::plot
