// case_study_report: the tables of docs/feed-direction-case-study.md, made anew from the shipped maps.
#include <CLI/CLI.hpp>
#include <iostream>
#include <thread>

#include "tests/case_study/report_tables.hpp"
#include "tools/plot.hpp"

int main(int argc, char** argv) try {
  using namespace stillcut::case_study;
  CLI::App app{
      "The published case study of feed directions on the reconstructed maps, beside the paper's figures.\n"
      "Example: case_study_report examples --table patterns"};
  std::string examples, table = "all", picture;
  int jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  app.add_option("EXAMPLES", examples, "Folder that holds hexapod-pocket and hexapod-slender")->required();
  app.add_option("--table", table, "patterns (Table 1), cuts (Table 2), slender (figures 4 to 6), all or none")
      ->capture_default_str()
      ->check(CLI::IsMember({"all", "patterns", "cuts", "slender", "none"}));
  app.add_option("--plot", picture, "Draw the lobes at all points, to a .svg or .png file");
  app.add_option("--jobs", jobs, "Threads; the result is the same with any number")->check(CLI::Range(1, 256));
  CLI11_PARSE(app, argc, argv);
  if (!picture.empty()) stillcut::plot::check_picture_name(picture);
  const bool all = table == "all";
  if (all || table == "patterns") print_patterns(examples + "/hexapod-pocket/cell.toml", jobs, std::cout);
  if (all || table == "cuts") print_cuts(examples + "/hexapod-pocket/cell.toml", jobs, std::cout);
  if (all || table == "slender") print_slender(examples + "/hexapod-slender/cell.toml", jobs, std::cout);
  if (!picture.empty()) draw_lobes(examples + "/hexapod-pocket/cell.toml", jobs, picture);
} catch (const std::exception& error) {
  std::cerr << "case_study_report: " << error.what() << '\n';
  return 3;
}
