#include "models/milling_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "models/edge_force.hpp"

namespace stillcut {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSamplesPerPeriod = 20.0;      // of the highest mode: what may be asked for
constexpr double kStepsPerPeriod = 60.0;        // of the highest mode: what the integrator takes at least
constexpr double kLargestTurn = 0.0175;         // rad a step: one degree of tooth motion resolves entry and exit
constexpr double kBinsPerStep = 3.0;            // at the slowest speed
constexpr double kForceCorrelationTime = 1e-4;  // s: chip formation varies up to some kHz
constexpr double kLowestSpeedRatio = 0.02;      // of the highest speed: bounds the surface memory
constexpr double kLostAt = 0.5;                 // m off the path: no machine is there any more

double highest_frequency_hz(const std::vector<Mode>& modes) {
  double highest = 0.0;
  for (const Mode& mode : modes) highest = std::max(highest, mode.natural_frequency / kTwoPi);
  return highest;
}

// Fills in what the setup leaves to the cut and refuses what cannot be simulated.
MillingSetup completed(MillingSetup setup) {
  const Tool& tool = setup.tool;
  if (tool.teeth < 1 || tool.pitch.size() != static_cast<std::size_t>(tool.teeth) || !(tool.diameter > 0.0))
    throw std::invalid_argument("a tool needs a diameter, at least one tooth and one pitch angle a tooth");
  if (setup.modes.empty()) throw std::invalid_argument("a simulation needs at least one mode");
  const double speed = setup.cut.spindle_speed;
  setup.deepest = std::max(setup.deepest, setup.cut.axial_depth);
  setup.slowest = setup.slowest > 0.0 ? std::min(setup.slowest, speed) : speed;
  setup.fastest = std::max(setup.fastest, speed);
  if (!std::isfinite(setup.fastest) || !(setup.slowest > 0.0) || setup.slowest < kLowestSpeedRatio * setup.fastest)
    throw std::invalid_argument("spindle speed: must stay above 2 % of its highest value");
  if (!(setup.deepest > 0.0 && std::isfinite(setup.deepest)))
    throw std::invalid_argument("axial depth: must be a positive number");
  return setup;
}

double wrapped(double angle) {  // to [-pi/2, 3 pi/2): the cut, 0..pi, lies inside with room at both ends
  return angle - kTwoPi * std::floor((angle + 0.5 * kPi) / kTwoPi);
}

int steps_per_sample(const MillingSetup& setup, double sample_rate_hz) {
  if (!(sample_rate_hz >= lowest_sample_rate_hz(setup.modes)))
    throw std::invalid_argument("sample rate: at least 20 samples a period of the highest mode are needed");
  const double needed_hz = std::max(kStepsPerPeriod * highest_frequency_hz(setup.modes), setup.fastest / kLargestTurn);
  return static_cast<int>(std::ceil(needed_hz / sample_rate_hz));
}

// An edge is divided for the deepest cut, and finely enough for the one that the setup begins with.
int element_count(const MillingSetup& setup) {
  const int count = edge_element_count(setup.tool, setup.deepest);
  const double depth = setup.cut.axial_depth;
  if (!(depth > 0.0)) return count;
  const double fewest = edge_element_count(setup.tool, depth) / profile_length(setup.tool, depth);
  return std::max(count,
                  static_cast<int>(std::ceil(fewest * profile_length(setup.tool, setup.deepest) * (1.0 - 1e-9))));
}

MillingConditions between(const MillingConditions& from, const MillingConditions& to, double part) {
  MillingConditions result = to;
  result.axial_depth = std::lerp(from.axial_depth, to.axial_depth, part);
  result.feed_per_tooth = std::lerp(from.feed_per_tooth, to.feed_per_tooth, part);
  result.spindle_speed = std::lerp(from.spindle_speed, to.spindle_speed, part);
  result.feed_direction = std::lerp(from.feed_direction, to.feed_direction, part);
  return result;
}

}  // namespace

double lowest_sample_rate_hz(const std::vector<Mode>& modes) { return kSamplesPerPeriod * highest_frequency_hz(modes); }

MillingConditions milling_conditions(const Cut& cut) {
  return {cut.milling, cut.radial_depth, cut.axial_depth, cut.feed_per_tooth, cut.spindle_speed, cut.feed_direction};
}

