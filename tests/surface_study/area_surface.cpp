#include "tests/surface_study/area_surface.hpp"

#include "models/surface_refinement.hpp"
#include "models/surface_resampling.hpp"
#include "models/surface_roughness.hpp"
#include "models/surface_texture.hpp"
#include "models/surface_vibration.hpp"
#include "tests/surface_study/published.hpp"
#include "tools/tasks_on_threads.hpp"

namespace stillcut::surface_study {
namespace {

constexpr double kSide = 2e-3, kSpacing = 4e-6;  // m
constexpr std::size_t kPaperPoints = 100;

}  // namespace

AreaSurface area_surface(const Cut& cut, const std::vector<Mode>& modes, double noise, std::uint64_t seed, int jobs) {
  const Tool tool = paper_tool();
  VibratingCutter cutter{cutter_motion(tool, cut), {}};
  if (modes.empty()) {
    cutter.vibration.passes = passes_over(cutter.motion, cut, kSide, kSide);
  } else {
    cutter = vibrating_cutter(
        {.tool = tool, .material = paper_material(), .cut = cut, .modes = modes, .force_noise = noise, .seed = seed},
        kSide, kSide);
  }
  HeightMap fine = uncut_map(kSide, kSide, kSpacing);
  sweep_all(
      SurfaceSweep(cutter.motion, cut, fine.spacing_along, fine.spacing_across), fine, cutter.vibration.passes,
      [jobs](std::size_t count, const std::function<void(std::size_t)>& task) { run_tasks(count, jobs, task, [] {}); });
  AreaSurface surface{resampled(fine, kPaperPoints, kPaperPoints), {}};
  const ProfileRoughness across = mean_roughness(surface.map, ProfileDirection::across).mean,
                         along = mean_roughness(surface.map, ProfileDirection::along).mean;
  const ArealRoughness area = areal_roughness(surface.map);
  // The texture of the fine map: 20 um between points hide the marks of single teeth.
  const double interval = texture_interval(texture_spectrum(fine, ProfileDirection::along)).interval,
               width = mean_element_width(fine, ProfileDirection::along);
  surface.figures = {
      across.ra, across.rq, along.ra, along.rq, area.sa, area.sq, interval, width, cutter.vibration.peak.norm()};
  return surface;
}

}  // namespace stillcut::surface_study
