// The simulated machine by itself: what its sensors send under each fault, and that what it is told happens.
#include "tools/virtual_machine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <optional>

#include "drivers/can/decoder.hpp"
#include "tests/tools/run_program.hpp"
#include "tools/cell_posture.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kMachineOrigin = 1'600'000'000'000'000'000;

Cell machine_cell(const std::string& name = "demo-cell") {
  return read_cell(EXAMPLES "/" + name + "/cell.toml", {.bus = false});
}

std::vector<Mode> modes_of(const Cell& cell) { return predicted_posture(cell, read_cell_dynamics(cell)).posture.modes; }

Scenario sound_cut(double duration) {
  Scenario scenario;
  scenario.file = "test.toml";
  scenario.duration = duration;
  scenario.axial_depth = {{0.0, 1.5e-3}};
  return scenario;
}

struct Sent {
  std::vector<SampleBlock> blocks;
  std::vector<double> rpm;
  std::int64_t lost = 0;
};

Sent run_machine(const Cell& cell, VirtualMachine& machine) {
  Decoder decoder{read_dbc(cell.can->dbc), *cell.can, cell.file.string()};
  Sent sent;
  Decoded decoded;
  while (!machine.ended()) {
    for (const CanFrame& frame : machine.advance().frames) {
      if (!decoder.decode(frame, decoded)) continue;
      for (int b = 0; b < decoded.blocks; ++b) {
        sent.blocks.push_back(decoded.block[b]);
        sent.lost += decoded.block[b].frames_lost;
      }
      if (decoded.has_speed) sent.rpm.push_back(rad_s_to_rpm(decoded.spindle.speed));
    }
  }
  return sent;
}

Sent run_scenario(const Scenario& scenario) {
  const Cell cell = machine_cell();
  VirtualMachine machine{cell, scenario, kMachineOrigin};
  return run_machine(cell, machine);
}

// The samples of one axis between two times.
std::vector<float> samples_in(const Sent& sent, int axis, double from, double to) {
  std::vector<float> samples;
  for (const SampleBlock& block : sent.blocks) {
    const double time = static_cast<double>(block.stamp_ns - kMachineOrigin) * 1e-9;
    if (time < from + 0.001 || time > to - 0.001) continue;
    const auto& values = block.acceleration[static_cast<std::size_t>(axis)];
    samples.insert(samples.end(), values.begin(), values.begin() + block.samples);
  }
  return samples;
}

double rms_of(const std::vector<float>& samples) {
  double sum = 0.0;
  for (const float x : samples) sum += double{x} * x;
  return std::sqrt(sum / static_cast<double>(samples.size()));
}

TEST(VirtualMachine, CountsEveryFrameThatIsLostAndTheMonitorCanToo) {
  Scenario scenario = sound_cut(1.0);
  scenario.losses = {{{0.2, 0.8}, 0.05}};
  const Cell cell = machine_cell();
  VirtualMachine machine{cell, scenario, kMachineOrigin};
  const Sent sent = run_machine(cell, machine);
  EXPECT_NEAR(static_cast<double>(machine.frames_lost()), 0.6 * 2560 * 0.05, 30.0);
  EXPECT_EQ(sent.lost, machine.frames_lost());
  EXPECT_EQ(machine.frames_sent(), static_cast<std::int64_t>(sent.blocks.size() + sent.rpm.size()));
  EXPECT_EQ(sent.rpm.size(), 51U);  // the drive's frames are not lost
}

TEST(VirtualMachine, SensorFaultsShowInTheFramesWhileTheyLast) {
  const auto with = [](SensorFaultKind kind, int axis, double offset = 0.0) {
    Scenario scenario = sound_cut(0.5);
    scenario.sensor_faults = {{{0.2, 0.4}, kind, axis, offset, 0}};
    return run_scenario(scenario);
  };
  const Sent healthy = run_scenario(sound_cut(0.5));
  const double normal = rms_of(samples_in(healthy, 0, 0.2, 0.4));
  EXPECT_GT(normal, 5.0);

  const auto stuck = samples_in(with(SensorFaultKind::stuck, 0), 0, 0.2, 0.4);
  EXPECT_TRUE(std::all_of(stuck.begin(), stuck.end(), [&](float x) { return x == stuck.front(); }));

  const Sent saturated = with(SensorFaultKind::saturated, -1);
  EXPECT_GT(samples_in(saturated, 0, 0.2, 0.4).front(), 1900.0F);
  EXPECT_GT(samples_in(saturated, 1, 0.2, 0.4).back(), 1900.0F);
  EXPECT_LT(rms_of(samples_in(saturated, 0, 0.4, 0.5)), 3.0 * normal);  // well again

  const auto offset = samples_in(with(SensorFaultKind::offset, 1, 300.0), 1, 0.2, 0.4);
  double mean = 0.0;
  for (const float x : offset) mean += x / static_cast<double>(offset.size());
  EXPECT_NEAR(mean, 300.0, 5.0);

  EXPECT_EQ(rms_of(samples_in(with(SensorFaultKind::dead, 0), 0, 0.2, 0.4)), 0.0);
  EXPECT_GT(rms_of(samples_in(with(SensorFaultKind::dead, 0), 1, 0.2, 0.4)), 1.0);  // the other axis is well

  const Sent silent = with(SensorFaultKind::silent, -1);
  EXPECT_TRUE(samples_in(silent, 0, 0.2, 0.4).empty());
  EXPECT_EQ(silent.lost, 0);  // it did not count either
}

