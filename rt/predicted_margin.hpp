// How far a setting is predicted to lie from chatter, and how sure that is. A diagram of the present posture and, where
// the controller announces its path, one of what comes next are read together: what counts is the worse. Constant
// time, noexcept, fit for the loop.
//
// Margin m = a_lim/a - 1 at axial depth a: above 0 stable, -1 unstable at every depth, NaN unknown.
#pragma once

#include "models/lobe_diagram.hpp"

namespace stillcut {

// What is predicted.
struct Prediction {
  const LobeDiagram* here = nullptr;   // of the present posture; nullptr: none to be trusted
  const LobeDiagram* ahead = nullptr;  // the least limits along the announced path; nullptr: none announced
  double axial_depth = 0.0;            // m; NaN unknown
};

// At a spindle speed, rad/s.
[[nodiscard]] double margin_at(const Prediction& prediction, double speed) noexcept;

// The margin that is still there if everything known only so well is against us: the least within the scatter of the
// speeds at which the lobes lie, with limits that are lower by their own scatter. At the ends of the diagram only what
// lies inside counts.
[[nodiscard]] double safe_margin_at(const Prediction& prediction, double speed) noexcept;

// The frequency of the chatter itself where what is heard may be one of its sidebands, f_c + j N n/60: the one nearest
// to what is predicted at this speed (rad/s), if it comes near; otherwise as heard.
[[nodiscard]] double base_frequency(const LobeDiagram& diagram, double speed, int teeth, double heard_hz) noexcept;

// Whether a heard frequency, which of a soft structure is not known well, is that of a mode.
[[nodiscard]] bool is_at_a_mode(const LobeDiagram& diagram, double heard_hz) noexcept;

// Whether a heard frequency is near one that the diagram knows: of a mode, or of chatter at this speed.
[[nodiscard]] bool explains(const LobeDiagram& diagram, double speed, double heard_hz) noexcept;

}  // namespace stillcut
