#include "models/period_map.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/cutting_pieces.hpp"
#include "models/modal_response.hpp"
#include "models/receptance.hpp"

namespace stillcut {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kCyclesPerStretch = 4.0;
constexpr double kMostCycles = 120.0;  // in a cutting piece: what dense matrices hold in reasonable time

// What is observed at a node, in rows, and how the cut answers: F = -depth (force c + damping_force c').
struct NodeCoupling {
  MatrixXd observe;        // rows x 2, of the displacement's x and y
  MatrixXd force;          // 3 x rows
  MatrixXd damping_force;  // 3 x rows
};

// A stretch of the period between two breakpoints or a part of it; in free flight it has no nodes.
struct Stretch {
  double duration;  // s
  int nodes;
  std::vector<NodeCoupling> couplings;  // one a node
  Index rows = 0;                       // a node's
};

// A single straight tooth sees only the displacement along its chip's normal: one row instead of two.
NodeCoupling couple(const LinearCut& cut, const CuttingPiece& piece, double angle, double lag, double damping) {
  if (piece.tooth_angle.size() == 1 && lag == 0.0) {
    const double tip = piece.tooth_angle.front() + angle - piece.from;
    const Eigen::Vector2d normal = chip_normal(tip);
    return {normal.transpose(), cutting_force_direction(cut, tip),
            damping * Eigen::Vector3d(normal[0], normal[1], 0.0)};
  }
  const CuttingMatrices matrices = cutting_matrices(cut, piece, angle, lag);
  return {Eigen::Matrix2d::Identity(), matrices.stiffness, damping * matrices.radial};
}

using StretchTables = std::map<int, ForcedStretch>;  // by node count

std::vector<Stretch> divide(const LinearCut& cut, double lag, double speed, double highest_frequency,
                            const Collocation& collocation, StretchTables& tables) {
  const double damping = cut.process_damping / (speed * cut.radius);
  std::vector<Stretch> stretches;
  for (const CuttingPiece& piece : cutting_pieces(cut, lag)) {
    const double duration = (piece.to - piece.from) / speed;
    if (piece.tooth_angle.empty()) {
      stretches.push_back({duration, 0, {}});
      continue;
    }
    // The chip follows the vibration and the turning of the tooth's force, which repeats every half turn.
    const double cycles = duration * highest_frequency / kTwoPi + (piece.to - piece.from) / std::numbers::pi;
    if (cycles > kMostCycles) {
      throw std::invalid_argument("spindle speed: so low that the highest mode vibrates over " +
                                  std::to_string(static_cast<int>(kMostCycles)) +
                                  " times while a tooth cuts; raise the speed, or use method zoa");
    }
    const int parts = std::max(1, static_cast<int>(std::ceil(cycles / kCyclesPerStretch)));
    const int nodes = static_cast<int>(std::ceil(collocation.nodes + collocation.nodes_per_cycle * cycles / parts));
    const ForcedStretch& table = tables.try_emplace(nodes, nodes).first->second;
    for (int part = 0; part < parts; ++part) {
      Stretch stretch{duration / parts, nodes, {}};
      for (Index i = 0; i < table.size(); ++i) {
        const double angle = piece.from + (piece.to - piece.from) * (part + table.node(i)) / parts;
        stretch.couplings.push_back(couple(cut, piece, angle, lag, damping));
      }
      stretch.rows = stretch.couplings.front().observe.rows();
      stretches.push_back(std::move(stretch));
    }
  }
  return stretches;
}

// The march through the period: the state now, and what was observed at the nodes so far, as linear functions of the
// state at the start and of every chip (columns: states, chips of the positions, chips of the velocities).
struct March {
  Index states, positions, velocities;
  Index first = 0;  // the present stretch's first position, as row and as chip
  MatrixXd state = MatrixXd::Identity(states, states + positions + velocities);
  MatrixXd observed = MatrixXd::Zero(positions + velocities, states + positions + velocities);
};

// Force along a mode for a unit chip at each of a stretch's positions.
Eigen::RowVectorXd modal_force(const Stretch& stretch, const Oscillator& mode, MatrixXd NodeCoupling::*force) {
  Eigen::RowVectorXd result(stretch.nodes * stretch.rows);
  for (Index j = 0; j < stretch.nodes; ++j) {
    result.segment(j * stretch.rows, stretch.rows) =
        mode.direction.transpose() * stretch.couplings[static_cast<std::size_t>(j)].*force;
  }
  return result;
}

// Adds to `line` the answer to a stretch's chips: `answer` for a unit force at each node, times the force each chip
// makes.
template <class Line>
void add_chips(Line&& line, Index column, Index rows, const auto& answer, const Eigen::RowVectorXd& force) {
  for (Index j = 0; j < force.size(); ++j) line.col(column + j) += answer.col(j / rows) * force[j];
}

// One mode through one stretch: what it shows at the nodes, then its state at the end.
void advance(March& march, const Stretch& stretch, const ForcedStretch* table, const Oscillator& mode, Index index) {
  auto state = march.state.middleRows<2>(2 * index);
  if (table == nullptr) {
    state = (mode.transition(stretch.duration) * state).eval();
    return;
  }
  const Index rows = stretch.rows, chip = march.states + march.first, damping_chip = chip + march.positions;
  const bool damped = march.velocities > 0;
  const ModalResponse response = table->respond(mode, stretch.duration);
  const Eigen::RowVectorXd force = modal_force(stretch, mode, &NodeCoupling::force);
  const Eigen::RowVectorXd damping_force = modal_force(stretch, mode, &NodeCoupling::damping_force);
  const auto add_response = [&](auto&& line, const auto& answer) {
    add_chips(line, chip, rows, answer, force);
    if (damped) add_chips(line, damping_chip, rows, answer, damping_force);
  };
  for (Index i = 0; i < stretch.nodes; ++i) {
    const Eigen::Matrix2d free = mode.transition(stretch.duration * table->node(i));
    const Eigen::VectorXd seen = stretch.couplings[static_cast<std::size_t>(i)].observe * mode.direction.head<2>();
    MatrixXd answer = free * state;
    add_response(answer, response.at_node[static_cast<std::size_t>(i)]);
    for (Index k = 0; k < rows; ++k) {
      const Index row = march.first + i * rows + k;
      march.observed.row(row) += seen[k] * answer.row(0);
      if (damped) march.observed.row(march.positions + row) += seen[k] * mode.frequency * answer.row(1);
    }
  }
  state = (mode.transition(stretch.duration) * state).eval();
  add_response(state, response.end);
}

}  // namespace

