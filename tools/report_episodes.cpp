// The part of the collector that follows events: cuts, episodes of chatter, corrections and their answers, faults.
#include <algorithm>
#include <cmath>

#include "tools/report_collector.hpp"

namespace stillcut {
namespace {

constexpr double kAfterFrom_s = 0.1;  // the spindle's and the tool's motion has died out
constexpr double kAtOnce_s = 1.0;     // chatter that comes back so soon had not ended
constexpr std::size_t kMostFaultKinds = 64;

}  // namespace

void ReportCollector::hear_event(const Event& event, const Core& core) {
  const double now_s = seconds(event.stamp_ns);
  pictures_.add(ReplayEvent{now_s, event.type, event.kind, event.frequency_hz, event.spindle_speed_rpm});
  switch (event.type) {
    case EventType::cut_entry:
      report_.cuts.push_back({.begin_s = now_s});
      cut_speed_sum_ = cut_speed_s_ = 0.0;
      break;
    case EventType::cut_exit:
      if (ReportCut* cut = open_cut()) {
        cut->end_s = now_s;
        cut->speed_rpm = cut_speed_s_ > 0.0 ? cut_speed_sum_ / cut_speed_s_ : event.spindle_speed_rpm;
      }
      break;
    case EventType::chatter_onset:
      begin_episode(event, core);
      break;
    case EventType::chatter_end:
      end_episode(event, core);
      break;
    case EventType::correction: {
      asked_ = {};
      if (report_.episodes.empty()) break;
      const std::size_t episode =
          open_episodes_.empty() ? report_.episodes.size() - 1 : static_cast<std::size_t>(open_episodes_.back());
      std::vector<ReportCorrection>& corrections = report_.episodes[episode].corrections;
      corrections.push_back({.time_s = now_s,
                             .note = event.note.data(),
                             .from_rpm = rad_s_to_rpm(core.view().speed),
                             .target_rpm = event.spindle_speed_rpm,
                             .refusal = {}});
      asked_ = {static_cast<int>(episode), corrections.size() - 1};
      break;
    }
    case EventType::fault:
      note_fault(event);
      break;
    case EventType::forced_vibration:
      ++report_.forced_vibrations;
      break;
  }
}

void ReportCollector::begin_episode(const Event& event, const Core& core) {
  for (const int open : open_episodes_) {  // its kind is told later
    ReportEpisode& episode = report_.episodes[static_cast<std::size_t>(open)];
    if (episode.kind != ChatterKind::unknown && episode.kind != event.kind) continue;
    episode.kind = event.kind;
    episode.frequency_hz = event.frequency_hz;
    return;
  }
  const int number = static_cast<int>(report_.episodes.size());
  ReportEpisode episode;
  episode.onset_s = seconds(event.stamp_ns);
  episode.onset_note = event.note.data();
  episode.kind = event.kind;
  episode.frequency_hz = event.frequency_hz;
  episode.indicator = event.indicator;
  episode.speed_rpm = event.spindle_speed_rpm;
  episode.depth_mm = depth_mm(core);
  episode.level_before = newest_level_;
  if (const LobeDiagram* lobes = core.lobes())
    episode.margin = margin_at(*lobes, rpm_to_rad_s(episode.speed_rpm), episode.depth_mm * 1e-3);
  episode.diagram = lobes_in_use(core);
  episode.asked_before = asked_.episode;
  if (ReportCut* cut = open_cut()) {
    ++cut->episodes;
    cut->diagram = episode.diagram;
    episode.cut = static_cast<int>(report_.cuts.size()) - 1;
    for (ReportEpisode& earlier : report_.episodes)
      if (earlier.cut == episode.cut && episode.onset_s - earlier.end_s < kAtOnce_s) earlier.again_s = episode.onset_s;
  }
  report_.episodes.push_back(std::move(episode));
  open_episodes_.push_back(number);
  pictures_.begin(number, report_.episodes.back().onset_s);
}

void ReportCollector::end_episode(const Event& event, const Core& core) {
  if (open_episodes_.empty()) return;
  auto open = std::find_if(open_episodes_.begin(), open_episodes_.end(), [&](int number) {
    return report_.episodes[static_cast<std::size_t>(number)].kind == event.kind;
  });
  if (open == open_episodes_.end()) open = open_episodes_.begin();
  const int number = *open;
  open_episodes_.erase(open);
  ReportEpisode& episode = report_.episodes[static_cast<std::size_t>(number)];
  episode.end_s = seconds(event.stamp_ns);
  episode.end_note = event.note.data();
  episode.end_speed_rpm = event.spindle_speed_rpm;
  episode.end_depth_mm = depth_mm(core);
  after_.push_back({number, episode.end_s + kAfterFrom_s});
  pictures_.end_chatter(number, episode.end_s);
}

// The messages that follow the event of a correction ask for it, until another event or its release.
void ReportCollector::hear_correction(const Correction& correction) {
  if (correction.kind == CorrectionKind::release) asked_ = {};
  if (asked_.episode < 0) return;
  ReportCorrection& asked = report_.episodes[static_cast<std::size_t>(asked_.episode)].corrections[asked_.correction];
  if (asked.first_sequence == 0) {
    asked.first_sequence = correction.sequence;
    asked.kind = correction.kind;
    asked.mode = correction.mode;
    asked.margin_before = correction.predicted_margin_before;
    asked.margin_after = correction.predicted_margin_after;
    asked.confidence_percent = correction.confidence_percent;
  }
  asked.last_sequence = correction.sequence;
}

void ReportCollector::hear_robot(const RobotMessage& message) {
  if (const auto* state = std::get_if<RobotState>(&message)) {
    report_.depth_from_robot = report_.depth_from_robot || std::isfinite(state->axial_depth);
    return;
  }
  const auto* ack = std::get_if<CorrectionAck>(&message);
  if (ack == nullptr) return;
  constexpr std::size_t kLookBack = 8;  // episodes: answers are given at once
  const std::size_t count = report_.episodes.size();
  for (std::size_t e = count > kLookBack ? count - kLookBack : 0; e < count; ++e) {
    for (ReportCorrection& correction : report_.episodes[e].corrections) {
      const bool its = correction.first_sequence != 0 && ack->sequence >= correction.first_sequence &&
                       ack->sequence <= correction.last_sequence;
      if (!its) continue;
      ++(ack->accepted ? correction.accepted : correction.refused);
      if (!ack->accepted) correction.refusal = ack->reason.data();
    }
  }
}

// Faults of one kind differ in numbers only.
void ReportCollector::note_fault(const Event& event) {
  std::string what = event.note.data();
  what.resize(std::min(what.size(), what.find_first_of(":;0123456789")));
  while (!what.empty() && what.back() == ' ') what.pop_back();
  const double now_s = seconds(event.stamp_ns);
  if (!fault_places_.contains(what) && fault_places_.size() >= kMostFaultKinds) what = "others";
  const auto [place, is_new] = fault_places_.try_emplace(what, report_.faults.size());
  if (is_new) report_.faults.push_back({what, 0, now_s, now_s});
  ReportFault& fault = report_.faults[place->second];
  ++fault.count;
  fault.last_s = now_s;
}

void ReportCollector::keep_picture(int episode, ReplayTrace picture) {
  report_.episodes[static_cast<std::size_t>(episode)].picture = std::move(picture);
  std::vector<ReportEpisode*> pictured;
  for (ReportEpisode& each : report_.episodes)
    if (each.picture) pictured.push_back(&each);
  if (std::ssize(pictured) <= most_pictures_) return;
  (*std::min_element(pictured.begin(), pictured.end(), [](const ReportEpisode* a, const ReportEpisode* b) {
    return a->indicator < b->indicator;
  }))->picture.reset();
}

}  // namespace stillcut
