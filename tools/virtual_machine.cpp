#include "tools/virtual_machine.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "drivers/can/dbc.hpp"
#include "models/mode_pairs.hpp"
#include "tools/cell_posture.hpp"

namespace stillcut {
namespace {

constexpr double kMovingStep = 0.01;                      // s between two sets of modes while the arm moves
constexpr double kAbruptDepth = 2e-3, kAbruptTurn = 0.5;  // m/s, rad/s
constexpr double kSpeedRoom = 0.02;  // relative, beyond the spindle's limits: rounding, and the programmed start

double scheduled_value(const Schedule& schedule, double time, double otherwise) {
  return schedule.empty() ? otherwise : value_at(schedule, time);
}

CellDynamics moving_dynamics(const Cell& cell) {
  CellDynamics dynamics = read_cell_dynamics(cell);
  if (dynamics.interpolation.kind == InterpolationKind::frf) dynamics.interpolation.kind = InterpolationKind::modal;
  return dynamics;
}

Cut start_cut(const Cell& cell, const Scenario& scenario) {
  Cut cut = require(cell, cell.cut, "cut");
  if (scenario.milling) cut.milling = *scenario.milling;
  return cut;
}

// A mode that some postures lack would appear or vanish on the way.
void check_moves(const DynamicsMap& map, const Scenario& scenario) {
  for (const Posture& posture : map.postures)
    if (!scenario.moves.empty() && posture.modes.size() != map.postures.front().modes.size())
      throw InputError(scenario.file.string(), 0,
                       "posture_move: the map has " + std::to_string(map.postures.front().modes.size()) +
                           " modes at posture " + map.postures.front().id + " and " +
                           std::to_string(posture.modes.size()) + " at " + posture.id +
                           "; a move needs the same modes everywhere");
}

std::vector<Posture> stations_of(const Cell& cell, const DynamicsMap& map, const Scenario& scenario) {
  check_moves(map, scenario);
  std::vector<Posture> stations{posture_of(cell, map, scenario.posture)};
  for (const PostureMove& move : scenario.moves) stations.push_back(find_posture(map, move.to));
  return stations;
}

double sample_rate_of(const Cell& cell, const DynamicsMap& map) {
  double rate_hz = 0.0;
  for (const AccelerometerSettings& sensor : require(cell, cell.can, "can").accelerometers)
    rate_hz = std::max(rate_hz, sensor.sample_rate_hz);
  for (const Posture& posture : map.postures) rate_hz = std::max(rate_hz, lowest_sample_rate_hz(posture.modes));
  return rate_hz;
}

MillingSetup setup_of_machine(const Cell& cell, const Scenario& scenario, const Cut& cut, std::vector<Mode> modes) {
  const SpindleLimits& spindle = require(cell, cell.spindle, "spindle");
  MillingSetup setup;
  setup.tool = require(cell, cell.tool, "tool");
  setup.material = require(cell, cell.material, "material");
  setup.cut = cut;
  setup.cut.axial_depth = scheduled_value(scenario.axial_depth, 0.0, cut.axial_depth);
  setup.cut.radial_depth = scheduled_value(scenario.radial_depth, 0.0, cut.radial_depth);
  setup.cut.spindle_speed = scheduled_value(scenario.spindle_speed, 0.0, cut.spindle_speed);
  setup.cut.feed_direction = scheduled_value(scenario.feed_direction, 0.0, cut.feed_direction);
  setup.deepest = cut.axial_depth;
  for (const SchedulePoint& point : scenario.axial_depth) setup.deepest = std::max(setup.deepest, point.value);
  setup.slowest = (1.0 - kSpeedRoom) * spindle.min_speed;
  setup.fastest = (1.0 + kSpeedRoom) * spindle.max_speed;
  setup.modes = std::move(modes);
  setup.force_noise = scenario.force_noise;
  setup.seed = scenario.seed;
  return setup;
}

MillingSimulation make_milling(const Cell& cell, MillingSetup setup, double rate_hz) {
  try {
    return {std::move(setup), rate_hz};
  } catch (const std::invalid_argument& error) {
    throw InputError(cell.file.string(), 0, error.what());
  }
}

Cut cut_at_start(Cut cut, const MillingConditions& start) {
  cut.feed_direction = start.feed_direction;
  return cut;
}

void check_nan(const Scenario& scenario, const CanEncoder& encoder) {
  for (const SensorFault& fault : scenario.sensor_faults)
    if (fault.kind == SensorFaultKind::nan && !encoder.can_send_nan())
      throw InputError(
          scenario.file.string(), fault.line,
          "sensor_fault.kind: this cell's sensor sends whole numbers, which cannot be \"nan\"; use another "
          "fault");
}

}  // namespace

VirtualMachine::VirtualMachine(const Cell& cell, const Scenario& scenario, std::int64_t origin_ns)
    : scenario_{scenario},
      tool_{require(cell, cell.tool, "tool")},
      cut_{start_cut(cell, scenario)},
      dynamics_{moving_dynamics(cell)},
      stations_{stations_of(cell, dynamics_.map, scenario)},
      origin_ns_{origin_ns},
      sample_rate_hz_{sample_rate_of(cell, dynamics_.map)},
      modes_{predict_posture(dynamics_.map, stations_.front(), dynamics_.interpolation).posture.modes},
      milling_{make_milling(cell, setup_of_machine(cell, scenario, cut_, modes_), sample_rate_hz_)},
      encoder_{read_dbc(require(cell, cell.can, "can").dbc),
               *cell.can,
               cell.file.string(),
               {scenario.sensor_noise, scenario.seed},
               origin_ns},
      controller_{scenario.controller, require(cell, cell.spindle, "spindle"), milling_.state().spindle_speed,
                  origin_ns},
      random_{scenario.seed},
      surface_{tool_, cut_at_start(cut_, milling_.conditions()), 1.0 / sample_rate_hz_} {
  check_nan(scenario_, encoder_);
  std::sort(scenario_.knocks.begin(), scenario_.knocks.end(),
            [](const Knock& a, const Knock& b) { return a.time < b.time; });
}

// Where the arm stands: joints and tool point go from one station to the next in a straight line.
Posture VirtualMachine::posture_at(double time) const {
  Posture posture = stations_.front();
  posture.modes.clear();
  for (std::size_t i = 0; i < scenario_.moves.size() && time > scenario_.moves[i].span.start; ++i) {
    const TimeSpan& span = scenario_.moves[i].span;
    const double part = std::clamp((time - span.start) / (span.end - span.start), 0.0, 1.0);
    const Posture &from = stations_[i], &to = stations_[i + 1];
    for (std::size_t j = 0; j < posture.joints.size(); ++j)
      posture.joints[j] = std::lerp(from.joints[j], to.joints[j], part);
    for (std::size_t x = 0; x < posture.position.size(); ++x)
      posture.position[x] = std::lerp(from.position[x], to.position[x], part);
  }
  return posture;
}

RobotState VirtualMachine::program_at(double time) const {
  const double speed = scheduled_value(scenario_.spindle_speed, time, cut_.spindle_speed);
  const Posture posture = posture_at(time);
  RobotState program;
  program.joint_position = posture.joints;
  program.tcp_position = posture.position;
  program.feed_direction = scheduled_value(scenario_.feed_direction, time, cut_.feed_direction);
  program.feed_rate = cut_.feed_per_tooth * tool_.teeth * speed / kTwoPi;
  program.spindle_speed_rpm = rad_s_to_rpm(speed);
  program.axial_depth = scheduled_value(scenario_.axial_depth, time, cut_.axial_depth);
  program.radial_depth = scheduled_value(scenario_.radial_depth, time, cut_.radial_depth);
  program.milling = cut_.milling;
  return program;
}

// What the tool meets: the part may have gaps that the program does not know of, and the feed per tooth follows from
// the feed rate and the speed that the spindle really has.
MillingConditions VirtualMachine::conditions_at(double time, const RobotState& program) const {
  MillingConditions conditions;
  conditions.milling = cut_.milling;
  conditions.axial_depth = program.axial_depth;
  conditions.radial_depth = program.radial_depth;
  conditions.spindle_speed = controller_.spindle_speed();
  conditions.feed_direction = program.feed_direction + controller_.feed_turn();
  conditions.feed_per_tooth =
      program.feed_rate * controller_.feed_override() * kTwoPi / (tool_.teeth * conditions.spindle_speed);
  for (const InterruptedCut& cut : scenario_.interrupted) {
    if (!cut.span.contains(time)) continue;
    if (std::fmod(time - cut.span.start, cut.in_cut + cut.in_air) >= cut.in_cut) conditions.axial_depth = 0.0;
  }
  return conditions;
}

// Blows and forces from outside; true when there was one.
bool VirtualMachine::strike(double time) {
  bool struck = false;
  Structure& structure = milling_.structure();
  const auto vector = [](const std::array<double, 3>& a) { return Eigen::Vector3d(a[0], a[1], a[2]); };
  for (; next_knock_ < scenario_.knocks.size() && scenario_.knocks[next_knock_].time <= time; ++next_knock_) {
    structure.strike(vector(scenario_.knocks[next_knock_].impulse));
    struck = true;
  }
  for (const OutsideForce& force : scenario_.forces) {
    if (!force.span.contains(time)) continue;
    structure.strike(std::sin(kTwoPi * force.frequency_hz * (time - force.span.start)) / sample_rate_hz_ *
                     vector(force.force));
    struck = true;
  }
  return struck;
}

// A change of the cut that sets the structure ringing by itself.
bool VirtualMachine::changes_abruptly(const MillingConditions& next) const {
  const MillingConditions& now = milling_.conditions();
  const double per_second = sample_rate_hz_;
  return std::abs(next.axial_depth - now.axial_depth) * per_second > kAbruptDepth ||
         std::abs(next.radial_depth - now.radial_depth) * per_second > kAbruptDepth ||
         std::abs(next.feed_direction - now.feed_direction) * per_second > kAbruptTurn || controller_.feed_moves() ||
         (next.axial_depth > 0.0) != (now.axial_depth > 0.0);
}

// While a move lasts the modes are those of the posture on the way. A mode's direction has no sign: it keeps the one it
// had, as its displacement does.
void VirtualMachine::move_structure(double time) {
  const bool moving = std::any_of(scenario_.moves.begin(), scenario_.moves.end(), [&](const PostureMove& move) {
    return time >= move.span.start && time < move.span.end + 2.0 * kMovingStep;
  });
  if (!moving || time < next_posture_s_) return;
  next_posture_s_ = time + kMovingStep;
  std::vector<Mode> modes = predict_posture(dynamics_.map, posture_at(time), dynamics_.interpolation).posture.modes;
  if (modes.size() != modes_.size()) throw std::runtime_error("a mode of the map is lost on the way between postures");
  for (std::size_t m = 0; m < modes.size(); ++m) {
    if (direction_cosine(modes[m], modes_[m]) < 0.0)
      for (double& part : modes[m].direction) part = -part;
  }
  dynamic_cast<ModalStructure&>(milling_.structure()).set_modes(modes);
  modes_ = std::move(modes);
}

void VirtualMachine::set_sensor_faults(double time) {
  if (scenario_.sensor_faults.empty()) return;
  SensorFaults now;
  for (const SensorFault& fault : scenario_.sensor_faults) {
    if (!fault.span.contains(time)) continue;
    now.silent = now.silent || fault.kind == SensorFaultKind::silent;
    for (int axis = 0; axis < kMaxAxes; ++axis)
      if (fault.axis < 0 || fault.axis == axis) now.axis[static_cast<std::size_t>(axis)] = fault;
  }
  encoder_.set_faults(now);
}

void VirtualMachine::record(const RobotState& program, bool disturbed) {
  const MillingState& s = milling_.state();
  truth_.add(s.time, s.spindle_angle, s.displacement, disturbed);
  surface_.add(s, milling_.conditions());
  vibration_.push_back(static_cast<float>(s.acceleration.x()));
  const double displacement = s.displacement.norm();
  peak_displacement_ = std::max(peak_displacement_, displacement);
  MachineMoment moment;
  moment.time = s.time;
  moment.axial_depth = s.axial_depth;
  moment.spindle_speed = s.spindle_speed;
  moment.programmed_speed = rpm_to_rad_s(program.spindle_speed_rpm);
  count_removed(moment);
  const auto millisecond = static_cast<std::size_t>(s.time * 1e3);
  if (millisecond >= moments_.size()) moments_.resize(millisecond + 1, moment);
  moments_.back().displacement = std::max(moments_.back().displacement, displacement);
}

// What the tool takes from the part as the feed really is.
void VirtualMachine::count_removed(MachineMoment& moment) {
  const MillingConditions& now = milling_.conditions();
  const double step = 1.0 / sample_rate_hz_, width = cut_.milling == Milling::slot ? tool_.diameter : now.radial_depth;
  moment.feed_rate = now.feed_per_tooth * tool_.teeth * now.spindle_speed / kTwoPi;
  moment.feed_direction = now.feed_direction;
  moment.removal_rate = now.axial_depth * width * moment.feed_rate;
  removed_ += moment.removal_rate * step;
  cutting_time_ += now.axial_depth > 0.0 ? step : 0.0;
}

MachineOutput VirtualMachine::advance() {
  const double time = static_cast<double>(++samples_) / sample_rate_hz_;
  if (!controller_.stopped()) program_time_ = time;
  const RobotState program = program_at(program_time_);
  const std::span<const ControllerMessage> messages = controller_.advance(time, program);
  move_structure(program_time_);
  set_sensor_faults(time);
  const MillingConditions conditions = conditions_at(program_time_, program);
  const bool struck = strike(time), disturbed = struck || changes_abruptly(conditions);
  const MillingState& state = milling_.advance(conditions);
  record(program, disturbed);
  frames_.clear();
  std::uniform_real_distribution<double> chance;
  for (const CanFrame& frame : encoder_.advance(state.time, state.velocity, state.spindle_speed)) {
    bool lost = false;
    for (const FrameLoss& loss : scenario_.losses)
      lost = lost || (loss.span.contains(time) && encoder_.is_sensor_frame(frame) && chance(random_) < loss.rate);
    (lost ? frames_lost_ : frames_sent_) += 1;
    if (!lost) frames_.push_back(frame);
  }
  return {frames_, messages};
}

}  // namespace stillcut
