#include "models/period_map.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "models/cutting_pieces.hpp"
#include "models/multiversion.hpp"
#include "models/receptance.hpp"

namespace stillcut {
namespace {

constexpr double kMostCycles = 2000.0;  // in a period
constexpr int kMostNodesOfAStretch = 96;

// What is observed at a node, and how the cut answers: F = -depth (load c + damping c').
struct Coupling {
  Eigen::Matrix3d observe, load, damping;  // of each: column a belongs to row a
  int rows;
};

Coupling couple(const LinearCut& cut, double tip, double depth, double damping) {
  if (cut.shape == ToolShape::end && cut.lag_per_depth * depth == 0.0) {  // sees only what is along its chip's normal
    Coupling one{Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero(), 1};
    one.observe.col(0).head<2>() = chip_normal(tip);
    one.load.col(0) = cutting_force_direction(cut, tip);
    one.damping.col(0) = damping * one.observe.col(0);
    return one;
  }
  const CuttingMatrices matrices = cutting_matrices(cut, tip, depth);
  return {Eigen::Matrix3d::Identity(), matrices.stiffness, damping * matrices.radial,
          cut.shape == ToolShape::ball ? 3 : 2};
}

// Teeth that share their delay are seen together, in the directions of the axes.
Coupling couple_all(const LinearCut& cut, const CuttingPiece& piece, double turned, double depth, double damping) {
  Coupling sum{Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero(),
               cut.shape == ToolShape::ball ? 3 : 2};
  for (const EngagedTooth& tooth : piece.teeth) {
    const CuttingMatrices matrices = cutting_matrices(cut, tooth.tip + turned, depth);
    sum.load += matrices.stiffness;
    sum.damping += damping * matrices.radial;
  }
  return sum;
}

// The flank's rubbing, per depth and radial speed: C_p over the cutting speed where the edge is fastest.
double damping_of(const LinearCut& cut, double speed, double depth) {
  if (cut.process_damping == 0.0) return 0.0;
  double radius = cut.radius;
  if (cut.shape == ToolShape::ball && depth < cut.radius) radius = std::sqrt(depth * (2.0 * cut.radius - depth));
  return radius > 0.0 ? cut.process_damping / (speed * radius) : 0.0;
}

// Highest frequency that the chip can hold, rad/s: the highest mode, stiffened by a wave that the deepest cut makes of
// it. A wave and its trace a period ago may add up, which doubles the stiffness; 1.5 holds on random cuts.
double highest_frequency(const LinearCut& cut, std::span<const Oscillator> modes, double deepest) {
  const double stiffness = 1.5 * deepest * std::hypot(cut.ktc, cut.krc, cut.kac);
  double highest = 0.0, compliance = 0.0;
  for (const Oscillator& mode : modes) {
    highest = std::max(highest, mode.frequency);
    compliance += mode.gain * mode.direction.head(cut.shape == ToolShape::ball ? 3 : 2).squaredNorm();
  }
  return std::sqrt(highest * highest + stiffness * compliance);
}

// of_chip(row i, column j) += seen_i per_unit_ij force_j; row after row, `stride` apart.
STILLCUT_MULTIVERSION void add_response(const double* seen, const double* per_unit, const double* force, int nodes,
                                        int rows, double* of_chip, std::ptrdiff_t stride) {
  for (int i = 0; i < nodes; ++i) {
    for (int a = 0; a < rows; ++a) {
      double* line = of_chip + (i * rows + a) * stride;
      const double scale = seen[i * rows + a];
      for (int j = 0; j < nodes; ++j) {
        const double value = scale * per_unit[i * nodes + j];
        for (int b = 0; b < rows; ++b) line[j * rows + b] += value * force[j * rows + b];
      }
    }
  }
}

void add_mode(StretchMap& map, const Oscillator& mode, const ModalResponse& response, int index, bool damped) {
  const int n = map.nodes, rows = map.rows, positions = map.positions;
  const Eigen::VectorXd seen = map.observe.transpose() * mode.direction;
  const Eigen::VectorXd force = map.load.transpose() * mode.direction;
  const std::ptrdiff_t stride = map.of_chip.cols();
  const int kinds = damped ? 2 : 1;
  for (int observed = 0; observed < kinds; ++observed) {  // positions, then velocities
    const RowMatrix& free = observed == 0 ? response.free : response.free_rate;
    const RowMatrix& forced = observed == 0 ? response.forced : response.forced_rate;
    const Eigen::VectorXd look = observed == 0 ? seen : Eigen::VectorXd(mode.frequency * seen);
    for (int i = 0; i < positions; ++i) {
      map.of_state(observed * positions + i, 2 * index) = look[i] * free(0, i / rows);
      map.of_state(observed * positions + i, 2 * index + 1) = look[i] * free(1, i / rows);
    }
    for (int made = 0; made < kinds; ++made) {
      add_response(look.data(), forced.data(), force.data() + made * positions, n, rows,
                   map.of_chip.data() + observed * positions * stride + made * positions, stride);
    }
  }
  for (int j = 0; j < kinds * positions; ++j) {
    map.end_of_chip(2 * index, j) = response.forced_end(0, j % positions / rows) * force[j];
    map.end_of_chip(2 * index + 1, j) = response.forced_end(1, j % positions / rows) * force[j];
  }
}

// The directions and loads at a stretch's nodes.
void place_nodes(StretchMap& map, const LinearCut& cut, const CuttingPiece& piece, const ForcedStretch& table,
                 double depth, double damping) {
  const bool together = cut.pitch.empty() && piece.teeth.size() > 1;
  const bool damped = damping > 0.0;
  for (int i = 0; i < map.nodes; ++i) {
    const double turned = map.from + map.angle * table.nodes()[i] - piece.from;
    const std::size_t groups = together ? 1 : piece.teeth.size();
    int row = 0;
    for (std::size_t g = 0; g < groups; ++g) {
      const Coupling coupling = together ? couple_all(cut, piece, turned, depth, damping)
                                         : couple(cut, piece.teeth[g].tip + turned, depth, damping);
      if (i == 0 && g == 0) {
        map.rows = static_cast<int>(groups) * coupling.rows;
        map.positions = map.nodes * map.rows;
        map.observe.resize(3, map.positions);
        map.load.resize(3, (damped ? 2 : 1) * map.positions);
      }
      for (int a = 0; a < coupling.rows; ++a, ++row) {
        if (i == 0) map.tooth.push_back(piece.teeth[g].tooth);
        map.observe.col(i * map.rows + row) = coupling.observe.col(a);
        map.load.col(i * map.rows + row) = coupling.load.col(a);
        if (damped) map.load.col(map.positions + i * map.rows + row) = coupling.damping.col(a);
      }
    }
  }
}

// The stretches of the period, still without the structure's response.
std::vector<StretchMap> divide(const LinearCut& cut, double speed, double depth, double frequency,
                               const Collocation& collocation) {
  const double damping = damping_of(cut, speed, depth);
  double shortest_delay = kTwoPi;
  for (const double pitch : cut.pitch) shortest_delay = std::min(shortest_delay, pitch);
  std::vector<StretchMap> stretches;
  for (const CuttingPiece& piece : cutting_pieces(cut, cut.lag_per_depth * depth)) {
    const double angle = piece.to - piece.from;
    if (piece.teeth.empty()) {
      StretchMap& free = stretches.emplace_back();
      free.from = piece.from, free.angle = angle, free.duration = angle / speed;
      continue;
    }
    const double cycles = angle / speed * frequency / kTwoPi + angle / std::numbers::pi;
    const int parts = static_cast<int>(
        std::ceil(std::max({1.0, cycles / collocation.cycles_per_stretch, angle / shortest_delay * (1.0 + 1e-9)})));
    const int nodes =
        std::min(kMostNodesOfAStretch,
                 static_cast<int>(std::ceil(collocation.nodes + collocation.nodes_per_cycle * cycles / parts)));
    for (int part = 0; part < parts; ++part) {
      StretchMap& stretch = stretches.emplace_back();
      stretch.from = piece.from + angle * part / parts;
      stretch.angle = angle / parts;
      stretch.duration = stretch.angle / speed;
      stretch.nodes = nodes;
      place_nodes(stretch, cut, piece, forced_stretch(nodes), depth, damping);
    }
  }
  return stretches;
}

}  // namespace

bool depends_on_depth(const LinearCut& cut) { return cut.lag_per_depth > 0.0 || cut.shape == ToolShape::ball; }

PeriodMap period_map(const LinearCut& cut, std::span<const Mode> modes, double speed, double depth, double deepest,
                     const Collocation& collocation) {
  check_modes(modes);
  if (!(speed > 0.0) || !std::isfinite(speed)) throw std::invalid_argument("spindle speed: must be positive");
  if (!(depth >= 0.0) || !std::isfinite(depth)) throw std::invalid_argument("axial depth: must not be negative");

  const std::vector<Oscillator> oscillators(modes.begin(), modes.end());
  const double frequency = highest_frequency(cut, oscillators, std::max(depth, deepest));
  PeriodMap map;
  map.states = 2 * static_cast<int>(modes.size());
  if (cut.period_angle() / speed * frequency / kTwoPi > kMostCycles) {
    throw std::invalid_argument("spindle speed: so low that the highest mode vibrates over " +
                                std::to_string(static_cast<int>(kMostCycles)) +
                                " times in a period; raise the speed, or use method zoa");
  }
  map.stretches = divide(cut, speed, depth, frequency, collocation);
  const bool damped = damping_of(cut, speed, depth) > 0.0;
  for (StretchMap& stretch : map.stretches) {
    map.positions += stretch.positions;
    stretch.free.reserve(oscillators.size());
    const Eigen::Index all = (damped ? 2 : 1) * stretch.positions;
    stretch.of_state.resize(all, map.states);
    stretch.of_chip = RowMatrix::Zero(all, all);
    stretch.end_of_chip.resize(map.states, all);
  }
  ModalResponse response;
  for (std::size_t m = 0; m < oscillators.size(); ++m) {
    const StretchMap* last = nullptr;  // parts of one piece are alike: their responses are the same
    for (StretchMap& stretch : map.stretches) {
      if (stretch.nodes == 0) {
        stretch.free.push_back(oscillators[m].transition(stretch.duration));
        continue;
      }
      if (last == nullptr || last->nodes != stretch.nodes || std::abs(last->angle - stretch.angle) > 1e-12) {
        forced_stretch(stretch.nodes).respond(oscillators[m], stretch.duration, damped, response);
      }
      last = &stretch;
      stretch.free.push_back(response.free_end);
      add_mode(stretch, oscillators[m], response, static_cast<int>(m), damped);
    }
  }
  return map;
}

}  // namespace stillcut
