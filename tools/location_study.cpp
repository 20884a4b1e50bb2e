#include "tools/location_study.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>

#include "drivers/files/csv.hpp"
#include "models/lobes.hpp"
#include "models/modal_refit.hpp"
#include "tools/tasks_on_threads.hpp"

namespace stillcut {
namespace {

// Places over the box around the postures. Throws std::invalid_argument for too many.
std::vector<Posture> grid_postures(const DynamicsMap& map, double spacing) {
  constexpr double kMostPlaces = 2500;
  std::array<double, 2> low{kInfinity, kInfinity}, high{-kInfinity, -kInfinity};
  for (const Posture& posture : map.postures) {
    for (std::size_t i = 0; i < 2; ++i) {
      low[i] = std::min(low[i], posture.position[i]);
      high[i] = std::max(high[i], posture.position[i]);
    }
  }
  constexpr double kNoExtent = 1e-6;  // m
  std::array<double, 2> steps{};
  for (std::size_t i = 0; i < 2; ++i)
    steps[i] = high[i] - low[i] < kNoExtent ? 0.0 : std::max(1.0, std::ceil((high[i] - low[i]) / spacing - 1e-9));
  if ((steps[0] + 1.0) * (steps[1] + 1.0) > kMostPlaces)
    throw std::invalid_argument("--grid: gives more than 2500 places; give a wider one");
  const auto in_mm = [](double metres) { return csv_number(std::round(metres * 1e6) / 1e3); };
  const auto along = [&](std::size_t i, double step) {
    return steps[i] == 0.0 ? low[i] : low[i] + (high[i] - low[i]) * step / steps[i];
  };
  std::vector<Posture> postures;
  for (double row = 0; row <= steps[1]; ++row) {
    for (double column = 0; column <= steps[0]; ++column) {
      Posture posture;
      posture.position = {along(0, column), along(1, row), map.postures.front().position[2]};
      posture.id = in_mm(posture.position[0]) + "," + in_mm(posture.position[1]) + "," + in_mm(posture.position[2]);
      postures.push_back(posture);
    }
  }
  return postures;
}

// The curves that are asked for, each direction once.
std::vector<DirectionCurve> curves_for(const Tool& tool, const Material& material, const Cut& cut,
                                       const std::vector<Mode>& modes, DirectionStudy study,
                                       const std::vector<double>& further) {
  for (const double direction : further) {
    const bool known = std::any_of(study.directions.begin(), study.directions.end(),
                                   [&](double other) { return axis_angle(other, direction) < 1e-9; });
    if (!known) study.directions.push_back(axis_of(direction));
  }
  return limits_over_direction(tool, material, cut, modes, study);
}

}  // namespace

std::vector<PredictedPosture> study_locations(const Cell& cell, const CellDynamics& dynamics,
                                              const std::vector<std::string>& postures, std::optional<double> grid) {
  if (grid && dynamics.map.has_joints) {
    throw InputError(require(cell, cell.dynamics, "dynamics").map.string(), 0,
                     "has joint angles, between which a place does not tell the posture; leave --grid out, and make a "
                     "finer map with stillcut map --robot");
  }
  std::vector<PredictedPosture> locations;
  if (!grid) {
    std::vector<std::string> asked(postures);
    if (asked.empty())
      for (const Posture& posture : dynamics.map.postures) asked.push_back(posture.id);
    for (const std::string& posture : asked) locations.push_back(stability_posture(cell, dynamics, posture));
    return locations;
  }
  try {
    for (const Posture& place : grid_postures(dynamics.map, *grid)) {
      locations.push_back(
          with_few_modes(predict_posture(dynamics.map, place, dynamics.interpolation), kMostFloquetModes));
    }
  } catch (const std::invalid_argument& error) {
    throw InputError(cell.file.string(), 0, error.what());
  }
  return locations;
}

void solve_table(const Cell& cell, const Cut& cut, DirectionMethod method,
                 const std::vector<PredictedPosture>& locations, const std::vector<LocationQuestion>& questions,
                 int threads, const std::function<void(double)>& progress, DirectionTable& table) {
  const Tool& tool = require(cell, cell.tool, "tool");
  const Material& material = require(cell, cell.material, "material");
  table.locations.resize(locations.size());
  std::atomic<std::size_t> done{0};
  const auto solve = [&](std::size_t i) {
    const Posture& posture = locations[i].posture;
    LocationLimits& limits = table.locations[i];
    limits.posture = posture.id;
    limits.place = {posture.position[0], posture.position[1]};
    DirectionStudy study{table.directions, table.speeds, method, CutSense::as_set, table.max_depth};
    limits.curves = curves_for(tool, material, cut, posture.modes, study, questions[i].directions);
    if (!questions[i].alternating_directions.empty()) {
      study.directions.clear();
      Cut other = cut;
      other.milling = opposite(cut.milling);
      limits.alternating = curves_for(tool, material, other, posture.modes, study, questions[i].alternating_directions);
      for (DirectionCurve& curve : limits.alternating) {
        const DirectionCurve& as_set = curve_at(limits.curves, curve.direction);
        std::transform(curve.limits.begin(), curve.limits.end(), as_set.limits.begin(), curve.limits.begin(),
                       [](double one, double way) { return std::min(one, way); });
      }
    }
    ++done;
  };
  try {
    run_tasks(locations.size(), threads, solve,
              [&] { progress(static_cast<double>(done) / static_cast<double>(locations.size())); });
  } catch (const std::invalid_argument& error) {
    throw InputError(cell.file.string(), 0, error.what());
  }
}

}  // namespace stillcut
