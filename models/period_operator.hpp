// The period map as an operator, applied without ever being written out as one matrix: the march of a disturbance
// through the stretches of one period at one axial depth. Cost grows with the number of stretches, not with its cube.
#pragma once

#include <span>
#include <vector>

#include "models/leading_multiplier.hpp"
#include "models/period_map.hpp"

namespace stillcut {

// Teeth of equal pitch: what the tool left a period ago is known at the nodes themselves. A vector is (s, y): the
// modal state at the period's start and the displacements observed at all nodes in the period before.
class PeriodOperator final : public LinearMap {
 public:
  // Takes the depth (m) of the map; keeps a pointer to the map, and its own memory from call to call.
  void set(const PeriodMap& map, double depth);

  [[nodiscard]] int size() const override { return map_->states + map_->positions; }
  void apply(const double* in, double* out) const override;

 private:
  const PeriodMap* map_ = nullptr;
  double depth_ = 0.0;
  std::vector<double> inverse_;  // of 1 + depth of_chip, stretch after stretch, column by column
  std::vector<int> exchanged_;   // rows, while inverting
  mutable std::vector<double> chip_, observed_, state_;
};

// Teeth of unequal pitch: each looks back by its own delay, to a place between the nodes. A vector is (s, c) of every
// stretch of the period before: from it every displacement then can be told exactly.
class SeveralDelaysOperator final : public LinearMap {
 public:
  SeveralDelaysOperator(const LinearCut& cut, std::span<const Mode> feed_frame_modes, const PeriodMap& map,
                        double speed, double depth);

  [[nodiscard]] int size() const override { return size_; }
  void apply(const double* in, double* out) const override;

 private:
  struct LookBack {
    std::size_t stretch = 0;
    bool period_before = false;
    Eigen::RowVectorXd weights;  // of that stretch's (s, c)
  };
  struct Part {
    Eigen::Index begin = 0, size = 0;  // of this stretch's (s, c) in a vector
    Eigen::MatrixXd inverse;           // of 1 + depth of_chip
    std::vector<LookBack> look_back;   // one a position
  };
  [[nodiscard]] Eigen::VectorXd end_state(std::size_t stretch, const Eigen::VectorXd& all) const;

  const PeriodMap* map_;
  double depth_;
  int size_ = 0;
  std::vector<Part> parts_;
};

}  // namespace stillcut
