// A sheet to draw on: cairo behind the few verbs that plots need, in px from the top left corner. Used by plot*.cpp
// only.
#pragma once

#include <cairo.h>

#include <filesystem>
#include <memory>
#include <string>

#include "tools/plot.hpp"
#include "tools/plot_scale.hpp"

namespace stillcut::plot {

struct Box {
  double left = 0.0, top = 0.0, right = 0.0, bottom = 0.0;
  [[nodiscard]] double width() const { return right - left; }
  [[nodiscard]] double height() const { return bottom - top; }
};

enum class Align { left, center, right };

class Canvas {
 public:
  // Throws InputError for a name that ends neither in .svg nor in .png, and for a file that cannot be written.
  Canvas(const std::filesystem::path& file, int width, int height);

  // Into `bytes`, which must outlive the canvas, instead of a file.
  Canvas(std::string& bytes, Format format, int width, int height);

  // Writes the file. Throws InputError when that fails.
  void finish();

  void rectangle(Box box, Color color, double opacity = 1.0);
  void outline(Box box, Color color, double width);
  void segment(double x0, double y0, double x1, double y1, Color color, double width, bool dashed,
               double opacity = 1.0);
  void disc(double x, double y, double diameter, Color color);
  void marker(double x, double y, double size, Color color, Marker marker);
  void image(Box box, const Image& image);
  // Filled; polygons side by side meet without a seam.
  void polygon(const std::vector<double>& x, const std::vector<double>& y, Color color);

  // A line through points that may be NaN: there the pen lifts.
  void polyline(const std::vector<double>& x, const std::vector<double>& y, const Line& style);

  // The space between two lines over the same x.
  void area(const std::vector<double>& x, const std::vector<double>& low, const std::vector<double>& high, Color color,
            double opacity);

  struct TextStyle {
    double size = 12.0;
    Color color = kInk;
    Align align = Align::left;
    bool bold = false, upright = false;  // upright: turned to read from bottom to top
    bool halo = false;                   // on a white rim, to stay readable over data
  };
  void text(double x, double y, const std::string& text, TextStyle style);  // y: the baseline
  [[nodiscard]] double text_width(const std::string& text, double size, bool bold = false);

  // Whatever is drawn until unclip() stays inside the box.
  void clip(Box box);
  void unclip();

 private:
  struct Close {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
    void operator()(cairo_t* context) const { cairo_destroy(context); }
  };
  void begin(int width, int height);
  void set_color(Color color, double opacity);
  void set_font(double size, bool bold);

  std::filesystem::path file_;
  bool png_;
  std::string* bytes_ = nullptr;  // instead of the file
  std::unique_ptr<cairo_surface_t, Close> surface_;
  std::unique_ptr<cairo_t, Close> cairo_;
};

}  // namespace stillcut::plot
