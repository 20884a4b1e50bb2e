#include "tools/heard_chatter.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/files/csv.hpp"
#include "models/median.hpp"
#include "tools/cell_posture.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kListenToChatter_ns = 300'000'000;
constexpr std::size_t kLeastHops = 10;  // views with a frequency
constexpr double kSteadySpeed = 0.003;  // relative
// Relative, half of the views within it: where the cut changes, its immersion say, the frequency wanders.
constexpr double kStandingFrequency = 0.003;

Posture own_posture(const Cell& cell) { return posture_of(cell, read_cell_dynamics(cell).map); }

}  // namespace

ChatterCollector::ChatterCollector(const Cell& cell, Posture posture)
    : nominal_{require(cell, cell.cut, "cut")}, posture_{std::move(posture)} {}

void ChatterCollector::look(const MonitorView& view, const RobotState* robot, std::int64_t origin_ns) {
  if (view.stamp_ns == last_ns_) return;
  last_ns_ = view.stamp_ns;
  if (!view.chatter) {
    close();
    in_episode_ = false;
    return;
  }
  const bool tells = view.kind == ChatterKind::regenerative && view.single_line && view.chatter_frequency_hz > 0.0;
  if (!in_episode_ && tells) {
    in_episode_ = listening_ = true;
    begin_ns_ = view.stamp_ns;
    open_ = {static_cast<double>(view.stamp_ns - origin_ns) * 1e-9, {view.speed, 0.0, 0.0}, nominal_, posture_};
  }
  if (!listening_) return;
  const bool steady = std::abs(view.speed - open_.heard.spindle_speed) <= kSteadySpeed * open_.heard.spindle_speed;
  if (!tells || !steady || view.stamp_ns - begin_ns_ > kListenToChatter_ns) return close();
  frequencies_.push_back(view.chatter_frequency_hz);
  if (robot == nullptr) return;
  open_.cut.feed_direction = robot->feed_direction;
  if (robot->milling != Milling::unknown) open_.cut.milling = robot->milling;
  if (std::isfinite(robot->radial_depth)) open_.cut.radial_depth = robot->radial_depth;
  if (std::isfinite(robot->axial_depth)) open_.cut.axial_depth = robot->axial_depth;
  open_.posture.joints = robot->joint_position;
  open_.posture.position = robot->tcp_position;
}

void ChatterCollector::close() {
  if (listening_ && frequencies_.size() >= kLeastHops) {
    const double hz = median(frequencies_);
    for (double& frequency : frequencies_) frequency = std::abs(frequency - hz);
    if (median(frequencies_) <= kStandingFrequency * hz) {
      open_.heard.frequency = kTwoPi * hz;
      open_.heard.axial_depth = open_.cut.axial_depth;
      cuts_.push_back(open_);
    }
  }
  frequencies_.clear();
  listening_ = false;
}

std::vector<ChatteredCut> ChatterCollector::finish() {
  close();
  return std::move(cuts_);
}

std::vector<ChatteredCut> chattered_in_log(const Cell& cell, const PlaybackSource& source,
                                           std::vector<std::string>& warnings) {
  ChatterCollector collector{cell, own_posture(cell)};
  const PlaybackSummary played = play(cell, source, true, kInfinity,
                                      {.on_frame =
                                           [&](const Pipeline& pipeline) {
                                             const Core& core = pipeline.core();
                                             collector.look(core.view(), core.robot(), core.origin_ns());
                                           },
                                       .on_output = {},
                                       .on_robot = {}});
  warnings.insert(warnings.end(), played.warnings.begin(), played.warnings.end());
  return collector.finish();
}

std::vector<ChatteredCut> chattered_in_events(const Cell& cell, const std::filesystem::path& file) {
  const CsvTable table = read_csv(file);
  const auto time = table.require_column("time_s"), event = table.require_column("event"),
             kind = table.require_column("kind"), frequency = table.require_column("frequency_hz"),
             speed = table.require_column("spindle_speed_rpm");
  const Cut& cut = require(cell, cell.cut, "cut");
  const Posture posture = own_posture(cell);
  std::vector<ChatteredCut> cuts;
  for (const CsvRow& row : table.rows()) {
    if (table.text(row, event) != "chatter_onset" || table.text(row, kind) != "regenerative") continue;
    const double hz = table.number(row, frequency), rpm = table.number(row, speed);
    if (!(hz > 0.0)) table.fail(row, frequency, "must be above 0");
    if (!(rpm > 0.0)) table.fail(row, speed, "must be above 0");
    cuts.push_back({table.number(row, time), {rpm_to_rad_s(rpm), cut.axial_depth, kTwoPi * hz}, cut, posture});
  }
  return cuts;
}

}  // namespace stillcut