PeriodMap period_map(const LinearCut& cut, std::span<const Mode> modes, double speed, double depth,
                     const Collocation& collocation) {
  check_modes(modes);
  if (!(speed > 0.0) || !std::isfinite(speed)) throw std::invalid_argument("spindle speed: must be positive");
  if (!(depth >= 0.0) || !std::isfinite(depth)) throw std::invalid_argument("axial depth: must not be negative");

  const std::vector<Oscillator> oscillators(modes.begin(), modes.end());
  double highest = 0.0;
  for (const Mode& mode : modes) highest = std::max(highest, mode.natural_frequency);
  StretchTables tables;
  const std::vector<Stretch> stretches = divide(cut, cut.lag_per_depth * depth, speed, highest, collocation, tables);

  PeriodMap map;
  map.period = kTwoPi / (speed * cut.teeth);
  for (const Stretch& stretch : stretches) map.positions += stretch.nodes * stretch.rows;
  const Index velocities = cut.process_damping > 0.0 ? map.positions : 0;
  const Index states = 2 * static_cast<Index>(modes.size());
  March progress{states, map.positions, velocities};
  for (const Stretch& stretch : stretches) {
    const ForcedStretch* table = stretch.nodes > 0 ? &tables.at(stretch.nodes) : nullptr;
    for (std::size_t m = 0; m < oscillators.size(); ++m) {
      advance(progress, stretch, table, oscillators[m], static_cast<Index>(m));
    }
    progress.first += stretch.nodes * stretch.rows;
  }
  map.observed_of_state = progress.observed.leftCols(states);
  map.observed_of_chip = progress.observed.rightCols(map.positions + velocities);
  map.state_of_state = progress.state.leftCols(states);
  map.state_of_chip = progress.state.rightCols(map.positions + velocities);
  return map;
}

MatrixXd monodromy(const PeriodMap& map, double depth) {
  const Index states = map.state_of_state.rows(), chips = map.observed_of_chip.rows(), positions = map.positions;
  // y = Ys s - depth Yc (y - J y_old)  =>  (I + depth Yc) y = Ys s + depth Yc J y_old
  MatrixXd right(chips, states + positions);
  right << map.observed_of_state, depth * map.observed_of_chip.leftCols(positions);
  const MatrixXd observed =
      (MatrixXd::Identity(chips, chips) + depth * map.observed_of_chip).partialPivLu().solve(right);
  MatrixXd chip = observed;
  chip.topRightCorner(positions, positions) -= MatrixXd::Identity(positions, positions);
  MatrixXd result(states + positions, states + positions);
  result.topRows(states) = -depth * map.state_of_chip * chip;
  result.topLeftCorner(states, states) += map.state_of_state;
  result.bottomRows(positions) = observed.topRows(positions);
  return result;
}

}  // namespace stillcut
