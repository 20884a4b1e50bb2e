#include "models/floor_heights.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "dsp/numbers.hpp"
#include "models/surface_sweep.hpp"

namespace stillcut {
namespace {

constexpr double kFeedChange = 0.5;             // relative to its mean
constexpr double kFarthestBeside = 1.0 / 40.0;  // of the diameter
constexpr double kFarthestEdge = 1e-3;          // m: from so far away no edge of a ball still cuts the floor

using Marks = std::vector<TrackMark>;

Marks::const_iterator first_from(const Marks& marks, double along) {
  return std::partition_point(marks.begin(), marks.end(), [&](const TrackMark& mark) { return mark.along < along; });
}

struct Moment {
  double time, angle;  // s, rad
};

// When the tool passed a place between two marks.
Moment moment_at(const CutTrack& track, double along) {
  const auto after = first_from(track.marks, along), before = after == track.marks.begin() ? after : after - 1;
  const double way = after->along - before->along, share = way > 0.0 ? (along - before->along) / way : 0.0;
  return {track.step * std::lerp(static_cast<double>(before->sample), static_cast<double>(after->sample), share),
          std::lerp(before->angle, after->angle, share)};
}

// In the part all the way, and at a feed that hardly changed.
bool cut_steadily(std::span<const TrackMark> marks, double feed_rate) {
  return std::all_of(marks.begin(), marks.end(), [&](const TrackMark& mark) {
    return mark.axial_depth > 0.0 && std::abs(mark.feed_rate - feed_rate) <= kFeedChange * feed_rate;
  });
}

// The tool's motion over some time, as far as it is known, about its mean: pushed aside as a whole it leaves the same
// floor elsewhere, and the sweep looks less far.
struct Motion {
  Displacement displacement;
  double mean_height = 0.0;  // m
};

Motion motion_over(const CutTrack& track, double begin, double end) {
  const auto last = static_cast<double>(track.displacement.size() - 1);
  const auto first_sample = static_cast<std::size_t>(std::clamp(std::floor(begin / track.step), 0.0, last));
  const auto last_sample = static_cast<std::size_t>(std::clamp(std::ceil(end / track.step), 0.0, last));
  const auto from = track.displacement.begin();
  std::vector<Eigen::Vector3f> samples(from + static_cast<std::ptrdiff_t>(first_sample),
                                       from + static_cast<std::ptrdiff_t>(last_sample) + 1);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& sample : samples) sum += sample.cast<double>();
  const Eigen::Vector3d mean = sum / static_cast<double>(samples.size());
  for (Eigen::Vector3f& sample : samples) sample = (sample.cast<double>() - mean).cast<float>();
  return {sampled_displacement(track.step * static_cast<double>(first_sample), track.step, std::move(samples)),
          mean.z()};
}

}  // namespace

std::vector<double> floor_heights(const Tool& tool, const Cut& cut, const CutTrack& track, double from, double spacing,
                                  std::size_t count) {
  std::vector<double> unknown(count, kNaN);
  const double length = spacing * static_cast<double>(count - 1), to = from + length;
  if (track.marks.empty() || from < track.marks.front().along || to > track.marks.back().along) return unknown;
  const Moment begin = moment_at(track, from), middle = moment_at(track, from + 0.5 * length),
               end = moment_at(track, to);
  Cut here = cut;
  here.spindle_speed = (end.angle - begin.angle) / (end.time - begin.time);
  const double feed_rate = length / (end.time - begin.time);
  here.feed_per_tooth = feed_rate * kTwoPi / (here.spindle_speed * tool.teeth);
  const auto first = first_from(track.marks, from), last = first_from(track.marks, to);
  if (!cut_steadily({first, last}, feed_rate)) return unknown;
  const TrackMark& mark = *first_from(track.marks, from + 0.5 * length);
  here.feed_direction = mark.feed_direction;
  here.axial_depth = mark.axial_depth;
  const double beside = std::min(0.25 * step_over_of(cut), kFarthestBeside * tool.diameter);
  here.step_over = 4.0 * beside;

  const double to_margin = (0.5 * length + kFarthestEdge) / feed_rate;  // s from the middle
  Motion motion = motion_over(track, middle.time - to_margin, middle.time + to_margin);
  const CutterMotion cutter = cutter_motion(tool, here, std::move(motion.displacement));
  const double run_in =
      std::min(kFarthestEdge, swept_heights(cutter, here).reach + kTwoPi * feed_rate / here.spindle_speed);
  const double to_middle = (0.5 * length + run_in) / feed_rate;  // s from where the pass begins
  const CutterPass pass{.begin = -run_in,
                        .length = length + 2.0 * run_in,
                        .across = -beside,
                        .angle = std::remainder(middle.angle - here.spindle_speed * to_middle, kTwoPi),
                        .time = middle.time - to_middle};
  HeightMap line{.along = count, .across = 1, .spacing_along = spacing, .spacing_across = spacing, .heights = unknown};
  (void)SurfaceSweep(cutter, here, spacing, spacing, true).sweep(line, {0, count, 0, 1}, {&pass, 1});
  for (double& height : line.heights) height = -(height + motion.mean_height);
  return line.heights;
}

}  // namespace stillcut