TEST(VirtualMachine, RefusesNotANumberFromASensorOfWholeNumbers) {
  Scenario scenario = sound_cut(0.5);
  scenario.sensor_faults = {{{0.2, 0.4}, SensorFaultKind::nan, 0, 0.0, 12}};
  EXPECT_THROW((VirtualMachine{machine_cell(), scenario, kMachineOrigin}), InputError);
}

TEST(VirtualMachine, RefusesToMoveOnAMapThatLacksModes) {
  const TempFolder folder;
  std::filesystem::copy(EXAMPLES "/demo-cell", folder.path(), std::filesystem::copy_options::recursive);
  std::string modes = content_of(folder.path() / "map/modes.csv");
  modes.erase(modes.find("far,3"), modes.find("far,4") - modes.find("far,3"));
  (void)folder.write("map/modes.csv", modes);
  Scenario scenario = sound_cut(0.5);
  scenario.moves = {{{0.1, 0.2}, "left"}};
  const Cell cell = read_cell(folder.path() / "cell.toml", {.bus = false});
  EXPECT_NE(message_of<InputError>([&] {
              VirtualMachine{cell, scenario, kMachineOrigin};
            }).find("same modes"),
            std::string::npos);
}

TEST(VirtualMachine, AKnockMovesTheToolAsItsImpulseSays) {
  // In the air, all modes start with velocity impulse/mass: v = J sum(u u^T / m).
  Scenario scenario = sound_cut(0.02);
  scenario.axial_depth = {{0.0, 0.0}};
  scenario.knocks = {{0.01, {0.1, 0.0, 0.0}}};
  const Cell cell = machine_cell();
  VirtualMachine machine{cell, scenario, kMachineOrigin};
  while (machine.time() + 1.0 / machine.sample_rate_hz() < 0.01) machine.advance();
  EXPECT_EQ(machine.state().displacement.norm(), 0.0);
  double fastest = 0.0, expected = 0.0;
  for (const Mode& mode : modes_of(cell))
    expected +=
        0.1 * mode.direction[0] * mode.direction[0] * mode.natural_frequency * mode.natural_frequency / mode.stiffness;
  for (int i = 0; i < 3; ++i) {
    machine.advance();
    fastest = std::max(fastest, machine.state().velocity.x());
  }
  EXPECT_NEAR(fastest, expected, 0.05 * expected);
}

TEST(VirtualMachine, AnswersAnOutsideForceWithItsReceptance) {
  Scenario scenario = sound_cut(1.5);
  scenario.axial_depth = {{0.0, 0.0}};
  scenario.forces = {{{0.0, 1.5}, 300.0, {10.0, 0.0, 0.0}}};
  const Cell cell = machine_cell();
  VirtualMachine machine{cell, scenario, kMachineOrigin};
  double peak = 0.0;
  while (!machine.ended()) {
    machine.advance();
    if (machine.time() > 1.4) peak = std::max(peak, std::abs(machine.state().displacement.x()));
  }
  std::complex<double> receptance = 0.0;
  for (const Mode& mode : modes_of(cell)) {
    const double r = kTwoPi * 300.0 / mode.natural_frequency;
    receptance += mode.direction[0] * mode.direction[0] /
                  (mode.stiffness * std::complex<double>(1.0 - r * r, 2.0 * mode.damping_ratio * r));
  }
  EXPECT_NEAR(peak, 10.0 * std::abs(receptance), 0.05 * 10.0 * std::abs(receptance));
}

TEST(VirtualMachine, MovesItsModesWithThePostureWithoutAJump) {
  Scenario scenario = sound_cut(1.0);
  scenario.axial_depth = {{0.0, 0.5e-3}};
  scenario.spindle_speed = {{0.0, rpm_to_rad_s(4200)}};
  scenario.moves = {{{0.3, 0.8}, "left"}};
  const Cell cell = machine_cell("robot-cell");
  VirtualMachine machine{cell, scenario, kMachineOrigin};
  double largest = 0.0;
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  RobotState last;
  while (!machine.ended()) {
    for (const ControllerMessage& said : machine.advance().messages)
      if (const auto* state = std::get_if<RobotState>(&said.message)) last = *state;
    largest = std::max(largest, (machine.state().displacement - before).norm());
    before = machine.state().displacement;
  }
  EXPECT_LT(largest, 5e-6);  // a sample is 39 us
  EXPECT_NEAR(last.joint_position[0], deg_to_rad(30), 1e-9);
  EXPECT_NEAR(last.tcp_position[1], 0.55, 1e-9);
}

