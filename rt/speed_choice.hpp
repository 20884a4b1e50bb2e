// Which spindle speed ends this chatter? The measured chatter frequency f_c proposes n_k = 60 f_c / (N k), the speeds
// at which the teeth beat in step with the chatter; the predicted lobes choose among them. Pure function, fit for the
// loop.
#pragma once

#include <cstdint>
#include <span>

#include "models/lobe_diagram.hpp"
#include "models/machining.hpp"
#include "rt/signals.hpp"

namespace stillcut {

struct SpeedQuestion {
  double chatter_frequency_hz = 0.0;
  int teeth = 0;
  double speed = 0.0;        // present, rad/s
  double axial_depth = 0.0;  // m; NaN: unknown
  SpindleLimits limits;
  const LobeDiagram* lobes = nullptr;  // nullptr: no diagram to be trusted
  std::span<const double> tried;       // targets that did not help, rad/s
};

struct SpeedChoice {
  bool found = false;
  double target = 0.0;         // rad/s
  int lobe = 0;                // k
  double margin_before = 0.0;  // a_lim/a - 1; NaN unknown
  double margin_after = 0.0;
  std::int32_t limited_by = 0;
  int confidence_percent = 0;
};

// The nearest n_k inside the limits that is predicted stable; failing that, the one predicted most stable, if it is
// better than the present speed; without a prediction, the nearest. Never a speed predicted worse than the present one.
SpeedChoice choose_speed(const SpeedQuestion& question) noexcept;

}  // namespace stillcut
