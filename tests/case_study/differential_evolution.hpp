// Differential evolution (Storn and Price 1997, rand/1/bin): a minimum of a rough function of a dozen numbers within
// bounds. The result depends on the seed and on nothing else.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace stillcut::case_study {

struct Search {
  std::vector<std::pair<double, double>> bounds;
  int population = 48, generations = 160, jobs = 1;
  std::uint64_t seed = 1;
};

struct Found {
  std::vector<double> at;
  double cost = 0.0;
};

// `cost` is called on several threads at once; `watch` after each generation with its number and the best so far.
Found minimum(const Search& search, const std::function<double(std::span<const double>)>& cost,
              const std::function<void(int, const Found&)>& watch);

}  // namespace stillcut::case_study
