#include "models/milling_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace stillcut {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSamplesPerPeriod = 20.0;      // of the highest mode: what may be asked for
constexpr double kStepsPerPeriod = 60.0;        // of the highest mode: what the integrator takes at least
constexpr double kLargestTurn = 0.0175;         // rad a step: one degree of tooth motion resolves entry and exit
constexpr double kLargestLag = 0.035;           // rad between neighbouring heights of a helical edge
constexpr double kForceCorrelationTime = 1e-4;  // s: chip formation varies up to some kHz
constexpr double kLowestSpeedRatio = 0.02;      // of the highest speed in the schedule: bounds the surface memory

double highest_frequency_hz(const std::vector<Mode>& modes) {
  double highest = 0.0;
  for (const Mode& mode : modes) highest = std::max(highest, mode.natural_frequency / kTwoPi);
  return highest;
}

std::pair<double, double> value_range(const Schedule& schedule) {
  const auto by_value = [](const SchedulePoint& a, const SchedulePoint& b) { return a.value < b.value; };
  const auto [low, high] = std::minmax_element(schedule.begin(), schedule.end(), by_value);
  return {low->value, high->value};
}

void check(const Schedule& schedule, const char* what) {
  for (std::size_t i = 0; i < schedule.size(); ++i) {
    if (!std::isfinite(schedule[i].time) || !std::isfinite(schedule[i].value))
      throw std::invalid_argument(std::string(what) + ": times and values must be finite numbers");
    if (i > 0 && schedule[i].time < schedule[i - 1].time)
      throw std::invalid_argument(std::string(what) + ": times must not go back");
  }
}

// Fills in what the setup leaves to the cut and refuses what cannot be simulated.
MillingSetup completed(MillingSetup setup) {
  if (setup.axial_depth.empty()) setup.axial_depth = {{0.0, setup.cut.axial_depth}};
  if (setup.spindle_speed.empty()) setup.spindle_speed = {{0.0, setup.cut.spindle_speed}};
  check(setup.axial_depth, "axial depth");
  check(setup.spindle_speed, "spindle speed");
  const Tool& tool = setup.tool;
  if (tool.shape != ToolShape::end) throw std::invalid_argument("only end mills can be simulated in time");
  if (tool.teeth < 1 || tool.pitch.size() != static_cast<std::size_t>(tool.teeth) || !(tool.diameter > 0.0))
    throw std::invalid_argument("a tool needs a diameter, at least one tooth and one pitch angle a tooth");
  if (value_range(setup.axial_depth).first < 0.0) throw std::invalid_argument("axial depth: must not be negative");
  const auto [slowest, fastest] = value_range(setup.spindle_speed);
  if (!(slowest > 0.0) || slowest < kLowestSpeedRatio * fastest)
    throw std::invalid_argument("spindle speed: must stay above 2 % of its highest value");
  if (setup.modes.empty()) throw std::invalid_argument("a simulation needs at least one mode");
  return setup;
}

double wrapped(double angle) {  // to [-pi/2, 3 pi/2): the cut, 0..pi, lies inside with room at both ends
  return angle - kTwoPi * std::floor((angle + 0.5 * kPi) / kTwoPi);
}

int steps_per_sample(const MillingSetup& setup, double sample_rate_hz) {
  if (!(sample_rate_hz >= lowest_sample_rate_hz(setup.modes)))
    throw std::invalid_argument("sample rate: at least 20 samples a period of the highest mode are needed");
  const double fastest = value_range(setup.spindle_speed).second;
  const double needed_hz = std::max(kStepsPerPeriod * highest_frequency_hz(setup.modes), fastest / kLargestTurn);
  return static_cast<int>(std::ceil(needed_hz / sample_rate_hz));
}

}  // namespace

double lowest_sample_rate_hz(const std::vector<Mode>& modes) { return kSamplesPerPeriod * highest_frequency_hz(modes); }

