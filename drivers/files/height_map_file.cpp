#include "drivers/files/height_map_file.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <stdexcept>

#include "drivers/files/input_error.hpp"
#include "drivers/files/sdf_file.hpp"
#include "drivers/files/text_file.hpp"
#include "models/surface_profiles.hpp"

namespace stillcut {
namespace {

using Vertex = std::array<float, 3>;  // mm

[[noreturn]] void refuse_ending(const std::filesystem::path& file, const char* endings) {
  throw InputError(file.string(), 0, std::string("a height map's name must end in ") + endings);
}

void put(std::string& bytes, std::uint32_t value) {  // the lowest byte first, on every processor
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift & 0xFF);
}

Vertex normal_of(const Vertex& a, const Vertex& b, const Vertex& c) {
  const double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
  const double vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
  const double nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
  const double length = std::sqrt(nx * nx + ny * ny + nz * nz);
  return {static_cast<float>(nx / length), static_cast<float>(ny / length), static_cast<float>(nz / length)};
}

// Corners counted against the clock as seen from above: the normal points out of the material.
using Triangle = std::array<std::array<std::size_t, 2>, 3>;
std::array<Triangle, 2> triangles_of(std::size_t i, std::size_t j) {
  return {{{{{i, j}, {i + 1, j}, {i + 1, j + 1}}}, {{{i, j}, {i + 1, j + 1}, {i, j + 1}}}}};
}

bool is_known(const HeightMap& map, const Triangle& triangle) {
  for (const auto& [i, j] : triangle)
    if (std::isnan(map.at(i, j))) return false;
  return true;
}

template <class Visit>
void each_known_triangle(const HeightMap& map, Visit visit) {
  for (std::size_t j = 0; j + 1 < map.across; ++j)
    for (std::size_t i = 0; i + 1 < map.along; ++i)
      for (const Triangle& triangle : triangles_of(i, j))
        if (is_known(map, triangle)) visit(triangle);
}

}  // namespace

HeightMap read_height_map(const std::filesystem::path& file) {
  if (file.extension() == ".csv") return parse_height_map_csv(read_text_file(file), file.string());
  if (file.extension() == ".sdf") return parse_sdf(read_text_file(file), file.string());
  refuse_ending(file, ".csv or .sdf");
}

void write_height_map(const HeightMap& map, const std::filesystem::path& file) {
  void (*write)(std::ostream&, const HeightMap&) = nullptr;
  if (file.extension() == ".csv") write = write_height_map_csv;
  if (file.extension() == ".sdf") write = write_sdf;
  if (file.extension() == ".stl") write = write_height_map_stl;
  if (write == nullptr) refuse_ending(file, ".csv, .sdf or .stl");
  std::ofstream out(file, std::ios::binary);
  if (!out) throw InputError(file.string(), 0, "cannot be written; check folder and permissions");
  try {
    write(out, map);
  } catch (const std::invalid_argument& error) {
    throw InputError(file.string(), 0, error.what());
  }
  if (!out.flush()) throw InputError(file.string(), 0, "cannot be written to the end; is the disk full?");
}

void write_height_map_stl(std::ostream& out, const HeightMap& map) {
  require_sound_map(map);
  if (map.along < 2 || map.across < 2) throw std::invalid_argument("a surface needs two points in each direction");
  std::size_t count = 0;
  each_known_triangle(map, [&](const Triangle&) { ++count; });
  if (count > std::numeric_limits<std::uint32_t>::max())
    throw std::invalid_argument("an STL file has no room for so many triangles; write fewer points");
  std::string bytes = "Stillcut height map, mm: x along the feed, y across it";
  bytes.resize(80, ' ');  // must not begin with "solid", which is an ASCII file
  put(bytes, static_cast<std::uint32_t>(count));
  const auto vertex = [&](const std::array<std::size_t, 2>& corner) {
    const auto mm = [](double m) { return static_cast<float>(1e3 * m); };
    return Vertex{mm(static_cast<double>(corner[0]) * map.spacing_along),
                  mm(static_cast<double>(corner[1]) * map.spacing_across), mm(map.at(corner[0], corner[1]))};
  };
  each_known_triangle(map, [&](const Triangle& triangle) {
    const std::array<Vertex, 3> corners{vertex(triangle[0]), vertex(triangle[1]), vertex(triangle[2])};
    for (const float part : normal_of(corners[0], corners[1], corners[2]))
      put(bytes, std::bit_cast<std::uint32_t>(part));
    for (const Vertex& corner : corners)
      for (const float part : corner) put(bytes, std::bit_cast<std::uint32_t>(part));
    bytes.append(2, '\0');
    out << bytes;
    bytes.clear();
  });
  out << bytes;  // of a map without a triangle
}

}  // namespace stillcut
