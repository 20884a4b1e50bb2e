#include "tests/case_study/differential_evolution.hpp"

#include <algorithm>
#include <random>

#include "tools/tasks_on_threads.hpp"

namespace stillcut::case_study {

Found minimum(const Search& search, const std::function<double(std::span<const double>)>& cost,
              const std::function<void(int, const Found&)>& watch) {
  constexpr double kWeight = 0.6, kCrossing = 0.8;
  std::mt19937_64 random{search.seed};
  // Not std::uniform_real_distribution: its numbers differ from library to library.
  const auto share = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const auto size = static_cast<std::size_t>(search.population), count = search.bounds.size();
  std::vector<Found> members(size), trials(size);
  const auto evaluate = [&](std::vector<Found>& all) {
    run_tasks(
        size, search.jobs, [&](std::size_t i) { all[i].cost = cost(all[i].at); }, [] {});
  };
  for (Found& member : members)
    for (const auto& [low, high] : search.bounds) member.at.push_back(low + (high - low) * share());
  evaluate(members);
  const auto best = [&] {
    return *std::min_element(members.begin(), members.end(),
                             [](const Found& a, const Found& b) { return a.cost < b.cost; });
  };
  for (int generation = 0; generation < search.generations; ++generation) {
    const std::vector<double> leader = best().at;
    for (std::size_t i = 0; i < size; ++i) {
      const auto other = [&] { return static_cast<std::size_t>(share() * static_cast<double>(size)); };
      const std::vector<double>&b = members[other()].at, &c = members[other()].at;
      const auto sure = static_cast<std::size_t>(share() * static_cast<double>(count));
      trials[i].at = members[i].at;
      for (std::size_t j = 0; j < count; ++j) {
        if (!(share() < kCrossing) && j != sure) continue;
        const auto [low, high] = search.bounds[j];
        const double own = members[i].at[j];
        trials[i].at[j] = std::clamp(own + kWeight * (leader[j] - own + b[j] - c[j]), low, high);
      }
    }
    evaluate(trials);
    for (std::size_t i = 0; i < size; ++i)
      if (trials[i].cost <= members[i].cost) members[i] = trials[i];
    watch(generation, best());
  }
  return best();
}

}  // namespace stillcut::case_study
