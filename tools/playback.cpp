#include "tools/playback.hpp"

#include <chrono>

#include "tools/output_comparison.hpp"
#include "tools/predictor.hpp"
#include "tools/progress.hpp"
#include "tools/recorded_frames.hpp"
#include "tools/robot_playback.hpp"

namespace stillcut {
namespace {

constexpr double kBytesOfPlayedFrame = 150.0;  // about; for the bar only

// The robot's side, where decisions are asked for.
struct PlayedRobot {
  PlayedRobot(const Cell& cell, const PlaybackFiles& files, double offset_s)
      : predictor{cell}, playback{files.lcm, offset_s, predictor} {}

  Predictor predictor;
  RobotPlayback playback;
};

}  // namespace

PlaybackSummary play(const Cell& cell, const PlaybackSource& source, bool decide, double until_s,
                     const PlaybackListener& listener) {
  Pipeline pipeline{cell};
  Core& core = pipeline.core();
  const PlaybackFiles files = playback_files(source.can, source.lcm);
  RecordedFrames log{files.can};
  PlaybackSummary summary;
  summary.from_the_start = files.from_the_start;
  if (!files.note.empty()) summary.warnings.push_back(files.note);

  std::optional<PlayedRobot> robot;
  if (decide) {
    robot.emplace(cell, files, source.lcm_offset_s);
    if (listener.on_robot) robot->playback.set_listener(listener.on_robot);
    const NominalPrediction prediction = robot->predictor.nominal();
    if (!prediction.warning.empty()) summary.warnings.push_back(prediction.warning);
    if (!cell.measures) core.add_lobes(prediction.diagram);  // as the daemon
  }
  OutputComparison comparison;
  const auto take_outputs = [&] {
    for (const Output& output : core.outputs()) {
      if (robot) comparison.add(output, robot->playback);
      if (decide && listener.on_output) listener.on_output(output, core);
    }
    core.clear_outputs();
  };

  Progress progress{"playing"};
  const auto started = std::chrono::steady_clock::now();
  std::int64_t last_ns = 0;
  bool to_the_end = true;
  CanFrame frame;
  while (log.next(frame)) {
    if (frame.stamp_ns >= last_ns) {
      if (last_ns != 0 && static_cast<double>(frame.stamp_ns - core.origin_ns()) * 1e-9 > until_s) {
        to_the_end = false;
        break;
      }
      last_ns = frame.stamp_ns;
      if (robot) robot->playback.feed_until(last_ns, core, take_outputs);
      core.advance(last_ns);  // what fell due before this frame is told before it
      take_outputs();
    }
    const bool heard = pipeline.feed(frame);
    if (heard && listener.on_frame) listener.on_frame(pipeline);
    take_outputs();
    if ((log.frames() & 0x3FF) == 0)
      progress.update(static_cast<double>(log.frames()) * kBytesOfPlayedFrame / log.bytes());
  }
  if (robot && to_the_end) robot->playback.finish(core, take_outputs);
  take_outputs();

  summary.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  summary.origin_ns = core.origin_ns();
  summary.played_s = static_cast<double>(last_ns - core.origin_ns()) * 1e-9;
  summary.frames = log.frames();
  summary.frames_bad = log.frames_bad() + pipeline.decoder().counters().frames_bad;
  summary.frames_lost = core.counters().frames_lost;
  summary.frames_out_of_order = core.counters().frames_out_of_order;
  if (const std::string warning = log.warning(); !warning.empty()) summary.warnings.push_back(warning);
  if (!robot) return summary;
  const RobotPlayback& played = robot->playback;
  summary.is_recording = played.is_recording();
  summary.inputs_lost = played.lost();
  summary.outputs_recorded = played.published().size();
  summary.outputs_decided = comparison.count();
  summary.outputs_same = comparison.same_as(played.published());
  summary.loop_times = played.loop_times();
  if (played.bad() > 0)
    summary.warnings.push_back(files.lcm.front().string() + ": " + std::to_string(played.bad()) +
                               " bad messages passed over");
  for (std::string& line : comparison.warnings(played, files.from_the_start))
    summary.warnings.push_back(std::move(line));
  return summary;
}

}  // namespace stillcut
