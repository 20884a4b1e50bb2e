#include "rt/predicted_margin.hpp"

#include <algorithm>
#include <cmath>

#include "dsp/numbers.hpp"
#include "models/machining.hpp"

namespace stillcut {
namespace {

constexpr double kSpeedKnown = 0.01;      // of f_c and of the spindle's speed: no pocket is entered more exactly
constexpr double kSameFrequency = 0.02;   // the chatter frequency moves so much between the limit and deep chatter
constexpr double kOtherFrequency = 0.06;  // beyond it the heard frequency is of another mode
constexpr double kAboutAMode = 0.25;
constexpr double kSidebandFound = 0.03;  // nearer than this to the prediction: its sideband

double margin_of(const Prediction& p, const LobeDiagram* diagram, double speed) noexcept {
  return diagram == nullptr ? kNaN : margin_at(*diagram, speed, p.axial_depth);
}

double worse(double a, double b) noexcept { return std::isnan(a) ? b : std::isnan(b) ? a : std::min(a, b); }

// The least margin of one diagram from low to high: at both ends, and at every point between. (Between two points the
// smaller one holds, so nothing is less.)
double least_margin(const Prediction& p, const LobeDiagram* diagram, double low, double high) noexcept {
  if (diagram == nullptr || !diagram->valid || diagram->point_count < 2) return kNaN;
  const auto last = static_cast<std::size_t>(std::min(diagram->point_count, LobeDiagram::kMaxPoints)) - 1;
  const double first_speed = diagram->points[0].speed;
  const double last_speed = diagram->points[last].speed;
  const double from = std::max(low, first_speed), to = std::min(high, last_speed);
  if (!(from <= to && last_speed > first_speed)) return kNaN;
  const double at_ends = worse(margin_of(p, diagram, from), margin_of(p, diagram, to));
  const auto first_inside = static_cast<std::size_t>(std::ceil(place_among_points(*diagram, from)));
  const auto last_inside = static_cast<std::size_t>(place_among_points(*diagram, to));
  double least = kInfinity;
  for (std::size_t i = first_inside; i <= last_inside; ++i) {
    const double limit = diagram->points[i].depth_limit;
    least = std::min(least, std::isnan(limit) ? 0.0 : limit);
  }
  return std::min(at_ends, least / p.axial_depth - 1.0);
}

// Chatter frequency predicted at a speed; NaN: none, or between two points that differ.
double predicted_frequency(const LobeDiagram& diagram, double speed) noexcept {
  const double place = place_among_points(diagram, speed);
  if (std::isnan(place)) return kNaN;
  const double a = diagram.points[static_cast<std::size_t>(std::floor(place))].chatter_frequency_hz;
  const double b = diagram.points[static_cast<std::size_t>(std::ceil(place))].chatter_frequency_hz;
  return std::abs(a - b) <= kSameFrequency * a ? 0.5 * (a + b) : kNaN;
}

bool is_near(double heard_hz, double hz, double share) noexcept { return std::abs(heard_hz - hz) < share * hz; }

bool near_a_mode(const LobeDiagram& diagram, double heard_hz, double share) noexcept {
  const auto count = static_cast<std::ptrdiff_t>(std::clamp(diagram.mode_count, 0, LobeDiagram::kMaxModes));
  return std::any_of(diagram.modes.begin(), diagram.modes.begin() + count,
                     [&](const ModeSummary& mode) { return is_near(heard_hz, mode.frequency_hz, share); });
}

}  // namespace

double margin_at(const Prediction& p, double speed) noexcept {
  return worse(margin_of(p, p.here, speed), margin_of(p, p.ahead, speed));
}

double safe_margin_at(const Prediction& p, double speed) noexcept {
  double least = kNaN;
  for (const LobeDiagram* diagram : {p.here, p.ahead}) {
    if (diagram == nullptr) continue;
    const double reach = kSpeedKnown + diagram->speed_scatter;
    const double nominal = least_margin(p, diagram, speed * (1.0 - reach), speed * (1.0 + reach));
    least = worse(least, (1.0 + nominal) * (1.0 - diagram->depth_scatter) - 1.0);
  }
  return least;
}

double base_frequency(const LobeDiagram& diagram, double speed, int teeth, double heard_hz) noexcept {
  const double predicted = predicted_frequency(diagram, speed);
  const double tooth_passing_hz = teeth * speed / kTwoPi;
  if (explains(diagram, speed, heard_hz) || !(tooth_passing_hz > 0.0) || std::isnan(predicted)) return heard_hz;
  const double base = heard_hz - std::round((heard_hz - predicted) / tooth_passing_hz) * tooth_passing_hz;
  return std::abs(base - predicted) < kSidebandFound * predicted ? base : heard_hz;
}

bool is_at_a_mode(const LobeDiagram& diagram, double heard_hz) noexcept {
  return near_a_mode(diagram, heard_hz, kAboutAMode);
}

bool explains(const LobeDiagram& diagram, double speed, double heard_hz) noexcept {
  return is_near(heard_hz, predicted_frequency(diagram, speed), kOtherFrequency) ||
         near_a_mode(diagram, heard_hz, kOtherFrequency);
}

}  // namespace stillcut
