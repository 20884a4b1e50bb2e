#include "tools/report_collector.hpp"

#include <algorithm>
#include <cmath>

namespace stillcut {
namespace {

constexpr double kLevel_s = 0.05;
constexpr double kOffset_s = 0.1;  // what is slower than some 1.6 Hz is no vibration
constexpr int kAfterLevels = 10;
constexpr std::size_t kMostLobes = 48;

// Lobes that a reader could not tell apart.
bool alike(const LobeDiagram& a, const LobeDiagram& b) {
  constexpr double kAlike = 0.03, kMayDiffer = 0.05;
  if (a.point_count != b.point_count) return false;
  int differ = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(a.point_count); ++i) {
    const double x = a.points[i].depth_limit, y = b.points[i].depth_limit;
    const bool same = std::isfinite(x) && std::isfinite(y)
                          ? std::abs(x - y) <= kAlike * std::max(x, y)
                          : std::isnan(x) == std::isnan(y) && std::isinf(x) == std::isinf(y);
    differ += same ? 0 : 1;
  }
  return differ <= kMayDiffer * a.point_count;
}

ReplayTrace blank_picture(const Cell& cell) {
  ReplayTrace blank;
  blank.sample_rate_hz = cell.can->accelerometers.front().sample_rate_hz;
  blank.teeth = cell.tool->teeth;
  blank.min_speed_rpm = rad_s_to_rpm(cell.spindle->min_speed);
  blank.max_speed_rpm = rad_s_to_rpm(cell.spindle->max_speed);
  return blank;
}

const std::vector<AccelerometerSettings>& sensors_of(const Cell& cell) {
  (void)core_settings(cell);  // says what is missing of the cell
  return cell.can->accelerometers;
}

std::string tool_text(const Tool& tool) {
  std::array<char, 120> text{};
  std::snprintf(text.data(), text.size(), "%s mill, %.4g mm, %d %s", tool.shape == ToolShape::ball ? "ball" : "end",
                tool.diameter * 1e3, tool.teeth, tool.teeth == 1 ? "tooth" : "teeth");
  return text.data();
}

}  // namespace

ReportCollector::ReportCollector(const Cell& cell, int most_pictures)
    : most_pictures_{most_pictures},
      window_{sensors_of(cell), -kInfinity, kInfinity},
      pictures_{blank_picture(cell),
                [this](int episode, ReplayTrace picture) { keep_picture(episode, std::move(picture)); }},
      spans_(cell.can->accelerometers.size()) {
  report_.cell = cell.file.string();
  report_.tool = tool_text(*cell.tool);
  report_.material = cell.material ? cell.material->name : "";
  report_.posture = cell.dynamics ? cell.dynamics->posture : "";
  report_.mode = cell.mode;
  report_.min_rpm = rad_s_to_rpm(cell.spindle->min_speed);
  report_.max_rpm = rad_s_to_rpm(cell.spindle->max_speed);
  nominal_depth_ = cell.cut->axial_depth;
  for (const AccelerometerSettings& sensor : cell.can->accelerometers)
    report_.sensors.push_back({.sample_rate_hz = sensor.sample_rate_hz});
}

PlaybackListener ReportCollector::listener() {
  PlaybackListener listener;
  listener.on_frame = [this](const Pipeline& pipeline) { hear_frame(pipeline); };
  listener.on_output = [this](const Output& output, const Core& core) { hear_output(output, core); };
  listener.on_robot = [this](const RobotMessage& message) { hear_robot(message); };
  return listener;
}

double ReportCollector::seconds(std::int64_t stamp_ns) const {
  return static_cast<double>(stamp_ns - origin_ns_) * 1e-9;
}

double ReportCollector::depth_mm(const Core& core) const {
  const RobotState* robot = core.robot();
  return 1e3 * (robot != nullptr && std::isfinite(robot->axial_depth) ? robot->axial_depth : nominal_depth_);
}

ReportCut* ReportCollector::open_cut() {
  return report_.cuts.empty() || !std::isnan(report_.cuts.back().end_s) ? nullptr : &report_.cuts.back();
}

void ReportCollector::hear_frame(const Pipeline& pipeline) {
  origin_ns_ = pipeline.core().origin_ns();
  const Decoded& decoded = pipeline.decoded();
  for (std::size_t b = 0; b < static_cast<std::size_t>(decoded.blocks); ++b)
    if (const auto stretch = window_.cut(decoded.block[b], origin_ns_)) hear_samples(decoded.block[b], *stretch);
  hear_view(pipeline.core());
}