MillingSimulation::MillingSimulation(MillingSetup setup, double sample_rate_hz)
    : setup_{completed(std::move(setup))},
      conditions_{milling_conditions(setup_.cut)},
      immersion_{immersion(conditions_.milling, conditions_.radial_depth, setup_.tool.diameter)},
      sample_step_{1.0 / sample_rate_hz},
      step_{sample_step_ / steps_per_sample(setup_, sample_rate_hz)},
      steps_per_sample_{steps_per_sample(setup_, sample_rate_hz)},
      structure_{setup_.structure ? setup_.structure(step_) : std::make_unique<ModalStructure>(setup_.modes, step_)},
      random_{setup_.seed} {
  check(conditions_);
  const Tool& tool = setup_.tool;
  for (double angle = 0.0; const double pitch : tool.pitch) {
    tooth_angle_.push_back(angle);
    tooth_runout_.push_back(tool.runout * std::cos(angle - tool.runout_angle));
    tooth_axial_runout_.push_back(tool.axial_runout * std::cos(angle - tool.runout_angle));
    angle += pitch;
  }
  const auto bins = static_cast<std::size_t>(std::ceil(kBinsPerStep * kTwoPi / (setup_.slowest * step_)));
  for (std::size_t i = 0; i < bins; ++i) {
    const double angle = kTwoPi * static_cast<double>(i) / static_cast<double>(bins);
    bin_normal_.emplace_back(std::sin(angle), std::cos(angle));
  }
  const int count = element_count(setup_);
  elements_ = edge_elements(tool, setup_.deepest, count);
  piece_length_ = profile_length(tool, setup_.deepest) / count;
  surface_.assign(elements_.size() * bins, 0.0);

  spindle_angle_ = -conditions_.feed_direction;
  const double bin_angle = kTwoPi / static_cast<double>(bins);
  for (const EdgeElement& element : elements_)
    for (const double tooth : tooth_angle_)
      last_bin_.push_back(static_cast<std::int64_t>(std::floor((spindle_angle_ + tooth - element.lag) / bin_angle)));
  state_.spindle_speed = conditions_.spindle_speed;
  state_.axial_depth = conditions_.axial_depth;
}

void MillingSimulation::check(const MillingConditions& c) const {
  if (!(c.axial_depth >= 0.0 && c.axial_depth <= setup_.deepest))
    throw std::invalid_argument("axial depth: must lie between 0 and the deepest of the setup");
  if (!(c.spindle_speed >= setup_.slowest && c.spindle_speed <= setup_.fastest))
    throw std::invalid_argument("spindle speed: must lie between the slowest and the fastest of the setup");
  if (!(c.feed_per_tooth >= 0.0) || !std::isfinite(c.feed_per_tooth) || !std::isfinite(c.feed_direction))
    throw std::invalid_argument("feed: per tooth must be a number from 0 up, its direction a number");
  if (c.axial_depth > 0.0) (void)immersion(c.milling, c.radial_depth, setup_.tool.diameter);
}

// How much of an element stands in the part: the depth of cut may end within it.
double MillingSimulation::engaged_share(std::size_t element) const {
  return std::clamp(engaged_ / piece_length_ - static_cast<double>(element), 0.0, 1.0);
}

// The part of a step in which a tooth is engaged, and the force that the chip there exerts, as a mean over the step:
// entry and exit then fall between steps where they belong. The surface is compared bin by bin before it is
// interpolated, so that the tool's travel, the same in both, drops out.
void MillingSimulation::add_load(const Step& step, std::size_t tooth, std::size_t element, Load& load) const {
  const EdgeElement& edge = elements_[element];
  const double to_feed_frame = step.feed_direction, half = 0.5 * step.swept;
  const double centre = step.begin_angle + half + tooth_angle_[tooth] - edge.lag;
  const double phi = wrapped(centre + to_feed_frame);
  const double engaged_from = std::max(phi - half, immersion_.entry),
               engaged_to = std::min(phi + half, immersion_.exit);
  if (!(engaged_to > engaged_from)) return;
  const double off_centre = 0.5 * (engaged_from + engaged_to) - phi;
  const Eigen::Vector3d point = step.begin + (0.5 + off_centre / step.swept) * (step.end - step.begin);

  const auto bins = static_cast<double>(bin_normal_.size());
  double position = (centre + off_centre) / kTwoPi;
  position = (position - std::floor(position)) * bins;
  const std::size_t low = std::min(static_cast<std::size_t>(position), bin_normal_.size() - 1);
  const std::size_t high = low + 1 == bin_normal_.size() ? 0 : low + 1;
  const double part = position - static_cast<double>(low);
  const double axial_reach =
      tooth_runout_[tooth] * edge.sin_kappa - (tooth_axial_runout_[tooth] + point.z()) * edge.cos_kappa;
  const double* surface = &surface_[element * bin_normal_.size()];
  const auto chip_at = [&](std::size_t bin) {
    return edge.sin_kappa * bin_normal_[bin].dot(point.head<2>()) + axial_reach - surface[bin];
  };
  const double chip = std::lerp(chip_at(low), chip_at(high), part);
  if (!(chip > 0.0)) return;  // out of contact: the tooth does not reach the surface

  const Eigen::Vector2d outward = (1.0 - part) * bin_normal_[low] + part * bin_normal_[high];
  const double share = engaged_share(element) * (engaged_to - engaged_from) / step.swept;
  load.force += share * edge_force(setup_.material, edge, outward, chip, {step.velocity, step.cutting_speed});
  load.chip = std::max(load.chip, chip);
}