TEST(VirtualMachine, SpindleLagsBehindTheProgram) {
  Scenario scenario = sound_cut(0.2);
  scenario.spindle_speed = {{0.0, rpm_to_rad_s(8500)}, {0.1, rpm_to_rad_s(9000)}};
  const Sent sent = run_scenario(scenario);
  EXPECT_NEAR(sent.rpm.front(), 8500, 0.2);
  EXPECT_GT(sent.rpm.back(), 8550);
  EXPECT_LT(sent.rpm.back(), 8900);
}

// The machine with one correction after the other from given times on, until the end.
template <class Look>
void run_corrected(VirtualMachine& machine, const std::function<std::optional<Correction>(double)>& ask,
                   const Look& look) {
  std::int64_t sequence = 0;
  while (!machine.ended()) {
    if (++sequence % 1000 == 0)
      if (std::optional<Correction> c = ask(machine.time())) {
        c->sequence = sequence;
        c->valid_for_ms = 500;
        c->mode = RuntimeMode::active;
        machine.receive(*c);
      }
    machine.advance();
    look();
  }
}

TEST(VirtualMachine, AStopEndsTheCutWithoutChatterAndHoldsTheProgram) {
  Scenario scenario = sound_cut(2.5);
  scenario.axial_depth = {{0.0, 1.5e-3}, {1.5, 1.5e-3}, {1.5, 0.0}};
  VirtualMachine machine{machine_cell(), scenario, kMachineOrigin};
  Correction stop;
  stop.kind = CorrectionKind::stop_request;
  stop.feed_override = 0.0;
  double late_chip = 0.0, early_chip = 0.0;
  run_corrected(
      machine, [&](double time) { return time > 0.5 && time < 0.6 ? std::optional{stop} : std::nullopt; },
      [&] {
        double& chip = machine.time() < 0.5 ? early_chip : late_chip;
        if (machine.time() < 0.5 || machine.time() > 1.2) chip = std::max(chip, machine.state().chip);
      });
  EXPECT_TRUE(machine.controller().stopped());
  EXPECT_LT(late_chip, 0.05 * early_chip);  // a tooth that is not fed rubs: its edge still presses
  EXPECT_EQ(machine.moments().back().feed_rate, 0.0);
  EXPECT_NEAR(machine.moments().back().axial_depth, 1.5e-3, 1e-12);  // the program would have left the part
  EXPECT_TRUE(machine.truth().spells().empty());
  EXPECT_LT(machine.state().displacement.norm(), 1e-6);
}

TEST(VirtualMachine, TheFeedTurnsInAStableCutWithoutChatter) {
  VirtualMachine machine{machine_cell(), sound_cut(3.0), kMachineOrigin};
  Correction turn;
  turn.kind = CorrectionKind::feed_direction;
  turn.feed_direction = deg_to_rad(45);
  double furthest = 0.0;
  run_corrected(
      machine, [&](double time) { return time > 0.5 && time < 1.5 ? std::optional{turn} : std::nullopt; },
      [&] { furthest = std::max(furthest, machine.moments().back().feed_direction); });
  EXPECT_NEAR(furthest, deg_to_rad(45), 1e-9);
  EXPECT_NEAR(machine.moments().back().feed_direction, 0.0, 1e-9);
  EXPECT_TRUE(machine.truth().spells().empty());
}

TEST(VirtualMachine, RemovesDepthTimesWidthTimesTheWayOfTheFeed) {
  Scenario scenario = sound_cut(2.0);
  scenario.axial_depth = {{0.0, 1.5e-3}, {1.0, 1.5e-3}, {1.0, 0.0}};
  const Cell cell = machine_cell();
  VirtualMachine machine{cell, scenario, kMachineOrigin};
  Correction half;
  half.kind = CorrectionKind::feed_override;
  half.feed_override = 0.5;
  run_corrected(
      machine, [&](double time) { return time > 0.4 ? std::optional{half} : std::nullopt; }, [] {});
  const double feed = cell.cut->feed_per_tooth * cell.tool->teeth * cell.cut->spindle_speed / kTwoPi;
  const double whole = 1.5e-3 * cell.cut->radial_depth * feed * machine.cutting_time();
  EXPECT_NEAR(machine.cutting_time(), 1.0, 1e-3);
  EXPECT_GT(machine.removed_volume(), 0.70 * whole);  // whole to 0.42 s or so, half from 0.53 s on
  EXPECT_LT(machine.removed_volume(), 0.77 * whole);
}

}  // namespace
}  // namespace stillcut
