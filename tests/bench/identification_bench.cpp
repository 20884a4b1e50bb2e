// From measured responses to the dynamics map, with everything: files read, modes identified on all cores, tracked,
// left out and written. 49 postures of 8192 lines; the first argument is how many axes were tapped, three responses
// each.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <thread>

#include "drivers/files/frf_file.hpp"
#include "models/machining.hpp"
#include "tests/models/moving_modes.hpp"
#include "tests/models/tapped_structure.hpp"
#include "tools/fit_output.hpp"

namespace {

using namespace stillcut;

constexpr int kAlong = 7;  // postures: 7 x 7
constexpr std::size_t kLines = 8192;
constexpr double kHighest_hz = 1024.0, kNoise = 0.002;

class Measurements {
 public:
  explicit Measurements(std::size_t tapped_axes) {
    std::string name = (std::filesystem::temp_directory_path() / "stillcut-bench-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make " + name);
    folder_ = name;
    std::mt19937_64 random(7);
    std::normal_distribution<> normal;
    const auto modes = test::moving_modes(6, 0.8, 0.1, random);
    std::ofstream postures(folder_ / "postures.csv");
    postures << "posture,x_mm,y_mm,z_mm\n";
    int number = 0;
    for (const Eigen::Vector2d& place : test::grid_places(kAlong)) {
      std::vector<Mode> here;
      for (const test::MovingMode& mode : modes) here.push_back(mode.at(place));
      FrequencyResponse response;
      for (std::size_t i = 1; i <= kLines; ++i)
        response.frequencies_hz.push_back(kHighest_hz * static_cast<double>(i) / kLines);
      for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t f = 0; f < tapped_axes; ++f) {
          ComplexValues& entry = response.receptance[r][f];
          double largest = 0.0;
          for (const double hz : response.frequencies_hz) {
            entry.push_back(receptance_between(here, r, f, hz));
            largest = std::max(largest, std::abs(entry.back()));
          }
          for (std::complex<double>& value : entry)
            value += kNoise * largest * std::complex<double>(normal(random), normal(random));
        }
      const std::string id = std::to_string(++number);
      std::ofstream file(folder_ / (id + ".uff"), std::ios::binary);
      write_uff(file, uff_of(response), UffForm::binary);
      question_.files.push_back((folder_ / (id + ".uff")).string());
      postures << id << ',' << 1e3 * place.x() << ',' << 1e3 * place.y() << ",0\n";
    }
    question_.postures = (folder_ / "postures.csv").string();
    question_.jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  }
  ~Measurements() { std::filesystem::remove_all(folder_); }
  Measurements(const Measurements&) = delete;
  Measurements& operator=(const Measurements&) = delete;

  [[nodiscard]] FitStudy fit() const {
    FitStudy study = fit_map(question_, [](double) {});
    write_fitted_map(study, folder_ / "map");
    return study;
  }

 private:
  std::filesystem::path folder_;
  FitQuestion question_;
};

void fit_49_postures(benchmark::State& state) {
  const Measurements measurements(static_cast<std::size_t>(state.range(0)));
  std::size_t modes = 0;
  int tracks = 0;
  for (auto _ : state) {
    const FitStudy study = measurements.fit();
    modes = 0;
    for (const Posture& posture : study.map.postures) modes += posture.modes.size();
    tracks = study.tracks.count;
  }
  state.counters["modes_of_294"] = static_cast<double>(modes);
  state.counters["tracks_of_6"] = tracks;
}

BENCHMARK(fit_49_postures)
    ->Arg(1)
    ->Arg(3)
    ->Unit(benchmark::kSecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Iterations(1);

}  // namespace

BENCHMARK_MAIN();
