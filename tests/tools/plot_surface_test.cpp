// Pictures of surfaces: that they show what is there, to scale, and nothing where nothing is known.
#include "tools/plot_surface.hpp"

#include <cairo.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <numbers>
#include <string>

#include "drivers/files/input_error.hpp"
#include "dsp/numbers.hpp"
#include "tests/drivers/files/temp_folder.hpp"
#include "tests/models/surface_maps.hpp"

namespace stillcut {
namespace {

// Steps across the feed 0.5 mm apart, feed marks 0.2 mm apart, tilted; 2 mm along, 1 mm across.
HeightMap milled_map() {
  return surface_of(200, 125, 10e-6, 8e-6, [](double x, double y) {
    return scallop(y, 0.25e-3, 6e-6) + 1e-6 * std::cos(2.0 * std::numbers::pi * x / 0.2e-3) + 2e-3 * x - 1e-3 * y;
  });
}

// A .png, 1.5 of its px for one of the figure.
class Picture {
 public:
  explicit Picture(const std::filesystem::path& file)
      : surface_{cairo_image_surface_create_from_png(file.c_str()), cairo_surface_destroy} {}
  [[nodiscard]] int width() const { return cairo_image_surface_get_width(surface_.get()); }
  [[nodiscard]] int height() const { return cairo_image_surface_get_height(surface_.get()); }
  [[nodiscard]] unsigned color(int x, int y) const {
    const unsigned char* row = cairo_image_surface_get_data(surface_.get()) +
                               static_cast<std::ptrdiff_t>(y) * cairo_image_surface_get_stride(surface_.get());
    return row[4 * x] | row[4 * x + 1] << 8U | row[4 * x + 2] << 16U;
  }
  [[nodiscard]] bool white(int x, int y) const { return color(x, y) == 0xFFFFFF; }

