// surface_study_report: the tables and the picture of docs/surface-case-study.md, made anew.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <thread>

#include "tests/surface_study/area_fit.hpp"
#include "tools/plot_surface.hpp"

namespace {

using namespace stillcut;
using namespace stillcut::surface_study;

// Other seeds than the fit's: what noise does to a cut is not known beforehand.
constexpr std::array<std::uint64_t, 3> kSeeds{101, 102, 103};

double error_percent(double ours_m, double measured_um) { return 100.0 * (1e6 * ours_m / measured_um - 1.0); }

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

double mean_of_others(std::size_t area, double PublishedArea::*figure) {
  double sum = 0.0;
  for (std::size_t other = 0; other < kAreas; ++other)
    if (other != area) sum += kPublished.at(other).*figure / (kAreas - 1);
  return sum;
}

void print_cases(int jobs) {
  const DynamicsMap map = area_map(StudySettings{}.modes, kFittedStiffness);
  std::printf("| case | f_z, mm | still: R_a, R_q | vibrating: R_a, R_q | R_a along | peak of the vibration |\n");
  std::printf("| --- | --- | --- | --- | --- | --- |\n");
  for (int number = 1; number <= 9; ++number) {
    const Cut cut = cut_of_case(number);
    const AreaFigures still = area_surface(cut, {}, 0.0, 1, jobs).figures;
    std::printf("| %d | %.4f | %.3f, %.3f |", number, 1e3 * cut.feed_per_tooth, 1e6 * still.ra, 1e6 * still.rq);
    try {
      const AreaFigures shaken =
          area_surface(cut, modes_at(map, case_middle(number)), StudySettings{}.noise, kSeeds[0], jobs).figures;
      std::printf(" %.2f, %.2f | %.2f | %.0f |\n", 1e6 * shaken.ra, 1e6 * shaken.rq, 1e6 * shaken.ra_along,
                  1e6 * shaken.peak);
    } catch (const std::exception& error) {
      std::printf(" %s | | |\n", error.what());
    }
    std::fflush(stdout);
  }
}

void print_areas(int jobs) {
  std::vector<double> ours_ra, ours_rq, others_ra, others_rq, still_ra, paper_ra, paper_rq;
  std::printf(
      "| area | R_a: measured | the paper | from the other five | their mean | still | R_q: measured | the paper | "
      "from the other five | still |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (std::size_t area = 0; area < kAreas; ++area) {
    const PublishedArea& p = kPublished.at(area);
    const AreaFigures ours = left_out_figures(area, kFittedStiffness, {}, kSeeds, jobs);
    const AreaFigures still = area_surface(cut_of_case(p.of_case), {}, 0.0, 1, jobs).figures;
    const double mean_ra = mean_of_others(area, &PublishedArea::ra_measured),
                 mean_rq = mean_of_others(area, &PublishedArea::rq_measured);
    std::printf(
        "| %c | %.3f | %.3f (%+.1f %%) | %.3f (%+.1f %%) | %+.1f %% | %.3f | %.3f | %.3f (%+.1f %%) | %.3f (%+.1f "
        "%%) | %.3f |\n",
        p.name, p.ra_measured, p.ra_simulated, error_percent(1e-6 * p.ra_simulated, p.ra_measured), 1e6 * ours.ra,
        error_percent(ours.ra, p.ra_measured), error_percent(1e-6 * mean_ra, p.ra_measured), 1e6 * still.ra,
        p.rq_measured, p.rq_simulated, error_percent(1e-6 * p.rq_simulated, p.rq_measured), 1e6 * ours.rq,
        error_percent(ours.rq, p.rq_measured), 1e6 * still.rq);
    std::printf(
        "  %c: along R_a %.3f, S_a %.3f, S_q %.3f um; along the feed the strongest line %.3f (still %.3f) mm, "
        "hill and valley %.3f (%.3f) mm\n",
        p.name, 1e6 * ours.ra_along, 1e6 * ours.sa, 1e6 * ours.sq, 1e3 * ours.interval_along,
        1e3 * still.interval_along, 1e3 * ours.width_along, 1e3 * still.width_along);
    std::fflush(stdout);
    ours_ra.push_back(std::abs(error_percent(ours.ra, p.ra_measured)));
    ours_rq.push_back(std::abs(error_percent(ours.rq, p.rq_measured)));
    others_ra.push_back(std::abs(error_percent(1e-6 * mean_ra, p.ra_measured)));
    others_rq.push_back(std::abs(error_percent(1e-6 * mean_rq, p.rq_measured)));
    still_ra.push_back(std::abs(error_percent(still.ra, p.ra_measured)));
    paper_ra.push_back(std::abs(error_percent(1e-6 * p.ra_simulated, p.ra_measured)));
    paper_rq.push_back(std::abs(error_percent(1e-6 * p.rq_simulated, p.rq_measured)));
  }
  std::printf(
      "median errors, %%: R_a %.1f (mean of the others %.1f, still %.1f, the paper's own fit %.1f); R_q %.1f "
      "(%.1f, paper %.1f)\n",
      median(ours_ra), median(others_ra), median(still_ra), median(paper_ra), median(ours_rq), median(others_rq),
      median(paper_rq));
}

void draw(const std::string& file, int jobs) {
  const Cut cut = cut_of_case(5);
  const AreaSurface shaken =
      area_surface(cut, modes_of(StudySettings{}.modes, kFittedStiffness[1]), StudySettings{}.noise, kSeeds[0], jobs);
  plot::write_figure(height_map_figure(shaken.map, "Case 5, area B, with vibration"), file);
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{
      "The published surfaces of robotic ball-end milling on the fitted map, beside the paper's figures.\n"
      "Example: surface_study_report --table areas"};
  std::string table = "all", picture;
  int jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  app.add_option("--table", table, "cases (Table 2), areas (Table 3), all or none")
      ->capture_default_str()
      ->check(CLI::IsMember({"all", "cases", "areas", "none"}));
  app.add_option("--plot", picture, "Draw area B, to a .svg or .png file");
  app.add_option("--jobs", jobs, "Threads; the result is the same with any number")->check(CLI::Range(1, 256));
  CLI11_PARSE(app, argc, argv);
  if (!picture.empty()) plot::check_picture_name(picture);
  if (table == "all" || table == "cases") print_cases(jobs);
  if (table == "all" || table == "areas") print_areas(jobs);
  if (!picture.empty()) draw(picture, jobs);
} catch (const std::exception& error) {
  std::cerr << "surface_study_report: " << error.what() << '\n';
  return 3;
}