MillingSimulation::Load MillingSimulation::load_in(const Step& step) const {
  Load load;
  for (std::size_t element = 0; element < elements_.size() && engaged_share(element) > 0.0; ++element)
    for (std::size_t tooth = 0; tooth < tooth_angle_.size(); ++tooth) add_load(step, tooth, element, load);
  return load;
}

// Each edge takes away what stands inside its path since the last step; outside the cut there is no part, and the path
// itself is kept as what the next tooth would meet.
void MillingSimulation::cut_surface(const Step& step) {
  const auto bins = static_cast<std::int64_t>(bin_normal_.size());
  const double bin_angle = kTwoPi / static_cast<double>(bins);
  const Eigen::Vector3d moved = step.end - step.begin;
  for (std::size_t element = 0; element < elements_.size(); ++element) {
    const EdgeElement& edge = elements_[element];
    const bool in_cut = engaged_share(element) > 0.0;
    double* row = &surface_[element * static_cast<std::size_t>(bins)];
    for (std::size_t tooth = 0; tooth < tooth_angle_.size(); ++tooth) {
      const double begin = step.begin_angle + tooth_angle_[tooth] - edge.lag;
      const auto last = static_cast<std::int64_t>(std::floor((begin + step.swept) / bin_angle));
      std::int64_t& passed = last_bin_[element * tooth_angle_.size() + tooth];
      for (; passed < last; ++passed) {
        const double angle = static_cast<double>(passed + 1) * bin_angle;
        const auto bin = static_cast<std::size_t>(((passed + 1) % bins + bins) % bins);
        const Eigen::Vector3d point = step.begin + (angle - begin) / step.swept * moved;
        const double reach = edge.sin_kappa * (bin_normal_[bin].dot(point.head<2>()) + tooth_runout_[tooth]) -
                             edge.cos_kappa * (point.z() + tooth_axial_runout_[tooth]);
        const double phi = wrapped(angle + step.feed_direction);
        const bool in_part = in_cut && phi >= immersion_.entry && phi <= immersion_.exit;
        row[bin] = in_part ? std::max(row[bin], reach) : reach;
      }
    }
  }
}

// The displacement is predicted with the last force held; the force there, a mean over the step, then moves the
// structure, and where it really went is cut (second order).
void MillingSimulation::step(const MillingConditions& now) {
  engaged_ = profile_length(setup_.tool, now.axial_depth);
  const double swept = 0.5 * (state_.spindle_speed + now.spindle_speed) * step_;
  const double advanced = now.feed_per_tooth * setup_.tool.teeth * swept / kTwoPi;
  const Eigen::Vector3d travel =
      travel_ + advanced * Eigen::Vector3d(std::cos(now.feed_direction), std::sin(now.feed_direction), 0.0);
  const Eigen::Vector3d before = state_.displacement;
  const Eigen::Vector3d predicted = structure_->displacement_after(state_.force, state_.force);
  Step step{spindle_angle_,
            swept,
            now.feed_direction,
            now.spindle_speed * 0.5 * setup_.tool.diameter,
            travel_ + before,
            travel + predicted,
            (predicted - before) / step_};

  if (setup_.force_noise > 0.0) {
    const double kept = std::exp(-step_ / kForceCorrelationTime);
    std::normal_distribution<double> normal;
    force_variation_ = kept * force_variation_ + setup_.force_noise * std::sqrt(1.0 - kept * kept) * normal(random_);
  }
  const Load load = load_in(step);
  state_.force = (1.0 + force_variation_) * load.force;
  state_.chip = load.chip;
  structure_->advance(state_.force, state_.force);
  state_.displacement = structure_->displacement();
  step.end = travel + state_.displacement;
  cut_surface(step);
  travel_ = travel;
  spindle_angle_ += swept;
  state_.spindle_speed = now.spindle_speed;
}

const MillingState& MillingSimulation::advance(const MillingConditions& conditions) {
  check(conditions);
  if (conditions.axial_depth > 0.0)
    immersion_ = immersion(conditions.milling, conditions.radial_depth, setup_.tool.diameter);
  for (int i = 1; i <= steps_per_sample_; ++i)
    step(between(conditions_, conditions, static_cast<double>(i) / steps_per_sample_));
  conditions_ = conditions;
  state_.time = static_cast<double>(++sample_count_) * sample_step_;
  state_.velocity = structure_->velocity();
  state_.acceleration = structure_->acceleration();
  state_.spindle_angle = spindle_angle_ + setup_.cut.feed_direction;
  state_.axial_depth = conditions.axial_depth;
  if (!(state_.displacement.norm() < kLostAt))
    throw std::runtime_error("at " + std::to_string(state_.time) + " s: the tool leaves its path by more than " +
                             std::to_string(kLostAt).substr(0, 3) +
                             " m; the motion diverges: the cut is unstable or the force too large");
  return state_;
}

}  // namespace stillcut