MillingSimulation::MillingSimulation(MillingSetup setup, double sample_rate_hz)
    : setup_{completed(std::move(setup))},
      immersion_{immersion(setup_.cut.milling, setup_.cut.radial_depth, setup_.tool.diameter)},
      sample_step_{1.0 / sample_rate_hz},
      step_{sample_step_ / steps_per_sample(setup_, sample_rate_hz)},
      steps_per_sample_{steps_per_sample(setup_, sample_rate_hz)},
      structure_{setup_.modes, step_},
      random_{setup_.seed} {
  const Tool& tool = setup_.tool;
  const double c = std::cos(setup_.cut.feed_direction), s = std::sin(setup_.cut.feed_direction);
  feed_ = {c, s, 0.0};
  cross_feed_ = {-s, c, 0.0};
  for (double angle = 0.0; const double pitch : tool.pitch) {
    tooth_angle_.push_back(angle);
    tooth_runout_.push_back(tool.runout * std::cos(angle - tool.runout_angle));
    angle += pitch;
  }
  const double deepest = value_range(setup_.axial_depth).second;
  const double lag = 2.0 * deepest * std::tan(tool.helix) / tool.diameter;
  slices_ = std::max(1, static_cast<int>(std::ceil(std::abs(lag) / kLargestLag)));
  // Bins narrower than the smallest turn of a step: a tooth then never reads what it has itself just written.
  bins_ = static_cast<std::size_t>(std::ceil(2.0 * kTwoPi / (value_range(setup_.spindle_speed).first * step_)));
  surface_.assign(static_cast<std::size_t>(slices_) * bins_, 0.0);

  structure_.strike(setup_.impulse);
  speed_ = value_at(setup_.spindle_speed, 0.0);
  state_.spindle_speed = speed_;
  state_.axial_depth = value_at(setup_.axial_depth, 0.0);
  state_.velocity = structure_.velocity();
  const Geometry start{0.0, speed_ * step_, state_.axial_depth, speed_, 0.0};
  for (int slice = 0; slice < slices_; ++slice)
    for (int tooth = 0; tooth < tool.teeth; ++tooth) edges_.push_back({edge_angle(start, slice, tooth), 0.0});
}

double MillingSimulation::edge_angle(const Geometry& at, int slice, int tooth) const {
  const double height = (slice + 0.5) / slices_ * at.depth;
  const double lag = 2.0 * height * std::tan(setup_.tool.helix) / setup_.tool.diameter;
  return at.angle + tooth_angle_[static_cast<std::size_t>(tooth)] - lag;
}

// Radius that the edge reaches, about the ideal tool centre's path and less the nominal radius: its runout, the feed
// travelled and the vibration, all projected on the edge's own direction (circular tooth path).
double MillingSimulation::edge_radius(double angle, int tooth, double travel,
                                      const Eigen::Vector3d& displacement) const {
  const double s = std::sin(angle), c = std::cos(angle);
  return tooth_runout_[static_cast<std::size_t>(tooth)] + s * (travel + feed_.dot(displacement)) +
         c * cross_feed_.dot(displacement);
}

double MillingSimulation::surface_at(int slice, double angle) const {
  const double position = (angle / kTwoPi - std::floor(angle / kTwoPi)) * static_cast<double>(bins_);
  const auto low = std::min(static_cast<std::size_t>(position), bins_ - 1);
  const double part = position - static_cast<double>(low);
  const double* row = &surface_[static_cast<std::size_t>(slice) * bins_];
  return (1.0 - part) * row[low] + part * row[(low + 1) % bins_];
}

MillingSimulation::Load MillingSimulation::load_at(const Geometry& at, const Eigen::Vector3d& displacement,
                                                   const Eigen::Vector3d& velocity) const {
  Load load{Eigen::Vector3d::Zero(), 0.0};
  if (!(at.depth > 0.0)) return load;
  const Material& m = setup_.material;
  const double width = at.depth / slices_, cutting_speed = at.speed * 0.5 * setup_.tool.diameter;
  for (int slice = 0; slice < slices_; ++slice) {
    for (int tooth = 0; tooth < setup_.tool.teeth; ++tooth) {
      const double angle = edge_angle(at, slice, tooth), phi = wrapped(angle);
      // The share of this step's turn that lies in the part: entry and exit then fall between steps where they belong.
      const double inside =
          (std::min(phi + 0.5 * at.swept, immersion_.exit) - std::max(phi - 0.5 * at.swept, immersion_.entry)) /
          at.swept;
      if (!(inside > 0.0)) continue;
      const double chip = edge_radius(angle, tooth, at.travel, displacement) - surface_at(slice, angle);
      if (!(chip > 0.0)) continue;  // out of contact: the tooth does not reach the surface
      const double s = std::sin(phi), c = std::cos(phi), b = width * std::min(inside, 1.0);
      const double outward = s * feed_.dot(velocity) + c * cross_feed_.dot(velocity);
      const double tangential = (m.ktc * chip + m.kte) * b;
      const double radial = (m.krc * chip + m.kre + m.process_damping * outward / cutting_speed) * b;
      const double axial = (m.kac * chip + m.kae) * b;
      load.force += feed_ * (-tangential * c - radial * s) + cross_feed_ * (tangential * s - radial * c);
      load.force.z() -= axial;
      load.chip = std::max(load.chip, chip);
    }
  }
  return load;
}

