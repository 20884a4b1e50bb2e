// Prediction beside the loop: from the robot's posture to a dated stability lobe diagram. Ordinary threads only; takes
// milliseconds to seconds. Playback calls it in place, the daemon on its model thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "drivers/files/cell.hpp"
#include "drivers/files/feed_map_file.hpp"
#include "models/confidence.hpp"
#include "models/dynamics_map.hpp"
#include "models/interpolation.hpp"
#include "models/lobe_diagram.hpp"
#include "rt/signals.hpp"

namespace stillcut {

// Which robot states get a diagram: the first of every 40 ms by their stamps, 25 a second. So playback computes the
// same ones as the live run, and the computation keeps up with a robot that moves.
class PredictionPace {
 public:
  static constexpr std::int64_t kPeriodNs = 40'000'000;

  bool due(const RobotState& state) noexcept {
    const std::int64_t period = state.stamp_ns / kPeriodNs;
    return period != std::exchange(last_period_, period);
  }

 private:
  std::int64_t last_period_ = -1;
};

struct NominalPrediction {
  LobeDiagram diagram;  // with modes only, and no lobes, for a cut that the lobes cannot describe
  std::string warning;  // then: one line for the user
};

class Predictor {
 public:
  // Reads the cell's dynamics map and finds its posture. Throws InputError.
  explicit Predictor(const Cell& cell);

  // For the cell file's posture and cut.
  [[nodiscard]] NominalPrediction nominal() const;

  // For a robot state: posture, feed direction and immersion as the robot reports them, the cell's where it does not.
  // The diagram is usable from a fixed time after the state's stamp, so that live run and playback take it up at the
  // same frame. Nothing when the state asks for what cannot be predicted (an immersion beyond the tool).
  [[nodiscard]] std::optional<LobeDiagram> at(const RobotState& state);

  // The state that the last answer of at() was computed for: the newest, or an earlier one that asks the same.
  [[nodiscard]] const RobotState& answered() const { return *computed_for_; }

  // For exactly this state, whatever was asked before; without its times. A recording's diagrams are made again with
  // it.
  [[nodiscard]] std::optional<LobeDiagram> again(const RobotState& state) const;

  // For an announced path: at every speed the least limit of its points; an invalid diagram, which takes back what was
  // announced before, for a path without points or with one that cannot be predicted.
  [[nodiscard]] LobeDiagram along(const RobotPath& path) const;

 private:
  [[nodiscard]] std::string slow_fit_warning() const;  // empty: none
  [[nodiscard]] PredictedPosture predict(const Posture& posture) const;
  [[nodiscard]] LobeDiagram compute(const PredictedPosture& predicted, const Cut& cut) const;
  void add_directions(const std::vector<Mode>& modes, Cut cut, double speed, LobeDiagram& diagram) const;
  void add_scatter(const PredictedPosture& predicted, LobeDiagram& diagram) const;
  [[nodiscard]] std::optional<LobeDiagram> at_place(const Posture& posture, double feed_direction, Milling milling,
                                                    double radial_depth, double directions_at_speed) const;

  std::string cell_file_;
  Tool tool_;
  Material material_;
  Cut cut_;
  SpindleLimits spindle_;
  DynamicsMap map_;
  Interpolation interpolation_;
  Posture posture_;
  bool directions_asked_ = false;  // the path leaves the feed direction free
  FeedMap feed_map_;
  ModalScatter map_scatter_;                // between postures
  std::optional<RobotState> computed_for_;  // the state that last_ belongs to
  LobeDiagram last_;
};

}  // namespace stillcut
