// surface_study_fit: finds the areas' stiffnesses anew, and writes the shipped map.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>

#include "drivers/files/dynamics_map_file.hpp"
#include "tests/surface_study/area_fit.hpp"

int main(int argc, char** argv) try {
  using namespace stillcut::surface_study;
  CLI::App app{"Fits a stiffness to each area of Table 3.\nExample: surface_study_fit --jobs 2"};
  StudySettings settings;
  std::vector<double> stiffness{0.85, 1.0, 1.15, 1.3, 1.5, 1.75};
  std::vector<std::uint64_t> seeds{1, 2, 3};
  std::string map;
  int jobs = 1;
  app.add_option("--frequency", settings.modes.frequency_hz, "Hz")->capture_default_str();
  app.add_option("--damping", settings.modes.damping_ratio, "Ratio")->capture_default_str();
  app.add_option("--noise", settings.noise, "Of the force, rms, relative")->capture_default_str();
  app.add_option("--stiffness", stiffness, "To try, N/um, rising")->delimiter(',')->capture_default_str();
  app.add_option("--seeds", seeds, "Of the noise")->delimiter(',')->capture_default_str();
  app.add_option("--map", map, "Write the stored map, not a fitted one, to this folder, and nothing else");
  app.add_option("--jobs", jobs, "Threads; the result is the same with any number")->check(CLI::Range(1, 256));
  CLI11_PARSE(app, argc, argv);
  if (!map.empty()) {
    stillcut::write_dynamics_map(map, area_map(settings.modes, kFittedStiffness));
    return 0;
  }
  for (const int of_case : {5, 7}) {
    std::vector<FitPoint> points;
    for (const double value : stiffness) {
      const FitPoint point{
          1e6 * value, expected_figures(of_case, modes_of(settings.modes, 1e6 * value), settings.noise, seeds, jobs)};
      std::printf("case %d, %.3f N/um: Ra %.3f Rq %.3f um, along %.3f, Sa %.3f, peak %.0f um\n", of_case, value,
                  1e6 * point.figures.ra, 1e6 * point.figures.rq, 1e6 * point.figures.ra_along, 1e6 * point.figures.sa,
                  1e6 * point.figures.peak);
      std::fflush(stdout);
      points.push_back(point);
    }
    for (const PublishedArea& area : kPublished)
      if (area.of_case == of_case)
        std::printf("%c fitted %.4f N/um\n", area.name, 1e-6 * fitted_stiffness(points, area));
  }
} catch (const std::exception& error) {
  std::cerr << "surface_study_fit: " << error.what() << '\n';
  return 3;
}
