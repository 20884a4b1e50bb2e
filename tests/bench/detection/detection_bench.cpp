// The open benchmark of chatter detection: simulated cuts from a fixed list of seeds, the monitor and simple detectors
// on the same samples, one table. docs/detection-benchmark.md.
#include <CLI/CLI.hpp>
#include <atomic>
#include <exception>
#include <fstream>
#include <iostream>
#include <mutex>
#include <thread>

#include "tests/bench/detection/score.hpp"
#include "tools/progress.hpp"

namespace {

using namespace stillcut;
using namespace stillcut::detection;

constexpr int kFirstSound = 100'000;

struct Run {
  SeedList list = SeedList::tuning;
  int mixed = 0, sound = 0;  // cuts
  int jobs = 1;
};

std::vector<CutOutcome> run_cuts(const Run& run) {
  const int cuts = run.mixed + run.sound;
  std::vector<CutOutcome> outcomes(static_cast<std::size_t>(cuts));
  std::atomic<int> next{0}, done{0};
  std::mutex one_at_a_time;
  std::exception_ptr failure;
  Progress progress{"cuts"};
  const auto mill_one = [&](int i) {
    const CutKind kind = i < run.mixed ? mixed_kind(i) : sound_kind(i - run.mixed);
    // Sound cuts beyond the mix have seeds of their own, whatever the mix.
    const int index = i < run.mixed ? i : kFirstSound + i - run.mixed;
    outcomes[static_cast<std::size_t>(i)] = judge(index, draw_cut(run.list, index, kind));
    const std::lock_guard lock{one_at_a_time};
    progress.update(static_cast<double>(++done) / cuts);
  };
  const auto work = [&] {
    try {
      for (int i = next++; i < cuts; i = next++) mill_one(i);
    } catch (...) {
      const std::lock_guard lock{one_at_a_time};
      failure = std::current_exception();
      next = cuts;
    }
  };
  std::vector<std::jthread> threads;
  for (int j = 0; j < run.jobs; ++j) threads.emplace_back(work);
  threads.clear();
  if (failure) std::rethrow_exception(failure);
  return outcomes;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{
      "Chatter detection on simulated cuts: the monitor beside simple detectors.\n"
      "Example: bench_detection --seeds judging --cuts 600 --plot detection.svg"};
  std::string seeds = "tuning", csv, picture;
  double sound_hours = 0.0;
  int cuts = 600, jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  app.add_option("--seeds", seeds, "Which list of seeds")->check(CLI::IsMember({"tuning", "judging"}));
  app.add_option("--cuts", cuts, "How many cuts of the list")->check(CLI::PositiveNumber);
  app.add_option("--sound-hours", sound_hours, "Hours of further sound cuts, for false alarms")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--jobs", jobs, "Threads")->check(CLI::PositiveNumber);
  app.add_option("--csv", csv, "Writes what every detector made of every cut");
  app.add_option("--plot", picture, "Draws the delays, .svg or .png");
  CLI11_PARSE(app, argc, argv);
  if (!picture.empty()) plot::check_picture_name(picture);
  Run run;
  run.list = seeds == "judging" ? SeedList::judging : SeedList::tuning;
  run.mixed = cuts;
  run.sound = static_cast<int>(sound_hours * 3600.0 / kSoundCut);
  run.jobs = jobs;
  const std::vector<CutOutcome> outcomes = run_cuts(run);
  int left_out = 0, visible = 0;
  for (const CutOutcome& cut : outcomes) {
    left_out += cut.not_stable ? 1 : 0;
    visible += !cut.not_stable && std::isfinite(cut.visible_s) ? 1 : 0;
  }
  const std::string title = std::to_string(outcomes.size()) + " simulated cuts, " + seeds + " seeds";
  std::cout << title << ": chatter becomes visible in " << visible << "; " << left_out
            << " left out, they chatter where theory calls them sound\n\n";
  print_table(std::cout, score(outcomes));
  if (!csv.empty()) {
    std::ofstream file{csv};
    print_csv(file, outcomes);
    if (!file) throw std::runtime_error(csv + ": cannot be written");
  }
  if (!picture.empty()) plot::write_figure(delay_figure(outcomes, title), picture);
  return 0;
} catch (const std::exception& problem) {
  std::cerr << "bench_detection: " << problem.what() << '\n';
  return 3;
}
