#include "tests/case_study/cut_verdicts.hpp"

#include "dsp/numbers.hpp"
#include "models/chatter_truth.hpp"
#include "models/floquet.hpp"
#include "models/linear_cut.hpp"
#include "models/milling_simulation.hpp"
#include "models/paper_projection.hpp"
#include "models/receptance.hpp"
#include "models/zeroth_order.hpp"

namespace stillcut::case_study {
namespace {

struct AtDepth {
  bool chatters;
  double chatter_hz;
};

AtDepth by_paper_lobes(const LinearCut& linear, std::span<const Mode> modes, const Cut& cut) {
  const auto projected = [&](double frequency) {
    return paper_feed_plane(receptance(modes, frequency), cut.feed_direction);
  };
  constexpr double kDeepest = 0.02;  // m
  const std::array<double, 1> speeds{cut.spindle_speed};
  const DepthLimit limit = zeroth_order_limits(linear, modes, projected, speeds, kDeepest).front();
  return {cut.axial_depth > limit.depth, limit.chatter_frequency / kTwoPi};
}

AtDepth by_floquet(const LinearCut& linear, std::span<const Mode> modes, const Cut& cut) {
  const FloquetPoint point =
      floquet_point(linear, modes_in_feed_frame(modes, cut.feed_direction), cut.spindle_speed, cut.axial_depth);
  return {point.spectral_radius >= 1.0, point.chatter_frequency / kTwoPi};
}

// Two seconds at full depth from the start. There is no runout, so a sound cut repeats from tooth to tooth: the truth
// is told a tooth's turn as a whole one, and sees period doubling too.
AtDepth in_time(const Cell& cell, std::span<const Mode> modes, const Cut& cut) {
  constexpr double kDuration = 2.0, kSampleRate_hz = 12'800.0;
  MillingSetup setup;
  setup.tool = *cell.tool;
  setup.material = *cell.material;
  setup.cut = cut;
  setup.modes.assign(modes.begin(), modes.end());
  MillingSimulation simulation{setup, kSampleRate_hz};
  ChatterTruth truth;
  for (int i = 0; i < static_cast<int>(kDuration * kSampleRate_hz); ++i) {
    const MillingState& state = simulation.advance();
    truth.add(state.time, state.spindle_angle * setup.tool.teeth, state.displacement, false);
  }
  for (const ChatterSpell& spell : truth.spells())
    if (!spell.died_down) return {true, spell.frequency_hz};
  return {false, kNaN};
}

}  // namespace

CutVerdict judge_cut(const Cell& cell, std::span<const Mode> modes, const CutOfTable2& asked, Judge judge) {
  Cut cut = require(cell, cell.cut, "cut");
  cut.feed_direction = deg_to_rad(asked.feed_direction_deg);
  cut.spindle_speed = rpm_to_rad_s(asked.speed_rpm);
  const LinearCut linear = linear_cut(require(cell, cell.tool, "tool"), require(cell, cell.material, "material"), cut);
  const auto at = [&](double share) {
    cut.axial_depth = share * asked.depth_mm * 1e-3;
    if (judge == Judge::paper_lobes) return by_paper_lobes(linear, modes, cut);
    return judge == Judge::floquet ? by_floquet(linear, modes, cut) : in_time(cell, modes, cut);
  };
  const AtDepth here = at(1.0);
  const bool turns = at(here.chatters ? 1.0 - kMarginal : 1.0 + kMarginal).chatters != here.chatters;
  return {here.chatters, turns, here.chatters ? here.chatter_hz : kNaN};
}

bool agrees(Verdict paper, const CutVerdict& ours) {
  if (paper == Verdict::near_limit) return ours.marginal;
  return ours.chatters == (paper == Verdict::unstable);
}

}  // namespace stillcut::case_study
