#include "tools/loop_view.hpp"

#include <cmath>

#include "dsp/numbers.hpp"
#include "models/lobe_diagram.hpp"

namespace stillcut {

LoopView view_of(const Core& core, const DecoderCounters& decoder) noexcept {
  LoopView view;
  view.now_ns = core.now_ns();
  view.mode = core.mode();
  view.monitor = core.view();
  view.core = core.counters();
  view.decoder = decoder;
  view.axial_depth = core.axial_depth();
  view.feed_direction = core.feed_direction();
  view.margin = core.predicted_margin();
  view.depth_limit = view.predicted_chatter_hz = kNaN;
  const LobeDiagram* lobes = core.lobes();
  view.has_lobes = lobes != nullptr;
  if (lobes == nullptr) return view;
  view.depth_limit = depth_limit_at(*lobes, core.view().speed);
  if (const double place = place_among_points(*lobes, core.view().speed); std::isfinite(place))
    view.predicted_chatter_hz = lobes->points[static_cast<std::size_t>(std::lround(place))].chatter_frequency_hz;
  return view;
}

}  // namespace stillcut
