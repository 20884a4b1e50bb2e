// surface_study_fit: finds the areas' stiffnesses anew.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>

#include "tests/surface_study/area_fit.hpp"

int main(int argc, char** argv) try {
  using namespace stillcut::surface_study;
  CLI::App app{"Fits a stiffness to each area of Table 3.\nExample: surface_study_fit --jobs 2"};
  StudySettings settings;
  std::vector<double> stiffness{0.5, 0.55, 0.6, 0.66, 0.72, 0.8};
  std::string areas = "ABCDEF";
  int jobs = 1;
  app.add_option("--frequency", settings.modes.frequency_hz, "Hz")->capture_default_str();
  app.add_option("--damping", settings.modes.damping_ratio, "Ratio")->capture_default_str();
  app.add_option("--noise", settings.noise, "Of the force, rms, relative")->capture_default_str();
  app.add_option("--stiffness", stiffness, "To try, N/um")->delimiter(',')->capture_default_str();
  app.add_option("--areas", areas, "Of A to F")->capture_default_str();
  app.add_option("--jobs", jobs, "Threads; the result is the same with any number")->check(CLI::Range(1, 256));
  CLI11_PARSE(app, argc, argv);
  for (double& value : stiffness) value *= 1e6;
  for (std::size_t area = 0; area < kAreas; ++area) {
    if (areas.find(kPublished.at(area).name) == std::string::npos) continue;
    const auto points = fit_points(area, stiffness, settings, jobs, [&](const FitPoint& point, const AreaFigures& f) {
      std::printf("%c %.3f N/um: Ra %.3f Rq %.3f um, along %.3f, Sa %.3f, peak %.0f um, misfit %+.3f\n",
                  kPublished.at(area).name, 1e-6 * point.stiffness, 1e6 * f.ra, 1e6 * f.rq, 1e6 * f.ra_along,
                  1e6 * f.sa, 1e6 * f.peak, point.misfit);
      std::fflush(stdout);
    });
    std::printf("%c fitted %.4f N/um\n", kPublished.at(area).name, 1e-6 * fitted_stiffness(points));
  }
} catch (const std::exception& error) {
  std::cerr << "surface_study_fit: " << error.what() << '\n';
  return 3;
}
