// The table of docs/modal-identification.md: random structures at five postures each, identified, beside the
// Cramer-Rao bound and beside peaks picked by hand. Fails where an error is not of the bound's size, a mode that noise
// allows to be told is missing, or the stated uncertainty does not cover.
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <stdexcept>

#include "tests/models/identification_tally.hpp"
#include "tools/tasks_on_threads.hpp"

namespace {

using namespace stillcut;

constexpr int kPostures = 5;

// The structure's modes at one of its postures: frequencies and stiffness drift, directions turn.
std::vector<Mode> at_posture(std::vector<Mode> modes, int posture, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double stretch = 1.0 + 0.04 * (posture - 2);
  for (Mode& mode : modes) {
    mode.natural_frequency *= stretch;
    mode.stiffness *= stretch * stretch;
    Eigen::Map<Eigen::Vector3d> u(mode.direction.data());
    u += 0.1 * posture * Eigen::Vector3d(normal(random), normal(random), normal(random));
    u.normalize();
  }
  return modes;
}

// Nothing where no mode stands out of the noise.
ModalFit identified(const FrequencyResponse& response) {
  try {
    return identify_modes(response);
  } catch (const std::invalid_argument&) {
    return {};
  }
}

void add(IdentificationTally& sum, const IdentificationTally& one) {
  sum.modes += one.modes;
  sum.tellable += one.tellable;
  sum.told += one.told;
  sum.found += one.found;
  sum.spurious += one.spurious;
  sum.asked += one.asked;
  sum.kept += one.kept;
  sum.elsewhere += one.elsewhere;
  sum.picked += one.picked;
  for (std::size_t k = 0; k < kModeFigures; ++k) {
    sum.within_two[k] += one.within_two[k];
    sum.covered[k] += one.covered[k];
    sum.covered_elsewhere[k] += one.covered_elsewhere[k];
    sum.squares[k] += one.squares[k];
    sum.picked_squares[k] += one.picked_squares[k];
    sum.own_squares[k] += one.own_squares[k];
  }
}

std::array<double, kModeFigures> percent(const std::array<int, kModeFigures>& counts, int of) {
  std::array<double, kModeFigures> shares{};
  for (std::size_t k = 0; k < kModeFigures; ++k) shares[k] = 100.0 * counts[k] / std::max(1, of);
  return shares;
}

void print(const char* what, const std::array<double, kModeFigures>& figures, const char* form) {
  std::printf("  %-46s", what);
  for (const double figure : figures) std::printf(form, figure);
  std::printf("\n");
}

std::array<double, kModeFigures> root_mean(const std::array<double, kModeFigures>& squares, int count) {
  std::array<double, kModeFigures> roots{};
  for (std::size_t k = 0; k < kModeFigures; ++k) roots[k] = std::sqrt(squares[k] / std::max(1, count));
  return roots;
}

bool run(const char* name, const MeasuringPlan& plan, int structures, int jobs) {
  IdentificationTally sum;
  std::mutex adding;
  run_tasks(
      static_cast<std::size_t>(structures), jobs,
      [&](std::size_t s) {
        std::mt19937_64 random(1000 + s);
        const std::vector<Mode> modes = random_modes(random);
        IdentificationTally own;
        for (int posture = 0; posture < kPostures; ++posture) {
          const MeasuredStructure structure = measured(at_posture(modes, posture, random), plan, random);
          count_modes(own, structure, identified(structure.response), plan.signal_to_noise_db);
        }
        const std::scoped_lock lock(adding);
        add(sum, own);
      },
      [] {});
  std::printf("%s, %.0f dB, %d force axes: %d modes, %d tellable, %d of these found; %d found in all, %d spurious\n",
              name, plan.signal_to_noise_db, plan.force_axes, sum.modes, sum.tellable, sum.told, sum.found,
              sum.spurious);
  std::printf("  %-46s%10s%10s%10s%10s\n", "", "frequency", "damping", "stiffness", "direction");
  const auto rms = root_mean(sum.squares, sum.found);
  print("rms error over the Cramer-Rao bound", rms, "%10.2f");
  print("within twice the bound, %", percent(sum.within_two, sum.found), "%10.1f");
  print("covered by 1.96 stated deviations, %", percent(sum.covered, sum.found), "%10.1f");
  std::printf("  asked accuracy kept where it applies: %d of %d\n", sum.kept, sum.asked);
  print("covered elsewhere, %", percent(sum.covered_elsewhere, sum.elsewhere), "%10.1f");
  std::printf("  %d also found by peak picking; rms errors of these (%%, direction in degrees):\n", sum.picked);
  auto own = root_mean(sum.own_squares, sum.picked), picked = root_mean(sum.picked_squares, sum.picked);
  for (std::size_t k = 0; k < kModeFigures; ++k) {
    own[k] *= k == 3 ? 360.0 / kTwoPi : 100.0;
    picked[k] *= k == 3 ? 360.0 / kTwoPi : 100.0;
  }
  print("identified", own, "%10.4f");
  print("peak picking and half power", picked, "%10.4f");
  // One direction of force tells a mode that hardly moves that way by its small responses alone.
  const double share = plan.force_axes == 3 ? 0.97 : 0.93, most_rms = plan.force_axes == 3 ? 2.0 : 2.5;
  bool good = sum.told >= share * sum.tellable && sum.kept >= share * sum.asked;
  for (std::size_t k = 0; k < kModeFigures; ++k) good = good && rms[k] < most_rms && sum.covered[k] > 0.88 * sum.found;
  if (!good) std::printf("  MISSED\n");
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  const int structures = argc > 1 ? std::atoi(argv[1]) : 20, jobs = argc > 2 ? std::atoi(argv[2]) : 2;
  bool good = true;
  for (const double db : {60.0, 30.0})
    for (const int axes : {3, 1}) {
      good = run("even noise", {NoiseKind::even, db, axes}, structures, jobs) && good;
      good = run("the same share of every line", {NoiseKind::relative, db, axes}, structures, jobs) && good;
      good = run("even in acceleration", {NoiseKind::of_acceleration, db, axes}, structures, jobs) && good;
    }
  return good ? 0 : 1;
}
