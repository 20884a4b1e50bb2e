#include "rt/speed_choice.hpp"

#include <algorithm>
#include <cmath>

#include "dsp/numbers.hpp"
#include "rt/trajectory.hpp"

namespace stillcut {
namespace {

constexpr double kAlreadyThere = 0.005;  // a target this near is no move
constexpr double kSamePocket = 0.025;    // of one already tried, of a target that is in step with nothing
constexpr double kBeside = 0.01;         // relative: the error of n_k, within which a safe speed is looked for
constexpr double kBesideOfLobe = 0.2;    // the same in distances between two n_k
constexpr int kBesideSteps = 6;          // to each side
constexpr double kHighestLobe = 1e6;     // beyond it speeds and frequency do not belong together
constexpr int kMostLobes = 64;           // bounds the work; so high up the lobes run into one another
constexpr double kLeastGain = 0.1;       // of margin: what is only better must be better by this
constexpr double kAway = 2.3;            // natural logarithm of the tenth to which the vibration has to fall
constexpr double kLeastDamping = 1e-4, kUsualDamping = 0.02,
                 kUsualFrequency_hz = 500.0;                      // of what vibrates, where nothing is known
constexpr double kLeastSafeMargin = 0.02, kMostSafeMargin = 1.0;  // beyond these an estimate of decay says nothing

struct SpeedCandidate {
  double target = 0.0;
  int lobe = 0;
  bool beside = false;  // the lobe's n_k
};

double move_time(const SpeedQuestion& q, const CompensationLimits& limits, double target) noexcept {
  const VelocityPlan plan =
      plan_velocity({0.0, q.speed, 0.0}, target, 0.0, {limits.spindle.acceleration, limits.spindle.jerk});
  return plan.error == TrajectoryError::none ? plan.trajectory.duration() : kNaN;
}

double damping_of(const LobeDiagram* lobes, double frequency_hz) noexcept {
  double damping = kUsualDamping, nearest = kInfinity;
  if (lobes == nullptr || !lobes->valid) return damping;
  for (int m = 0; m < std::clamp(lobes->mode_count, 0, LobeDiagram::kMaxModes); ++m) {
    const ModeSummary& mode = lobes->modes[static_cast<std::size_t>(m)];
    if (const double off = std::abs(mode.frequency_hz - frequency_hz); off < nearest) {
      nearest = off;
      damping = mode.damping_ratio;
    }
  }
  return damping;
}

// Far below its limit a mode decays with its own damping, at the limit not at all; between, in proportion.
double decay_time(const SpeedQuestion& q, double safe_margin) noexcept {
  const double margin = std::isnan(safe_margin) ? kLeastSafeMargin : safe_margin;
  const double m = std::clamp(margin, kLeastSafeMargin, kMostSafeMargin);
  const double frequency_hz = q.vibration_hz > 0.0 ? q.vibration_hz : kUsualFrequency_hz;
  const double damping = std::max(damping_of(q.prediction.here, frequency_hz), kLeastDamping);
  return kAway / (damping * kTwoPi * frequency_hz * m / (1.0 + m));
}

double until_quiet(const SpeedChoice& c) noexcept { return c.move_s + c.decay_s; }

bool better(const SpeedChoice& a, const SpeedChoice& b) noexcept {
  if (a.grounds != b.grounds) return a.grounds > b.grounds;
  if (a.grounds == SpeedGrounds::improved && a.safe_margin != b.safe_margin) return a.safe_margin > b.safe_margin;
  return until_quiet(a) < until_quiet(b);
}

class Search {
 public:
  Search(const SpeedQuestion& question, const CompensationLimits& limits) noexcept
      : q_{question},
        limits_{limits},
        margin_before_{margin_at(q_.prediction, q_.speed)},
        // Chatter where it is predicted confirms the lobes, whichever of its lines is heard.
        heard_is_known_{q_.prediction.here != nullptr &&
                        (std::isnan(q_.chatter_frequency_hz) || margin_before_ < 0.0 ||
                         explains(*q_.prediction.here, q_.speed, q_.chatter_frequency_hz))} {
    best_.margin_before = margin_before_;
    best_.margin_after = best_.safe_margin = kNaN;
  }