// Each edge takes away what stands inside its path since the last step; outside the cut there is no part, and the path
// itself is kept as what the next tooth would meet.
void MillingSimulation::cut_surface(const Geometry& at, const Eigen::Vector3d& displacement) {
  const double bin_angle = kTwoPi / static_cast<double>(bins_);
  for (int slice = 0; slice < slices_; ++slice) {
    double* row = &surface_[static_cast<std::size_t>(slice) * bins_];
    for (int tooth = 0; tooth < setup_.tool.teeth; ++tooth) {
      Edge& last = edges_[static_cast<std::size_t>(slice * setup_.tool.teeth + tooth)];
      const Edge now{edge_angle(at, slice, tooth),
                     edge_radius(edge_angle(at, slice, tooth), tooth, at.travel, displacement)};
      const auto first = static_cast<std::int64_t>(std::floor(last.angle / bin_angle)) + 1;
      const auto end = static_cast<std::int64_t>(std::floor(now.angle / bin_angle));
      for (std::int64_t i = first; i <= end; ++i) {
        const double angle = static_cast<double>(i) * bin_angle;
        const double radius = std::lerp(last.radius, now.radius, (angle - last.angle) / (now.angle - last.angle));
        const auto count = static_cast<std::int64_t>(bins_);
        double& surface = row[((i % count) + count) % count];
        const double phi = wrapped(angle);
        const bool in_part = at.depth > 0.0 && phi >= immersion_.entry && phi <= immersion_.exit;
        surface = in_part ? std::max(surface, radius) : radius;
      }
      last = now;
    }
  }
}

// Predict the displacement with the force held, take the force there, correct with the force along a line (second
// order).
void MillingSimulation::step() {
  const double time = static_cast<double>(++step_count_) * step_;
  const double speed = value_at(setup_.spindle_speed, time);
  const double swept = 0.5 * (speed_ + speed) * step_;
  spindle_angle_ += swept;
  speed_ = speed;
  const double travel = setup_.cut.feed_per_tooth * setup_.tool.teeth * spindle_angle_ / kTwoPi;
  const Geometry at{spindle_angle_, swept, value_at(setup_.axial_depth, time), speed, travel};

  if (setup_.force_noise > 0.0) {
    const double kept = std::exp(-step_ / kForceCorrelationTime);
    std::normal_distribution<double> normal;
    force_variation_ = kept * force_variation_ + setup_.force_noise * std::sqrt(1.0 - kept * kept) * normal(random_);
  }
  const double scale = 1.0 + force_variation_;
  const Eigen::Vector3d begin = state_.force;
  const Eigen::Vector3d predicted =
      scale * load_at(at, structure_.displacement_after(begin, begin), state_.velocity).force;
  structure_.advance(begin, predicted);
  const Eigen::Vector3d displacement = structure_.displacement(), velocity = structure_.velocity();
  const Load load = load_at(at, displacement, velocity);
  cut_surface(at, displacement);
  state_ = {.time = time,
            .force = scale * load.force,
            .displacement = displacement,
            .velocity = velocity,
            .acceleration = structure_.acceleration(),
            .chip = load.chip,
            .spindle_speed = speed,
            .axial_depth = at.depth};
}

const MillingState& MillingSimulation::advance() {
  for (int i = 0; i < steps_per_sample_; ++i) step();
  const std::int64_t sample = step_count_ / steps_per_sample_;
  state_.time = static_cast<double>(sample) * sample_step_;  // free of the steps' rounding
  return state_;
}

}  // namespace stillcut
