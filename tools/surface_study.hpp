// What `stillcut surface` answers: the surface that a cell's cut leaves, with the tool's vibration and without, and how
// rough it is; a measured one beside it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/files/cell.hpp"
#include "models/height_map.hpp"
#include "models/surface_refinement.hpp"
#include "models/surface_roughness.hpp"
#include "models/surface_texture.hpp"

namespace stillcut {

struct GridSize {
  std::size_t along = 0, across = 0;
};

struct SurfaceQuestion {
  double along = 2e-3, across = 2e-3;  // m, of the surface
  std::optional<GridSize> cells;       // empty: as fine as lets the roughness stand still
  bool allow_coarse = false;
  bool vibration = true;
  std::string posture;  // as after --posture; empty: the cell's
  ProfileDirection profile = ProfileDirection::across;
  RoughnessSettings roughness;
  std::optional<GridSize> points;  // that the map is resampled to
  double force_noise = 0.02;
  std::uint64_t seed = 1;
  int threads = 1;
  // A tool path to sweep, in workpiece axes, instead of the cell's passes; without vibration.
  std::filesystem::path path;                       // empty: none
  std::optional<std::pair<double, double>> corner;  // m, workpiece X and Y where its surface begins; empty: its middle
  bool less_envelope = false;  // what the ball's body alone would leave along it is taken off before the form
};

struct SurfaceFigures {
  MeanRoughness profiles;  // of the direction asked for
  ArealRoughness area;
  double interval_along = 0.0, interval_across = 0.0;  // m, of the texture; NaN: nothing repeats
};

struct StudiedVibration {
  std::string posture;
  std::size_t modes = 0;
  Eigen::Vector3d mean, rms, peak;  // m, workpiece axes; rms about the mean
};

struct StudiedSurface {
  SurfaceQuestion question;
  Tool tool;
  Cut cut;
  std::string material;
  GridSize cells;          // that were swept
  GridSize needed;         // the coarsest that shows feed marks and scallops
  double error = 0.0;      // of R_a by the grid, estimated, relative; infinite: no other grid to compare with
  HeightMap map;           // resampled where that was asked for
  SurfaceFigures figures;  // of the map
  std::optional<SurfaceFigures> without_vibration;
  std::optional<StudiedVibration> vibration;
  std::vector<std::string> warnings;
};

struct MeasuredSurface {
  std::string file;
  HeightMap map;
  SurfaceFigures figures;
};

// What is being done and how much of it, 0..1; called from the calling thread.
using SurfaceWatch = std::function<void(const char* task, double share)>;

// Throws InputError, naming the cell file and the key: sections that are missing, a grid too coarse for the feed and
// step-over (unless that is allowed), contact that the model does not have. The result does not depend on the number of
// threads.
[[nodiscard]] StudiedSurface study_surface(const Cell& cell, const SurfaceQuestion& question,
                                           const SurfaceWatch& watch);

// Threads for a sweep that is watched.
[[nodiscard]] Workers watched_workers(int threads, const SurfaceWatch& watch);

// Throws std::invalid_argument where too little is known, and for a cutoff that the filter refuses.
[[nodiscard]] SurfaceFigures surface_figures(const HeightMap& map, ProfileDirection profile,
                                             const RoughnessSettings& settings);

// A map from a .csv or .sdf file, its figures found as those of the question's surface. Throws InputError.
[[nodiscard]] MeasuredSurface measured_surface(const std::filesystem::path& file, const SurfaceQuestion& question);

}  // namespace stillcut
