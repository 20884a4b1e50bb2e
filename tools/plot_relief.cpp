#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "models/surface_form.hpp"
#include "models/surface_roughness.hpp"
#include "tools/plot_canvas.hpp"
#include "tools/plot_legend.hpp"
#include "tools/plot_scale.hpp"
#include "tools/plot_surface.hpp"

namespace stillcut {
namespace {

constexpr int kSheetWidth = 1200, kSheetHeight = 900;
constexpr double kMargin = 60.0, kTitleRoom = 100.0;
constexpr std::size_t kMostLines = 100;               // of the mesh in a direction: what an .svg can carry
constexpr double kHeightShare = 0.12;                 // of the longer side, which the relief is enlarged to
constexpr double kAzimuth = -0.6, kElevation = 0.62;  // rad: from the lower left, the feed running to the right

struct Point3 {
  double x, y, z;
};

// The longer side is 1 long, the middle is the origin.
struct Mesh {
  std::size_t columns = 0, rows = 0;
  std::vector<Point3> points;  // z NaN: not known
  [[nodiscard]] const Point3& at(std::size_t c, std::size_t r) const { return points[r * columns + c]; }
};

struct Enlargement {
  double flat = 1.0, upward = 1.0;  // mesh units a metre
};

// Of the known points of a block; NaN without any.
double mean_height(const HeightMap& map, std::size_t i, std::size_t j, std::size_t wide, std::size_t tall) {
  double sum = 0.0;
  std::size_t known = 0;
  for (std::size_t q = j; q < std::min(j + tall, map.across); ++q)
    for (std::size_t p = i; p < std::min(i + wide, map.along); ++p) {
      if (std::isnan(map.at(p, q))) continue;
      sum += map.at(p, q);
      ++known;
    }
  return sum / static_cast<double>(known);
}

Mesh mesh_of(const HeightMap& map, const Enlargement& by) {
  const auto steps = [](std::size_t points) { return (points + kMostLines - 1) / kMostLines; };
  const std::size_t step_i = steps(map.along), step_j = steps(map.across);
  const double middle_x = 0.5 * static_cast<double>(map.along - 1) * map.spacing_along;
  const double middle_y = 0.5 * static_cast<double>(map.across - 1) * map.spacing_across;
  Mesh mesh;
  for (std::size_t j = 0; j < map.across; j += step_j, ++mesh.rows)
    for (std::size_t i = 0; i < map.along; i += step_i)
      mesh.points.push_back({by.flat * (static_cast<double>(i) * map.spacing_along - middle_x),
                             by.flat * (static_cast<double>(j) * map.spacing_across - middle_y),
                             by.upward * mean_height(map, i, j, step_i, step_j)});
  mesh.columns = mesh.points.size() / mesh.rows;
  return mesh;
}

// Parallel projection: right and up on the sheet, and how far away.
Point3 seen(const Point3& p) {
  const double right = p.x * std::cos(kAzimuth) - p.y * std::sin(kAzimuth);
  const double away = p.x * std::sin(kAzimuth) + p.y * std::cos(kAzimuth);
  return {right, away * std::sin(kElevation) + p.z * std::cos(kElevation), away};
}

// Lambert's law, light from the left over the eye, with some from everywhere.
double brightness(const Point3& a, const Point3& b, const Point3& c, const Point3& d) {
  constexpr Point3 kLight{-0.55, -0.35, 0.758};
  const Point3 u{c.x - a.x, c.y - a.y, c.z - a.z}, v{d.x - b.x, d.y - b.y, d.z - b.z};
  const Point3 n{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
  const double length = std::hypot(n.x, n.y, n.z);
  const double cosine = (n.x * kLight.x + n.y * kLight.y + n.z * kLight.z) / length;
  return 0.45 + 0.7 * std::max(0.0, cosine);
}

// The sheet's place of what `seen` gives.
struct Sheet {
  double scale = 1.0, left = 0.0, bottom = 0.0;
  [[nodiscard]] double x(const Point3& p) const { return left + scale * p.x; }
  [[nodiscard]] double y(const Point3& p) const { return bottom - scale * p.y; }
};

Sheet sheet_for(const std::vector<Point3>& points) {
  double left = 1e9, right = -1e9, low = 1e9, high = -1e9;
  for (const Point3& point : points) {
    if (std::isnan(point.z)) continue;
    const Point3 p = seen(point);
    left = std::min(left, p.x), right = std::max(right, p.x), low = std::min(low, p.y), high = std::max(high, p.y);
  }
  const double wide = kSheetWidth - 2.0 * kMargin, tall = kSheetHeight - kTitleRoom - 2.0 * kMargin;
  const double scale = std::min(wide / (right - left), tall / (high - low));
  return {scale, 0.5 * kSheetWidth - 0.5 * scale * (left + right),
          kTitleRoom + kMargin + 0.5 * tall + 0.5 * scale * (low + high)};
}

void draw_surface(plot::Canvas& canvas, const Mesh& mesh, const Sheet& sheet, double lowest, double highest) {
  // Away from the eye first: the feed's end at this azimuth comes nearer, the rows go away.
  for (std::size_t r = mesh.rows - 1; r-- > 0;) {
    for (std::size_t c = 0; c + 1 < mesh.columns; ++c) {
      const std::array<Point3, 4> corners{mesh.at(c, r), mesh.at(c + 1, r), mesh.at(c + 1, r + 1), mesh.at(c, r + 1)};
      const double height = 0.25 * (corners[0].z + corners[1].z + corners[2].z + corners[3].z);
      if (std::isnan(height)) continue;
      const double light = brightness(corners[0], corners[1], corners[2], corners[3]);
      plot::Color color = plot::scale_color((height - lowest) / (highest - lowest));
      for (double* part : {&color.red, &color.green, &color.blue}) *part = std::min(1.0, *part * light);
      std::vector<double> x, y;
      for (const Point3& corner : corners) {
        x.push_back(sheet.x(seen(corner)));
        y.push_back(sheet.y(seen(corner)));
      }
      canvas.polygon(x, y, color);
    }
  }
}

// The two sides that face the eye, down to the ground, and how long they are.
void draw_sides(plot::Canvas& canvas, const HeightMap& map, const Mesh& mesh, const Sheet& sheet, double ground) {
  constexpr plot::Color kFront{0.80, 0.80, 0.83}, kSide{0.68, 0.68, 0.72};
  const auto dropped = [&](Point3 p) { return seen({p.x, p.y, ground}); };
  const auto wall = [&](const Point3& a, const Point3& b, plot::Color color) {
    if (std::isnan(a.z) || std::isnan(b.z)) return;
    const std::array<Point3, 4> corners{seen(a), seen(b), dropped(b), dropped(a)};
    std::vector<double> x, y;
    for (const Point3& corner : corners) x.push_back(sheet.x(corner)), y.push_back(sheet.y(corner));
    canvas.polygon(x, y, color);
  };
  for (std::size_t c = 0; c + 1 < mesh.columns; ++c) wall(mesh.at(c, 0), mesh.at(c + 1, 0), kFront);
  for (std::size_t r = 0; r + 1 < mesh.rows; ++r)
    wall(mesh.at(mesh.columns - 1, r), mesh.at(mesh.columns - 1, r + 1), kSide);
  const auto label = [&](const Point3& from, const Point3& to, const std::string& what, double length) {
    const Point3 a = dropped(from), b = dropped(to);
    char text[64];
    std::snprintf(text, sizeof text, "%s, %.3g mm", what.c_str(), 1e3 * length);
    const bool left = sheet.y(b) > sheet.y(a);
    canvas.text(0.5 * (sheet.x(a) + sheet.x(b)) + (left ? -12.0 : 12.0), 0.5 * (sheet.y(a) + sheet.y(b)) + 26.0, text,
                {.size = plot::kPanelText, .align = left ? plot::Align::right : plot::Align::left});
  };
  const Point3 &start = mesh.at(0, 0), &corner = mesh.at(mesh.columns - 1, 0);
  label(start, corner, "along the feed", static_cast<double>(map.along - 1) * map.spacing_along);
  label(corner, mesh.at(mesh.columns - 1, mesh.rows - 1), "across the feed",
        static_cast<double>(map.across - 1) * map.spacing_across);
}

}  // namespace

void write_relief(const HeightMap& map, const std::string& title, const std::filesystem::path& file) {
  HeightMap levelled = map;
  remove_form(levelled, SurfaceForm::linear);
  const HeightStatistics heights = height_statistics(levelled.heights);
  const double longer = std::max(static_cast<double>(map.along - 1) * map.spacing_along,
                                 static_cast<double>(map.across - 1) * map.spacing_across);
  const double range = heights.highest - heights.lowest;
  const Enlargement by{1.0 / longer, kHeightShare / std::max(range, 1e-9 * longer)};
  const Mesh mesh = mesh_of(levelled, by);
  const double lowest = by.upward * heights.lowest, highest = by.upward * heights.highest;
  const double ground = lowest - 0.04;
  std::vector<Point3> outline = mesh.points;
  for (const std::size_t corner : {std::size_t{0}, mesh.columns - 1, mesh.points.size() - 1}) {
    outline.push_back(mesh.points[corner]);
    outline.back().z = ground;
  }
  const Sheet sheet = sheet_for(outline);

  plot::Canvas canvas(file, kSheetWidth, kSheetHeight);
  canvas.text(kMargin, 44.0, title, {.size = 19.0, .bold = true});
  char text[160];
  std::snprintf(text, sizeof text, "Heights %.3g times enlarged, from %.3g to %.3g µm about the least-squares plane",
                by.upward / by.flat, 1e6 * heights.lowest, 1e6 * heights.highest);
  canvas.text(kMargin, 70.0, text, {.size = plot::kPanelText, .color = plot::kGrey});
  draw_surface(canvas, mesh, sheet, lowest, std::max(highest, lowest + 1e-9));
  draw_sides(canvas, levelled, mesh, sheet, ground);
  canvas.finish();
}

}  // namespace stillcut
