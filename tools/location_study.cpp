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

std::vector<Posture> grid_postures(const DynamicsMap& map, double spacing) {
  std::array<double, 2> low{kInfinity, kInfinity}, high{-kInfinity, -kInfinity};
  for (const Posture& posture : map.postures) {
    for (std::size_t i = 0; i < 2; ++i) {
      low[i] = std::min(low[i], posture.position[i]);
      high[i] = std::max(high[i], posture.position[i]);
    }
  }
  const auto steps = [&](std::size_t i) { return std::max(1.0, std::ceil((high[i] - low[i]) / spacing - 1e-9)); };
  const auto in_mm = [](double metres) { return csv_number(std::round(metres * 1e6) / 1e3); };
  std::vector<Posture> postures;
  for (double row = 0; row <= steps(1); ++row) {
    for (double column = 0; column <= steps(0); ++column) {
      Posture posture;
      posture.position = {low[0] + (high[0] - low[0]) * column / steps(0), low[1] + (high[1] - low[1]) * row / steps(1),
                          map.postures.front().position[2]};
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
                                              std::optional<double> grid) {
  if (grid && dynamics.map.has_joints) {
    throw InputError(require(cell, cell.dynamics, "dynamics").map.string(), 0,
                     "has joint angles, between which a place does not tell the posture; leave --grid out, and make a "
                     "finer map with stillcut map --robot");
  }
  std::vector<PredictedPosture> locations;
  if (!grid) {
    for (const Posture& posture : dynamics.map.postures)
      locations.push_back(stability_posture(cell, dynamics, posture.id));
    return locations;
  }
  constexpr double kMostLocations = 2500;
  const std::vector<Posture> postures = grid_postures(dynamics.map, *grid);
  if (static_cast<double>(postures.size()) > kMostLocations)
    throw InputError(cell.file.string(), 0, "--grid: gives more than 2500 locations; give a wider one");
  for (const Posture& posture : postures) {
    locations.push_back(
        with_few_modes(predict_posture(dynamics.map, posture, dynamics.interpolation), kMostFloquetModes));
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
      if (cut.milling != Milling::slot) other.milling = cut.milling == Milling::up ? Milling::down : Milling::up;
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
