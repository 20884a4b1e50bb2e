// A folder of frequency responses as `stillcut fit` takes them, of modes that are known.
#pragma once

#include <cmath>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "drivers/files/frf_csv.hpp"
#include "drivers/files/frf_file.hpp"
#include "tests/models/tapped_structure.hpp"
#include "tests/tools/run_program.hpp"

namespace stillcut {

struct FrfAsked {
  double noise = 0.002;                      // standard deviation of both parts, over the largest |H| of the entry
  std::vector<std::size_t> forces{0, 1, 2};  // axes that were tapped
  double highest_hz = 300.0;
  std::size_t lines = 1200;
  unsigned seed = 1;
};

inline FrequencyResponse response_of(std::span<const Mode> modes, const FrfAsked& asked) {
  std::mt19937_64 random(asked.seed);
  std::normal_distribution<> normal;
  FrequencyResponse response;
  for (std::size_t i = 0; i < asked.lines; ++i)
    response.frequencies_hz.push_back(asked.highest_hz * static_cast<double>(i + 1) / static_cast<double>(asked.lines));
  double largest = 0.0;
  for (std::size_t r = 0; r < 3; ++r)
    for (const std::size_t f : asked.forces)
      for (const double hz : response.frequencies_hz) {
        response.receptance[r][f].push_back(receptance_between(modes, r, f, hz));
        largest = std::max(largest, std::abs(response.receptance[r][f].back()));
      }
  for (auto& row : response.receptance)
    for (ComplexValues& entry : row)
      for (std::complex<double>& value : entry) {
        const double re = normal(random), im = normal(random);
        value += asked.noise * largest * std::complex<double>(re, im);
      }
  return response;
}

class FrfFolder : public TempFolder {
 public:
  void write_csv(const std::string& name, std::span<const Mode> modes, const FrfAsked& asked = {}) const {
    std::ostringstream text;
    write_frf_csv(text, response_of(modes, asked));
    (void)write(name, text.str());
  }
  void write_uff_file(const std::string& name, std::span<const Mode> modes, const FrfAsked& asked = {}) const {
    std::ostringstream text;
    write_uff(text, uff_of(response_of(modes, asked)), UffForm::text);
    (void)write(name, text.str());
  }
  [[nodiscard]] Finished fit(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"stillcut", "fit"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments, path());
  }
};

// At `place`, from 0 to 1: two modes that cross (30 to 40 and 38 to 33 Hz) and one that stays.
inline std::vector<Mode> crossing_modes(double place) {
  return {{kTwoPi * (30.0 + 10.0 * place), 0.03, 2e6, {0.96, 0.28, 0.0}},
          {kTwoPi * (38.0 - 5.0 * place), 0.025, 3e6, {-0.28, 0.96, 0.0}},
          {kTwoPi * 140.0, 0.02, 2e7, {0.0, 0.6, 0.8}}};
}

inline const std::vector<std::string> kFrfFiles{"1.csv", "2.csv", "3.csv", "4.csv", "5.csv"};

// Five postures in a row, 100 mm apart, with noise.
class FrfRow : public FrfFolder {
 public:
  FrfRow() {
    std::string postures = "posture,x_mm,y_mm,z_mm\n";
    for (std::size_t i = 0; i < kFrfFiles.size(); ++i) {
      write_csv(kFrfFiles[i], crossing_modes(place(i)), {.seed = static_cast<unsigned>(i + 1)});
      postures += std::to_string(i + 1) + "," + std::to_string(100 * i) + ",0,0\n";
    }
    (void)write("postures.csv", postures);
  }
  static double place(std::size_t i) { return 0.25 * static_cast<double>(i); }

  [[nodiscard]] Finished fit_all(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = kFrfFiles;
    for (const char* word : {"--out", "map", "--postures", "postures.csv"}) arguments.emplace_back(word);
    arguments.insert(arguments.end(), more.begin(), more.end());
    return fit(arguments);
  }
};

}  // namespace stillcut