 private:
  std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface_;
};

TEST(HeightMapFigure, ShowsMicrometresLessThePlaneAndLeavesHolesOpen) {
  HeightMap map = milled_map();
  map.at(7, 3) = kNaN;
  const plot::Figure figure = height_map_figure(map, "a surface");
  const plot::Image& image = figure.panels.at(0).image.value();
  EXPECT_EQ(image.columns, 200);
  EXPECT_EQ(image.rows, 125);
  EXPECT_NEAR(image.x_end - image.x_begin, 2.0, 1e-9);  // mm
  EXPECT_NEAR(image.y_end - image.y_begin, 1.0, 1e-9);
  EXPECT_NEAR(image.high - image.low, 8.0, 0.3);  // µm; the tilt alone is 4
  EXPECT_TRUE(std::isnan(image.values[3 * 200 + 7]));
  EXPECT_GT(image.values[0], image.high - 1.0);  // a cusp and a feed mark
}

TEST(HeightMapFigure, OfManyPointsIsThinned) {
  const plot::Image image = height_map_figure(noise_map(2500, 30, 1e-6, 1), "").panels.at(0).image.value();
  EXPECT_EQ(image.columns, 834);
  EXPECT_EQ(image.values.size(), 834U * 30U);
  EXPECT_NEAR(image.x_end - image.x_begin, 2500 * 4e-3, 0.02);
}

// Fails where the panel fills the figure whatever its shape, and where a hole is coloured as the lowest place.
TEST(HeightMapFigure, IsDrawnToScaleWithWhiteHoles) {
  const TempFolder folder;
  HeightMap map = surface_of(100, 50, 10e-6, 10e-6, [](double x, double y) { return 1e-6 * std::sin(1e4 * (x + y)); });
  for (std::size_t j = 20; j < 30; ++j)
    for (std::size_t i = 40; i < 60; ++i) map.at(i, j) = kNaN;
  plot::Figure figure = height_map_figure(map, "");
  figure.height = 900;  // more than it needs
  plot::write_figure(figure, folder.path() / "map.png");
  const Picture picture(folder.path() / "map.png");
  const int left = static_cast<int>(1.5 * 92) + 2;
  int top = 130;  // below the titles
  while (top < picture.height() && picture.white(left + 40, top)) ++top;
  int right = left, bottom = top;
  while (right + 1 < picture.width() && !picture.white(right + 1, top + 10)) ++right;
  while (bottom + 1 < picture.height() && !picture.white(left + 40, bottom + 1)) ++bottom;
  EXPECT_NEAR(static_cast<double>(right - left) / (bottom - top), 2.0, 0.04);
  EXPECT_GT(right - left, picture.width() / 2);
  EXPECT_TRUE(picture.white((left + right) / 2, (top + bottom) / 2));
}

TEST(SurfaceProfilesFigure, ShowsBothProfilesThroughTheMiddle) {
  const plot::Figure figure = surface_profiles_figure(milled_map(), "");
  ASSERT_EQ(figure.panels.size(), 2U);
  const plot::Line &along = figure.panels[0].lines.at(0), &across = figure.panels[1].lines.at(0);
  EXPECT_EQ(along.x.size(), 200U);
  EXPECT_NEAR(along.x.back(), 1.99, 1e-9);
  EXPECT_EQ(across.x.size(), 125U);
  EXPECT_NEAR(*std::max_element(along.y.begin(), along.y.end()) - *std::min_element(along.y.begin(), along.y.end()),
              2.0, 0.1);
  EXPECT_NE(figure.panels[0].title.find("R_a 0.63"), std::string::npos) << figure.panels[0].title;  // 2/π µm
}

TEST(SurfaceSpectrumFigure, MarksWhatRepeats) {
  const plot::Figure figure = surface_spectrum_figure(milled_map(), "");
  ASSERT_EQ(figure.panels.size(), 2U);
  EXPECT_NEAR(figure.panels[0].events.at(0).x, 5.0, 0.02);  // a mm
  EXPECT_NEAR(figure.panels[1].events.at(0).x, 4.0, 0.05);
  EXPECT_EQ(figure.panels[0].events[0].text.substr(0, 12), "every 0.2 mm");
  const plot::Line& line = figure.panels[0].lines.at(0);
  EXPECT_NEAR(line.x[static_cast<std::size_t>(std::max_element(line.y.begin(), line.y.end()) - line.y.begin())], 5.0,
              0.1);
  EXPECT_TRUE(surface_spectrum_figure(surface_of(20, 20, 1e-5, 1e-5, [](double, double) { return 0.0; }), "")
                  .panels[0]
                  .events.empty());
}

std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Relief, ShowsTheSurfaceAndItsHole) {
  const TempFolder folder;
  HeightMap map = milled_map();
  write_relief(map, "whole", folder.path() / "whole.png");
  write_relief(map, "whole", folder.path() / "again.png");
  EXPECT_TRUE(contents(folder.path() / "whole.png") == contents(folder.path() / "again.png"));
  for (std::size_t j = 40; j < 80; ++j)
    for (std::size_t i = 60; i < 140; ++i) map.at(i, j) = kNaN;
  write_relief(map, "hole", folder.path() / "hole.png");
  const auto colored = [&](const char* name) {
    const Picture picture(folder.path() / name);
    int count = 0;
    for (int y = 150; y < picture.height(); ++y)
      for (int x = 0; x < picture.width(); ++x) count += picture.white(x, y) ? 0 : 1;
    return static_cast<double>(count) / (picture.width() * picture.height());
  };
  EXPECT_GT(colored("whole.png"), 0.3);
  EXPECT_LT(colored("hole.png"), 0.97 * colored("whole.png"));
  write_relief(milled_map(), "", folder.path() / "relief.svg");
  EXPECT_LT(std::filesystem::file_size(folder.path() / "relief.svg"), 5'000'000U);
}

TEST(Relief, OfAFlatSurfaceAndOfAFewPointsIsAPicture) {
  const TempFolder folder;
  write_relief(surface_of(30, 20, 1e-5, 1e-5, [](double, double) { return 2e-6; }), "", folder.path() / "flat.png");
  write_relief(noise_map(3, 2, 1e-6, 1), "", folder.path() / "few.png");
  plot::write_figure(height_map_figure(noise_map(3, 2, 1e-6, 1), ""), folder.path() / "map.png");
  EXPECT_GT(std::filesystem::file_size(folder.path() / "flat.png"), 1000U);
  EXPECT_GT(std::filesystem::file_size(folder.path() / "few.png"), 1000U);
}

TEST(SurfacePictures, AreRefusedWhereNothingIsKnownOrWritten) {
  EXPECT_THROW(write_relief(milled_map(), "", "/no/such/folder/a.png"), InputError);
  EXPECT_THROW(write_relief(milled_map(), "", "a.pdf"), InputError);
  const HeightMap unknown = surface_of(30, 20, 1e-5, 1e-5, [](double, double) { return kNaN; });
  EXPECT_THROW((void)height_map_figure(unknown, ""), std::invalid_argument);
  EXPECT_THROW((void)surface_profiles_figure(unknown, ""), std::invalid_argument);
  EXPECT_THROW((void)surface_spectrum_figure(unknown, ""), std::invalid_argument);
  EXPECT_THROW(write_relief(unknown, "", "a.png"), std::invalid_argument);
}

}  // namespace
}  // namespace stillcut
