#include "models/period_operator.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "models/multiversion.hpp"

namespace stillcut {
namespace {

// Inverts a matrix in place by Gauss and Jordan with row exchanges. Rows lie one after another.
STILLCUT_MULTIVERSION void invert(double* matrix, int size, int* exchanged) {
  for (int pivot = 0; pivot < size; ++pivot) {
    int best = pivot;
    for (int i = pivot + 1; i < size; ++i) {
      if (std::abs(matrix[i * size + pivot]) > std::abs(matrix[best * size + pivot])) best = i;
    }
    exchanged[pivot] = best;
    double* pivot_row = matrix + pivot * size;
    if (best != pivot) {
      double* other = matrix + best * size;
      for (int j = 0; j < size; ++j) {
        const double keep = pivot_row[j];
        pivot_row[j] = other[j];
        other[j] = keep;
      }
    }
    const double scale = 1.0 / pivot_row[pivot];
    pivot_row[pivot] = 1.0;
    for (int j = 0; j < size; ++j) pivot_row[j] *= scale;
    for (int i = 0; i < size; ++i) {
      if (i == pivot) continue;
      double* row = matrix + i * size;
      const double factor = row[pivot];
      row[pivot] = 0.0;
      for (int j = 0; j < size; ++j) row[j] -= factor * pivot_row[j];
    }
  }
  for (int pivot = size - 1; pivot >= 0; --pivot) {
    if (exchanged[pivot] == pivot) continue;
    for (int i = 0; i < size; ++i) {
      const double keep = matrix[i * size + pivot];
      matrix[i * size + pivot] = matrix[i * size + exchanged[pivot]];
      matrix[i * size + exchanged[pivot]] = keep;
    }
  }
}

// result += factor x matrix x vector, the matrix column by column; four columns a pass, so that the result is read and
// written a quarter as often.
STILLCUT_MULTIVERSION void multiply(const double* matrix, const double* vector, int rows, int columns, double factor,
                                    double* result) {
  int j = 0;
  for (; j + 4 <= columns; j += 4) {
    const double a = factor * vector[j], b = factor * vector[j + 1], c = factor * vector[j + 2],
                 d = factor * vector[j + 3];
    const double* first = matrix + static_cast<std::ptrdiff_t>(j) * rows;
    const double *second = first + rows, *third = second + rows, *fourth = third + rows;
    for (int i = 0; i < rows; ++i) result[i] += (a * first[i] + b * second[i]) + (c * third[i] + d * fourth[i]);
  }
  for (; j < columns; ++j) {
    const double value = factor * vector[j];
    const double* column = matrix + static_cast<std::ptrdiff_t>(j) * rows;
    for (int i = 0; i < rows; ++i) result[i] += value * column[i];
  }
}

}  // namespace

void PeriodOperator::set(const PeriodMap& map, double depth) {
  map_ = &map;
  depth_ = depth;
  std::size_t total = 0, most = 0;
  for (const StretchMap& stretch : map.stretches) {
    const auto rows = static_cast<std::size_t>(stretch.of_chip.rows());
    total += rows * rows;
    most = std::max(most, rows);
  }
  inverse_.resize(total);
  chip_.resize(most);
  observed_.resize(most);
  state_.resize(static_cast<std::size_t>(map.states));
  exchanged_.resize(most);
  double* block = inverse_.data();
  for (const StretchMap& stretch : map.stretches) {
    const Eigen::Index rows = stretch.of_chip.rows();
    Eigen::Map<Eigen::MatrixXd> inverse(block, rows, rows);
    // Kept column by column, as multiply wants it; inverted row by row, which inverts the transpose: the same memory.
    inverse = depth * stretch.of_chip;
    inverse.diagonal().array() += 1.0;
    invert(block, static_cast<int>(rows), exchanged_.data());
    block += rows * rows;
  }
}

// With c = y - y_old and (1 + depth of_chip) c = of_state s - y_old.
void PeriodOperator::apply(const double* in, double* out) const {
  const int states = map_->states;
  const double* before = in + states;
  double* now = out + states;
  const double* inverse = inverse_.data();
  std::copy(in, in + states, state_.begin());
  for (const StretchMap& stretch : map_->stretches) {
    const int rows = static_cast<int>(stretch.of_chip.rows()), positions = stretch.positions;
    if (rows > 0) {
      for (int i = 0; i < rows; ++i) observed_[static_cast<std::size_t>(i)] = i < positions ? -before[i] : 0.0;
      multiply(stretch.of_state.data(), state_.data(), rows, states, 1.0, observed_.data());
      std::fill(chip_.begin(), chip_.end(), 0.0);
      multiply(inverse, observed_.data(), rows, rows, 1.0, chip_.data());
      for (int i = 0; i < positions; ++i) now[i] = before[i] + chip_[static_cast<std::size_t>(i)];
      inverse += static_cast<std::ptrdiff_t>(rows) * rows;
      before += positions;
      now += positions;
    }
    for (std::size_t m = 0; m < stretch.free.size(); ++m) {
      const Eigen::Matrix2d& free = stretch.free[m];
      const double q = state_[2 * m], p = state_[2 * m + 1];
      state_[2 * m] = free(0, 0) * q + free(0, 1) * p;
      state_[2 * m + 1] = free(1, 0) * q + free(1, 1) * p;
    }
    if (rows > 0) multiply(stretch.end_of_chip.data(), chip_.data(), states, rows, -depth_, state_.data());
  }
  std::copy(state_.begin(), state_.end(), out);
}

SeveralDelaysOperator::SeveralDelaysOperator(const LinearCut& cut, std::span<const Mode> modes, const PeriodMap& map,
                                             double speed, double depth)
    : map_{&map}, depth_{depth} {
  const std::vector<Oscillator> oscillators(modes.begin(), modes.end());
  Eigen::Index end = 0;
  for (const StretchMap& stretch : map.stretches) {
    Part& part = parts_.emplace_back();
    const Eigen::Index rows = stretch.of_chip.rows();
    part.begin = end, part.size = map.states + rows;
    end += part.size;
    part.inverse = (Eigen::MatrixXd::Identity(rows, rows) + depth * stretch.of_chip).inverse();
  }
  size_ = static_cast<int>(end);
  for (std::size_t r = 0; r < map.stretches.size(); ++r) {
    const StretchMap& stretch = map.stretches[r];
    for (int row = 0; row < stretch.positions; ++row) {
      const auto tooth = static_cast<std::size_t>(stretch.tooth[static_cast<std::size_t>(row % stretch.rows)]);
      const double node = forced_stretch(stretch.nodes).nodes()[row / stretch.rows];
      double angle = stretch.from + stretch.angle * node - cut.pitch[tooth];
      LookBack& back = parts_[r].look_back.emplace_back();
      back.period_before = angle < 0.0;
      if (back.period_before) angle += kTwoPi;
      while (back.stretch + 1 < map.stretches.size() && map.stretches[back.stretch + 1].from <= angle) ++back.stretch;
      const StretchMap& there = map.stretches[back.stretch];
      const double time = std::min(there.duration, (angle - there.from) / speed);
      back.weights = Eigen::RowVectorXd::Zero(parts_[back.stretch].size);
      for (std::size_t m = 0; m < oscillators.size(); ++m) {
        const Oscillator& mode = oscillators[m];
        const double seen = stretch.observe.col(row).dot(mode.direction);
        if (there.nodes == 0) {
          back.weights.segment<2>(2 * static_cast<Eigen::Index>(m)) += seen * mode.transition(time).row(0);
          continue;
        }
        const Eigen::RowVectorXd answer = forced_stretch(there.nodes).displacement_at(mode, there.duration, time);
        back.weights.segment<2>(2 * static_cast<Eigen::Index>(m)) += seen * answer.head<2>();
        for (Eigen::Index j = 0; j < there.load.cols(); ++j) {
          const Eigen::Index of_node = 2 + j % there.positions / there.rows;
          back.weights[map.states + j] -= depth * seen * answer[of_node] * there.load.col(j).dot(mode.direction);
        }
      }
    }
  }
}

Eigen::VectorXd SeveralDelaysOperator::end_state(std::size_t r, const Eigen::VectorXd& all) const {
  const StretchMap& stretch = map_->stretches[r];
  const Part& part = parts_[r];
  Eigen::VectorXd state(map_->states);
  for (std::size_t m = 0; m < stretch.free.size(); ++m) {
    const auto at = 2 * static_cast<Eigen::Index>(m);
    state.segment<2>(at) = stretch.free[m] * all.segment<2>(part.begin + at);
  }
  if (stretch.nodes > 0) {
    state -= depth_ * stretch.end_of_chip * all.segment(part.begin + map_->states, part.size - map_->states);
  }
  return state;
}

void SeveralDelaysOperator::apply(const double* in, double* out) const {
  const Eigen::VectorXd before = Eigen::Map<const Eigen::VectorXd>(in, size_);
  Eigen::VectorXd now(size_);
  Eigen::VectorXd state = end_state(parts_.size() - 1, before);
  for (std::size_t r = 0; r < parts_.size(); ++r) {
    const StretchMap& stretch = map_->stretches[r];
    const Part& part = parts_[r];
    now.segment(part.begin, map_->states) = state;
    if (stretch.nodes > 0) {
      Eigen::VectorXd chip = stretch.of_state * state;
      for (int row = 0; row < stretch.positions; ++row) {
        const LookBack& back = part.look_back[static_cast<std::size_t>(row)];
        const Part& there = parts_[back.stretch];
        chip[row] -= back.weights.dot((back.period_before ? before : now).segment(there.begin, there.size));
      }
      now.segment(part.begin + map_->states, part.size - map_->states) = part.inverse * chip;
    }
    state = end_state(r, now);
  }
  Eigen::Map<Eigen::VectorXd>(out, size_) = now;
}

}  // namespace stillcut
