#include "tools/compare_runs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <stdexcept>

#include "models/lobes.hpp"
#include "models/modal_refit.hpp"
#include "tools/cell_posture.hpp"

namespace stillcut {
namespace {

constexpr int kMomentsLooked = 60;                        // of the program, for its depth limit
constexpr double kBelowLimit = 0.9;                       // of the depth limit
constexpr double kNearlyDeepest = 0.95, kAtTheEnd = 1.0;  // of the deepest; s
constexpr double kBeforeExit = 0.1;                       // s: nothing of the exit yet

// The schedule, nowhere above `most`: with a point where it crosses that.
Schedule capped(const Schedule& schedule, double most) {
  Schedule result;
  for (std::size_t i = 0; i < schedule.size(); ++i) {
    if (i > 0 && (schedule[i - 1].value - most) * (schedule[i].value - most) < 0.0) {
      const auto& [t0, v0] = schedule[i - 1];
      const auto& [t1, v1] = schedule[i];
      if (t1 > t0) result.push_back({std::lerp(t0, t1, (most - v0) / (v1 - v0)), most});
    }
    result.push_back({schedule[i].time, std::min(schedule[i].value, most)});
  }
  return result;
}

// But for the depth.
bool same_cut(const RobotState& a, const RobotState& b) {
  return a.joint_position == b.joint_position && a.tcp_position == b.tcp_position &&
         a.feed_direction == b.feed_direction && a.spindle_speed_rpm == b.spindle_speed_rpm &&
         a.radial_depth == b.radial_depth;
}

// Depth limit of what is programmed at a moment, m; 0: unsound at every depth.
double limit_of(const Cell& cell, const CellDynamics& dynamics, Cut cut, const RobotState& program) {
  Posture posture;
  posture.joints = program.joint_position;
  posture.position = program.tcp_position;
  const PredictedPosture predicted = with_few_modes(predict_posture(dynamics.map, posture, dynamics.interpolation));
  cut.feed_direction = program.feed_direction;
  cut.radial_depth = program.radial_depth;
  const std::array<double, 1> speed{rpm_to_rad_s(program.spindle_speed_rpm)};
  const double limit = depth_limits(*cell.tool, *cell.material, cut, predicted.posture.modes, speed, {}).front().depth;
  return std::isnan(limit) ? 0.0 : limit;
}

// When the middle of each sampling length was cut, and R_a of those of the last second.
void place_in_time(ComparedRun& run) {
  const auto& moments = run.machine->moments();
  double deepest = 0.0, last_full = 0.0;
  for (const MachineMoment& moment : moments) deepest = std::max(deepest, moment.axial_depth);
  for (const MachineMoment& moment : moments)
    if (moment.axial_depth >= kNearlyDeepest * deepest) last_full = moment.time;
  double way = 0.0;
  auto length = run.score.lengths.begin();
  std::vector<ProfileRoughness> at_end;
  for (std::size_t i = 1; i < moments.size() && length != run.score.lengths.end(); ++i) {
    way += moments[i].feed_rate * (moments[i].time - moments[i - 1].time);
    if (way < length->from + 0.5 * kSamplingLength) continue;
    run.surface_time.push_back(moments[i].time);
    const double before_end = last_full - kBeforeExit - moments[i].time;
    if (length->roughness && before_end >= 0.0 && before_end <= kAtTheEnd) at_end.push_back(*length->roughness);
    ++length;
  }
  run.ra_at_end = mean_of(at_end).ra;
}

ComparedRun run_once(std::string name, Cell cell, RuntimeMode mode, const Scenario& scenario, std::int64_t origin_ns,
                     const std::function<void(double)>& progress) {
  cell.mode = mode;
  ComparedRun run{std::move(name), std::make_unique<VirtualMachine>(cell, scenario, origin_ns), {}, {}, {}};
  run.heard = run_in_data_time(cell, *run.machine, progress);
  run.score = score_run(*run.machine, run.heard.events);
  place_in_time(run);
  return run;
}

}  // namespace

double sound_depth(const Cell& cell, const Scenario& scenario) {
  const CellDynamics dynamics = read_cell_dynamics(cell);
  const VirtualMachine machine{cell, scenario, 0};
  Cut cut = require(cell, cell.cut, "cut");
  if (scenario.milling) cut.milling = *scenario.milling;
  double least = std::numeric_limits<double>::infinity();
  std::optional<RobotState> before;
  for (int i = 0; i <= kMomentsLooked; ++i) {
    const RobotState program = machine.program_at(scenario.duration * i / kMomentsLooked);
    if (!(program.axial_depth > 0.0) || (before && same_cut(*before, program))) continue;
    before = program;
    try {
      least = std::min(least, limit_of(cell, dynamics, cut, program));
    } catch (const std::invalid_argument& error) {
      throw InputError(cell.file.string(), 0, std::string("no depth can be called sound: ") + error.what());
    }
  }
  return kBelowLimit * least;
}

std::vector<ComparedRun> compare_runs(const Cell& cell, const Scenario& scenario, std::int64_t origin_ns,
                                      const std::function<void(double)>& progress) {
  const double sound = sound_depth(cell, scenario);
  double deepest = scenario.axial_depth.empty() ? cell.cut->axial_depth : 0.0;
  for (const SchedulePoint& point : scenario.axial_depth) deepest = std::max(deepest, point.value);
  const bool shallower = sound > 0.0 && deepest > sound;
  const double share = shallower ? 1.0 / 3.0 : 0.5;
  std::vector<ComparedRun> runs;
  const auto part = [&](double done) { progress(share * (static_cast<double>(runs.size()) + done)); };
  runs.push_back(run_once("not corrected", cell, RuntimeMode::shadow, scenario, origin_ns, part));
  runs.push_back(run_once("corrected", cell, RuntimeMode::active, scenario, origin_ns, part));
  if (!shallower) return runs;
  Scenario shallow = scenario;
  shallow.axial_depth = scenario.axial_depth.empty() ? Schedule{{0.0, sound}} : capped(scenario.axial_depth, sound);
  runs.push_back(run_once("at a sound depth", cell, RuntimeMode::shadow, shallow, origin_ns, part));
  return runs;
}

void print_comparison(const std::vector<ComparedRun>& runs) {
  const std::string ra = std::string(runs.front().machine->surface().name()) + " R_a";
  std::printf("  %-17s %9s %9s %10s %13s %16s\n", "", "chatter", "peak", ra.c_str(), "R_a, last s", "metal removed");
  for (const ComparedRun& run : runs) {
    const HilScore& score = run.score;
    std::printf("  %-17s %7.2f s %6.0f µm %7.2f µm %10.2f µm %9.0f mm³/min%s\n", run.name.c_str(), score.chatter_s,
                score.peak_displacement_um, score.roughness ? 1e6 * score.roughness->ra : kNaN, 1e6 * run.ra_at_end,
                score.removed_mm3_per_min.value_or(0.0), score.stopped ? ", stopped on request" : "");
  }
}

}  // namespace stillcut
