#include "models/frf_lines.hpp"

#include "models/machining.hpp"

namespace stillcut {

FrfLines lines_between(const FrequencyResponse& response, double lowest_hz, double highest_hz) {
  FrfLines result;
  for (std::size_t i = 0; i < response.frequencies_hz.size(); ++i) {
    const double hz = response.frequencies_hz[i];
    if (hz > 0.0 && hz >= lowest_hz && hz <= highest_hz) result.lines.push_back(i);
  }
  const auto count = static_cast<Eigen::Index>(result.lines.size());
  result.omega.resize(count);
  for (Eigen::Index n = 0; n < count; ++n)
    result.omega[n] = kTwoPi * response.frequencies_hz[result.lines[static_cast<std::size_t>(n)]];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const ComplexValues& measured = response.receptance[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
      if (measured.empty()) continue;
      FrfEntry entry{i, j, Eigen::VectorXcd(count)};
      for (Eigen::Index n = 0; n < count; ++n) entry.values[n] = measured[result.lines[static_cast<std::size_t>(n)]];
      result.entries.push_back(std::move(entry));
    }
  return result;
}

FrfLines some_lines(const FrfLines& all, Eigen::Index first, Eigen::Index count) {
  FrfLines result;
  result.omega = all.omega.segment(first, count);
  result.lines.assign(all.lines.begin() + first, all.lines.begin() + first + count);
  for (const FrfEntry& entry : all.entries)
    result.entries.push_back({entry.response, entry.force, entry.values.segment(first, count)});
  return result;
}

}  // namespace stillcut
