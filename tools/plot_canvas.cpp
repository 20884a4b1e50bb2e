#include "tools/plot_canvas.hpp"

#include <cairo-svg.h>

#include <array>
#include <cmath>
#include <numbers>

#include "drivers/files/input_error.hpp"

namespace stillcut::plot {
namespace {

constexpr double kPngScale = 1.5;  // px of the file for a px of the figure: sharp on today's screens

bool is_png(const std::filesystem::path& file) {
  if (file.extension() == ".png") return true;
  if (file.extension() == ".svg") return false;
  throw InputError(file.string(), 0, "a picture's name must end in .svg or .png");
}

cairo_surface_t* open_surface(const std::filesystem::path& file, bool png, int width, int height) {
  if (!png) return cairo_svg_surface_create(file.c_str(), width, height);
  const auto scaled = [](int size) { return static_cast<int>(std::lround(size * kPngScale)); };
  return cairo_image_surface_create(CAIRO_FORMAT_RGB24, scaled(width), scaled(height));
}

cairo_status_t append_bytes(void* bytes, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

void check_picture_name(const std::filesystem::path& file) { (void)is_png(file); }

Canvas::Canvas(const std::filesystem::path& file, int width, int height)
    : file_{file},
      png_{is_png(file)},
      surface_{open_surface(file, png_, width, height)},
      cairo_{cairo_create(surface_.get())} {
  begin(width, height);
}

Canvas::Canvas(std::string& bytes, Format format, int width, int height)
    : file_{"picture"},
      png_{format == Format::png},
      bytes_{&bytes},
      surface_{png_ ? open_surface({}, true, width, height)
                    : cairo_svg_surface_create_for_stream(append_bytes, &bytes, width, height)},
      cairo_{cairo_create(surface_.get())} {
  begin(width, height);
}

void Canvas::begin(int width, int height) {
  if (cairo_status(cairo_.get()) != CAIRO_STATUS_SUCCESS)
    throw InputError(file_.string(), 0,
                     std::string("cannot write the picture: ") + cairo_status_to_string(cairo_status(cairo_.get())));
  if (png_) cairo_scale(cairo_.get(), kPngScale, kPngScale);
  cairo_set_line_join(cairo_.get(), CAIRO_LINE_JOIN_ROUND);
  rectangle({0, 0, static_cast<double>(width), static_cast<double>(height)}, {1, 1, 1});
}

void Canvas::finish() {
  cairo_surface_flush(surface_.get());
  cairo_status_t status = CAIRO_STATUS_SUCCESS;
  if (png_)
    status = bytes_ != nullptr ? cairo_surface_write_to_png_stream(surface_.get(), append_bytes, bytes_)
                               : cairo_surface_write_to_png(surface_.get(), file_.c_str());
  cairo_surface_finish(surface_.get());
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface_.get());
  if (status != CAIRO_STATUS_SUCCESS)
    throw InputError(file_.string(), 0, std::string("cannot write the picture: ") + cairo_status_to_string(status));
}

void Canvas::set_color(Color color, double opacity) {
  cairo_set_source_rgba(cairo_.get(), color.red, color.green, color.blue, opacity);
}

void Canvas::set_font(double size, bool bold) {
  cairo_select_font_face(cairo_.get(), "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo_.get(), size);
}

void Canvas::rectangle(Box box, Color color, double opacity) {
  set_color(color, opacity);
  cairo_rectangle(cairo_.get(), box.left, box.top, box.width(), box.height());
  cairo_fill(cairo_.get());
}

void Canvas::outline(Box box, Color color, double width) {
  set_color(color, 1.0);
  cairo_set_line_width(cairo_.get(), width);
  cairo_rectangle(cairo_.get(), box.left, box.top, box.width(), box.height());
  cairo_stroke(cairo_.get());
}

void Canvas::segment(double x0, double y0, double x1, double y1, Color color, double width, bool dashed,
                     double opacity) {
  polyline({x0, x1}, {y0, y1},
           {.x = {}, .y = {}, .color = color, .width = width, .dashed = dashed, .opacity = opacity, .label = ""});
}

void Canvas::polyline(const std::vector<double>& x, const std::vector<double>& y, const Line& style) {
  set_color(style.color, style.opacity);
  cairo_set_line_width(cairo_.get(), style.width);
  constexpr std::array<double, 2> kDash{6.0, 4.0};
  cairo_set_dash(cairo_.get(), kDash.data(), style.dashed ? 2 : 0, 0.0);
  bool pen_down = false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool finite = std::isfinite(x[i]) && std::isfinite(y[i]);
    if (finite && pen_down) cairo_line_to(cairo_.get(), x[i], y[i]);
    if (finite && !pen_down) cairo_move_to(cairo_.get(), x[i], y[i]);
    pen_down = finite;
  }
  cairo_stroke(cairo_.get());
  cairo_set_dash(cairo_.get(), nullptr, 0, 0.0);
}

void Canvas::disc(double x, double y, double diameter, Color color) {
  cairo_new_path(cairo_.get());
  cairo_arc(cairo_.get(), x, y, 0.5 * diameter, 0.0, 2.0 * std::numbers::pi);
  set_color(color, 1.0);
  cairo_fill_preserve(cairo_.get());
  set_color({1, 1, 1}, 0.8);
  cairo_set_line_width(cairo_.get(), 0.8);
  cairo_stroke(cairo_.get());
}

void Canvas::marker(double x, double y, double size, Color color, Marker marker) {
  if (marker == Marker::disc) return disc(x, y, size, color);
  const double reach = 0.5 * size;
  if (marker == Marker::cross) {
    segment(x - reach, y - reach, x + reach, y + reach, color, 2.4, false);
    segment(x - reach, y + reach, x + reach, y - reach, color, 2.4, false);
    return;
  }
  area({x - reach, x, x + reach}, {y, y + reach, y}, {y, y - reach, y}, color, 1.0);
}

void Canvas::area(const std::vector<double>& x, const std::vector<double>& low, const std::vector<double>& high,
                  Color color, double opacity) {
  if (x.empty()) return;
  set_color(color, opacity);
  cairo_new_path(cairo_.get());
  for (std::size_t i = 0; i < x.size(); ++i) cairo_line_to(cairo_.get(), x[i], low[i]);
  for (std::size_t i = x.size(); i > 0; --i) cairo_line_to(cairo_.get(), x[i - 1], high[i - 1]);
  cairo_fill(cairo_.get());
}

void Canvas::polygon(const std::vector<double>& x, const std::vector<double>& y, Color color) {
  set_color(color, 1.0);
  cairo_new_path(cairo_.get());
  for (std::size_t i = 0; i < x.size(); ++i) cairo_line_to(cairo_.get(), x[i], y[i]);
  cairo_close_path(cairo_.get());
  cairo_fill_preserve(cairo_.get());
  cairo_set_line_width(cairo_.get(), 0.6);  // over the seam that smoothing leaves between neighbours
  cairo_stroke(cairo_.get());
}

void Canvas::image(Box box, const Image& image) {
  const std::unique_ptr<cairo_surface_t, Close> raster(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, image.columns, image.rows));
  if (cairo_surface_status(raster.get()) != CAIRO_STATUS_SUCCESS) return;
  unsigned char* data = cairo_image_surface_get_data(raster.get());
  const int stride = cairo_image_surface_get_stride(raster.get());
  const auto byte = [](double part) { return static_cast<std::uint32_t>(std::lround(255.0 * part)); };
  for (int row = 0; row < image.rows; ++row) {  // the raster's first row is the picture's top: the highest y
    auto* pixels = reinterpret_cast<std::uint32_t*>(data + static_cast<std::ptrdiff_t>(row) * stride);
    const float* values =
        &image.values[static_cast<std::size_t>(image.rows - 1 - row) * static_cast<std::size_t>(image.columns)];
    for (int column = 0; column < image.columns; ++column) {
      const Color color = std::isnan(values[column])
                              ? Color{1, 1, 1}
                              : scale_color((values[column] - image.low) / (image.high - image.low));
      pixels[column] = byte(color.red) << 16 | byte(color.green) << 8 | byte(color.blue);
    }
  }
  cairo_surface_mark_dirty(raster.get());
  cairo_save(cairo_.get());
  cairo_translate(cairo_.get(), box.left, box.top);
  cairo_scale(cairo_.get(), box.width() / image.columns, box.height() / image.rows);
  cairo_set_source_surface(cairo_.get(), raster.get(), 0, 0);
  cairo_pattern_set_filter(cairo_get_source(cairo_.get()), CAIRO_FILTER_BILINEAR);
  cairo_pattern_set_extend(cairo_get_source(cairo_.get()), CAIRO_EXTEND_PAD);
  cairo_rectangle(cairo_.get(), 0, 0, image.columns, image.rows);
  cairo_fill(cairo_.get());
  cairo_restore(cairo_.get());
}

void Canvas::text(double x, double y, const std::string& text, TextStyle style) {
  set_font(style.size, style.bold);
  const double width = text_width(text, style.size, style.bold);
  const double shift = style.align == Align::left ? 0.0 : style.align == Align::center ? -0.5 * width : -width;
  cairo_save(cairo_.get());
  cairo_translate(cairo_.get(), x, y);
  if (style.upright) cairo_rotate(cairo_.get(), -0.5 * std::numbers::pi);
  cairo_move_to(cairo_.get(), shift, 0.0);
  if (style.halo) {
    cairo_text_path(cairo_.get(), text.c_str());
    set_color({1, 1, 1}, 0.85);
    cairo_set_line_width(cairo_.get(), 3.5);
    cairo_stroke(cairo_.get());
    cairo_move_to(cairo_.get(), shift, 0.0);
  }
  set_color(style.color, 1.0);
  cairo_show_text(cairo_.get(), text.c_str());
  cairo_restore(cairo_.get());
}

double Canvas::text_width(const std::string& text, double size, bool bold) {
  set_font(size, bold);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo_.get(), text.c_str(), &extents);
  return extents.x_advance;
}

void Canvas::clip(Box box) {
  cairo_save(cairo_.get());
  cairo_rectangle(cairo_.get(), box.left, box.top, box.width(), box.height());
  cairo_clip(cairo_.get());
}

void Canvas::unclip() { cairo_restore(cairo_.get()); }

}  // namespace stillcut::plot