void ReportCollector::hear_samples(const SampleBlock& block, const SampleStretch& stretch) {
  ReportSensor& sensor = report_.sensors[block.sensor];
  sensor.samples += stretch.samples;
  sensor.missing += stretch.missing;
  sensor.gaps += stretch.missing > 0 ? 1 : 0;
  sensor.longest_gap_s = std::max(sensor.longest_gap_s, static_cast<double>(stretch.missing) * stretch.step_s);
  for (int i = 0; i < block.samples; ++i) {
    bool full = false, no_number = false;
    for (std::size_t a = 0; a < kMaxAxes; ++a) {
      if ((block.axes_present >> a & 1U) == 0) continue;
      full = full || (block.full_scale[a] >> i & 1U) != 0;
      no_number = no_number || !std::isfinite(block.acceleration[a][static_cast<std::size_t>(i)]);
    }
    sensor.saturated += full ? 1 : 0;
    sensor.not_finite += no_number ? 1 : 0;
  }
  measure_rate(block, stretch);
  pictures_.add(stretch);
  if (block.sensor != 0) return;
  for (std::size_t i = 0; i < static_cast<std::size_t>(stretch.samples); ++i) {
    for (std::size_t a = 0; a < kMaxAxes; ++a) {
      if (stretch.axis[a].empty() || !std::isfinite(stretch.axis[a][i])) continue;
      const double value = stretch.axis[a][i];
      level_.offset[a] = level_.begun ? std::lerp(level_.offset[a], value, stretch.step_s / kOffset_s) : value;
      level_.square += (value - level_.offset[a]) * (value - level_.offset[a]);
    }
    level_.begun = true;
    ++level_.count;
  }
  if (static_cast<double>(level_.count) * stretch.step_s >= kLevel_s) end_level(seconds(block.stamp_ns));
}

// From the first frame to the last between leaps: what lies between is counted, missing samples too.
void ReportCollector::measure_rate(const SampleBlock& block, const SampleStretch& stretch) {
  constexpr double kLeap_s = 0.05;  // the count does not bridge it
  SensorSpan& span = spans_[block.sensor];
  span.block = block.samples;
  const bool leaps = static_cast<double>(stretch.missing) * stretch.step_s > kLeap_s || block.stamp_ns < span.last_ns;
  if (span.first_ns == 0 || leaps) {
    if (span.first_ns != 0) {
      span.counted_s += static_cast<double>(span.last_ns - span.first_ns) * 1e-9;
      span.counted_samples += static_cast<double>(span.samples);
    }
    span.first_ns = span.last_ns = block.stamp_ns;
    span.samples = 0;
    return;
  }
  span.samples += stretch.missing + stretch.samples;
  span.last_ns = block.stamp_ns;
}

void ReportCollector::end_level(double time_s) {
  newest_level_ = std::sqrt(level_.square / static_cast<double>(level_.count));
  level_.square = 0.0;
  level_.count = 0;
  timeline_.add({.begin_s = time_s, .level = newest_level_});
  for (const int episode : open_episodes_) {
    double& before = report_.episodes[static_cast<std::size_t>(episode)].level_before;
    before = std::fmax(before, newest_level_);
  }
  if (ReportCut* cut = open_cut()) cut->level = std::fmax(cut->level, newest_level_);
  for (After& after : after_) {
    if (!in_cut_) after.count = kAfterLevels;  // it left the cut: what follows tells nothing
    if (time_s < after.from_s || after.count >= kAfterLevels) continue;
    after.sum += newest_level_;
    if (++after.count == kAfterLevels)
      report_.episodes[static_cast<std::size_t>(after.episode)].level_after = after.sum / kAfterLevels;
  }
  std::erase_if(after_, [](const After& after) { return after.count >= kAfterLevels; });
}