  // n_k itself where that is safe; else the nearest safe speed beside it, else the safest.
  void consider_lobe(double n_k, int lobe) noexcept {
    if (was_tried(q_.tried, n_k)) return;
    if (consider({n_k, lobe}) == SpeedGrounds::agreed) return;
    const double reach = std::min(kBeside, kBesideOfLobe / lobe);
    for (int i = 1; i <= kBesideSteps; ++i)
      for (const int side : {-1, 1}) {
        const double off = side * reach * i / kBesideSteps;
        const double speed = n_k * (1.0 + off);
        // Without a prediction for it nothing speaks for a speed that is out of step.
        if (std::isnan(margin_at(q_.prediction, speed))) continue;
        if (consider({speed, lobe, true}) == SpeedGrounds::agreed) return;
      }
  }
  // The grounds on which it may be chosen, whether or not it is the best.
  SpeedGrounds consider(const SpeedCandidate& candidate) noexcept {
    constexpr SpeedGrounds kNone = SpeedGrounds::none;
    const double target = candidate.target;
    if (!may_stay_at(limits_, target) || !keeps_feed_per_tooth(limits_, target, q_.programmed_speed)) return kNone;
    if (std::abs(target - q_.speed) < kAlreadyThere * q_.speed) return kNone;
    if (was_tried(q_.tried, target, candidate.lobe == 0 ? kSamePocket : kSameTarget)) return kNone;
    SpeedChoice c;
    c.target = target;
    c.lobe = candidate.lobe;
    c.margin_before = margin_before_;
    c.margin_after = margin_at(q_.prediction, target);
    c.safe_margin = safe_margin_at(q_.prediction, target);
    c.grounds = grounds_of(c, candidate.beside);
    if (c.grounds == kNone) return kNone;
    c.move_s = move_time(q_, limits_, target);
    if (std::isnan(c.move_s)) return kNone;
    c.decay_s = decay_time(q_, c.safe_margin);
    if (better(c, best_)) best_ = c;
    return c.grounds;
  }

  SpeedChoice finish() noexcept {
    if (!best_.found()) {
      best_.limited_by = kNoStableSettingKnown | kLimitedBySpeedRange;
      return best_;
    }
    if (override_for(limits_, best_.target, q_.programmed_speed) != best_.target / q_.programmed_speed)
      best_.limited_by |= kLimitedByFeedRange;
    best_.confidence_percent = confidence();
    return best_;
  }

 private:
  // Do no harm: a setting predicted no better than the present one is none.
  [[nodiscard]] SpeedGrounds grounds_of(const SpeedChoice& c, bool beside) const noexcept {
    const bool predicted = !std::isnan(c.safe_margin);
    const bool was_predicted = !std::isnan(margin_before_);
    if (was_predicted && !predicted) return SpeedGrounds::none;  // leave what is known for what is not
    if (predicted && was_predicted && !(c.margin_after > margin_before_ && c.safe_margin > margin_before_))
      return SpeedGrounds::none;
    if (predicted && c.safe_margin > 0.0) {
      if (c.lobe > 0) return SpeedGrounds::agreed;
      return heard_is_known_ ? SpeedGrounds::predicted : SpeedGrounds::improved;
    }
    // Beside n_k only a prediction speaks for a speed, and one that knows nothing of this frequency does not.
    if (c.lobe > 0 && !beside && (!predicted || !heard_is_known_)) return SpeedGrounds::in_step;
    const bool gains = was_predicted && c.safe_margin - margin_before_ > kLeastGain;
    return predicted && gains ? SpeedGrounds::improved : SpeedGrounds::none;
  }

  // Heard and predicted agree: confident. Nothing predicted: the measured frequency alone. A prediction that says the
  // present cut is stable has just been contradicted.
  [[nodiscard]] int confidence() const noexcept {
    if (best_.grounds == SpeedGrounds::improved) return 30;
    if (best_.grounds == SpeedGrounds::in_step || !(margin_before_ < 0.0)) return 50;
    return best_.grounds == SpeedGrounds::agreed ? 80 : 60;
  }

  const SpeedQuestion& q_;
  const CompensationLimits& limits_;
  double margin_before_;
  bool heard_is_known_;
  SpeedChoice best_;
};

void consider_lobes(const SpeedQuestion& q, const CompensationLimits& limits, Search& search) noexcept {
  const double in_step = kTwoPi * q.chatter_frequency_hz / q.teeth;  // k = 1
  const double highest_lobe = in_step / limits.spindle.min_speed;
  if (!(q.teeth > 0 && in_step > 0.0 && highest_lobe < kHighestLobe)) return;
  const int first = std::max(1, static_cast<int>(std::ceil(in_step / limits.spindle.max_speed)));
  const int last = std::min(static_cast<int>(highest_lobe), first + kMostLobes);
  for (int k = first; k <= last; ++k) search.consider_lobe(in_step / k, k);
}

}  // namespace

bool was_tried(std::span<const double> tried, double speed, double tolerance) noexcept {
  return std::any_of(tried.begin(), tried.end(), [&](double t) { return std::abs(t - speed) < tolerance * speed; });
}

SpeedChoice choose_speed(const SpeedQuestion& q, const CompensationLimits& limits) noexcept {
  Search search{q, limits};
  if (q.speed > 0.0 && q.programmed_speed > 0.0 && limits.spindle.max_speed >= limits.spindle.min_speed) {
    consider_lobes(q, limits, search);
    if (const LobeDiagram* lobes = q.prediction.here; lobes != nullptr && lobes->valid)
      for (int i = 0; i < std::min(lobes->point_count, LobeDiagram::kMaxPoints); ++i)
        search.consider({lobes->points[static_cast<std::size_t>(i)].speed, 0});
  }
  return search.finish();
}

}  // namespace stillcut