void ReportCollector::hear_view(const Core& core) {
  const MonitorView& view = core.view();
  if (view.stamp_ns == last_view_ns_) return;
  const double now_s = seconds(view.stamp_ns), rpm = rad_s_to_rpm(view.speed);
  const double step_s =
      last_view_ns_ == 0 ? 0.0 : std::clamp(seconds(view.stamp_ns) - seconds(last_view_ns_), 0.0, 0.1);
  last_view_ns_ = view.stamp_ns;
  in_cut_ = view.state == State::cut;
  timeline_.add({now_s, view.state, view.indicator, rpm, rpm, kNaN});
  pictures_.add(TracePoint{now_s, view.indicator, rpm, view.state, view.chatter_frequency_hz, view.decay_per_s});
  for (const int open : open_episodes_) {
    ReportEpisode& episode = report_.episodes[static_cast<std::size_t>(open)];
    episode.indicator = std::fmax(episode.indicator, view.indicator);
  }
  if (open_episodes_.empty()) report_.indicator = std::fmax(report_.indicator, view.indicator);
  ReportCut* cut = open_cut();
  if (cut == nullptr) return;
  cut->indicator = std::fmax(cut->indicator, view.indicator);
  cut->chatter_s += open_episodes_.empty() ? 0.0 : step_s;
  cut_speed_sum_ += rpm * step_s;
  cut_speed_s_ += step_s;
  const double depth = depth_mm(core);
  const bool deeper = !(depth <= cut->depth_mm);
  cut->depth_mm = std::fmax(cut->depth_mm, depth);
  if (!deeper && now_s < next_lobes_s_) return;
  constexpr double kLookAtLobesEvery_s = 0.5;
  next_lobes_s_ = now_s + kLookAtLobesEvery_s;
  if (depth > 0.98 * cut->depth_mm && cut->episodes == 0) cut->diagram = lobes_in_use(core);
}

int ReportCollector::lobes_in_use(const Core& core) {
  const LobeDiagram* diagram = core.lobes();
  if (diagram == nullptr || diagram->point_count < 2) return -1;
  for (std::size_t i = 0; i < report_.lobes.size(); ++i)
    if (alike(report_.lobes[i].diagram, *diagram)) return static_cast<int>(i);
  if (report_.lobes.size() >= kMostLobes) return -1;
  report_.lobes.push_back({*diagram, seconds(core.view().stamp_ns)});
  return static_cast<int>(report_.lobes.size() - 1);
}

void ReportCollector::hear_output(const Output& output, const Core& core) {
  origin_ns_ = core.origin_ns();
  if (output.type == Output::Type::event) return hear_event(output.event, core);
  if (output.type == Output::Type::correction) return hear_correction(output.correction);
  const Status& status = output.status;
  const std::int64_t from_ns = last_status_ns_ == 0 ? origin_ns_ : last_status_ns_;
  last_status_ns_ = status.stamp_ns;
  report_.state_s.at(static_cast<std::size_t>(status.state)) += static_cast<double>(status.stamp_ns - from_ns) * 1e-9;
  timeline_.add({.begin_s = seconds(status.stamp_ns), .state = status.state});
  if (ReportCut* cut = open_cut()) cut->margin = std::fmin(cut->margin, status.margin);
}

Report ReportCollector::finish(const PlaybackSummary& played) {
  pictures_.finish();
  if (ReportCut* cut = open_cut()) cut->speed_rpm = cut_speed_s_ > 0.0 ? cut_speed_sum_ / cut_speed_s_ : kNaN;
  for (std::size_t s = 0; s < spans_.size(); ++s) {
    const SensorSpan& span = spans_[s];
    const double time_s = span.counted_s + static_cast<double>(span.last_ns - span.first_ns) * 1e-9;
    const double samples = span.counted_samples + static_cast<double>(span.samples);
    constexpr double kLeastToMeasure_s = 1.0, kJitter_s = 1e-3;  // of a frame's arrival, about
    if (time_s < kLeastToMeasure_s) continue;
    report_.sensors[s].measured_hz = samples / time_s;
    report_.sensors[s].measured_within_hz = report_.sensors[s].measured_hz * kJitter_s / time_s;
  }
  report_.timeline = timeline_.points();
  report_.timeline_step_s = timeline_.step_s();
  report_.origin_ns = played.origin_ns;
  report_.played_s = played.played_s;
  report_.frames = played.frames;
  report_.frames_bad = played.frames_bad;
  report_.frames_lost = played.frames_lost;
  report_.frames_out_of_order = played.frames_out_of_order;
  report_.inputs_lost = played.inputs_lost;
  report_.from_the_start = played.from_the_start;
  report_.warnings = played.warnings;
  report_.loop_times = played.loop_times;
  return std::move(report_);
}

}  // namespace stillcut
