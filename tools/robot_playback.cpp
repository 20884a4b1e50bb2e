#include "tools/robot_playback.hpp"

#include <charconv>
#include <limits>
#include <string_view>

#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

constexpr std::size_t kMostComputed = 64;  // diagrams kept, in case the same is asked again

bool is_recorded(const std::filesystem::path& log) {
  LcmLogReader reader{log};
  const auto first = reader.next_event();
  return first && first->channel == kRecordingChannel;
}

// Of "lost N", which a recorder writes after a hole; 0 for its other texts.
std::int64_t lost_in(const MessageBytes& text) {
  constexpr std::string_view kLost = "lost ";
  const std::string_view said{reinterpret_cast<const char*>(text.data()), text.size()};
  std::int64_t lost = 0;
  if (said.starts_with(kLost)) std::from_chars(said.data() + kLost.size(), said.data() + said.size(), lost);
  return lost;
}

}  // namespace

RobotPlayback::RobotPlayback(std::vector<std::filesystem::path> logs, double offset_s, Predictor& predictor)
    : predictor_{predictor}, offset_ns_{static_cast<std::int64_t>(offset_s * 1e9)}, logs_(logs.begin(), logs.end()) {
  if (logs_.empty()) return;
  is_recording_ = is_recorded(logs_.front());
  refill();
}

// Reads on to the next that goes into the core. What a crash left of a recording's last log may be nothing at all.
bool RobotPlayback::refill() {
  while (!waiting_) {
    if (!log_) {
      if (logs_.empty()) return false;
      const std::filesystem::path file = logs_.front();
      logs_.pop_front();
      try {
        log_ = std::make_unique<LcmLogReader>(file);
      } catch (const InputError&) {
        if (!is_recording_) throw;
        ++bad_;
        continue;
      }
    }
    if (const auto event = log_->next_event()) {
      waiting_ = read(*log_, *event);
    } else {
      bad_ += log_->bad();
      log_.reset();
    }
  }
  return true;
}

std::optional<RobotPlayback::Waiting> RobotPlayback::read(LcmLogReader& log, const LcmLogEvent& event) {
  const std::int64_t stamp_ns = event.stamp_ns + offset_ns_;
  const auto good = [&](const auto& received) -> std::optional<Waiting> {
    if (received.ok()) return Waiting{stamp_ns, RobotMessage{received.value}};
    log.count_bad();
    return std::nullopt;
  };
  if (event.channel == kRobotStateChannel) return good(decode_robot_state(event.data, stamp_ns));
  if (event.channel == kRobotAckChannel) return good(decode_correction_ack(event.data, stamp_ns));
  if (event.channel == kLatencyChannel) {
    if (auto times = decode_latency(event.data); times.ok()) loop_times_ = std::move(times.value);
  }
  if (!is_recording_) {
    if (event.channel == kRobotPathChannel) return good(decode_robot_path(event.data, stamp_ns));
    return std::nullopt;
  }
  if (event.channel == kRecordingChannel) lost_ += lost_in(event.data);
  if (event.channel == kEventChannel || event.channel == kCorrectionChannel) published_.push_back(event.data);
  if (event.channel == kLobesChannel) {
    if (auto used = decode_lobes_used(event.data); used.ok()) return Waiting{stamp_ns, std::move(used.value)};
    log.count_bad();
  } else if (event.channel == kTimingChannel) {
    if (const auto timing = decode_timing(event.data); timing.ok()) return Waiting{stamp_ns, timing.value};
    log.count_bad();
  } else if (event.channel == kSilenceChannel) {
    if (const auto silence = decode_silence(event.data); silence.ok()) return Waiting{stamp_ns, silence.value};
    log.count_bad();
  }
  return std::nullopt;
}

void RobotPlayback::feed_until(std::int64_t stamp_ns, Core& core, const std::function<void()>& after_each) {
  while (refill() && waiting_->stamp_ns <= stamp_ns) {
    feed(*waiting_, core, after_each);
    waiting_.reset();
  }
}

void RobotPlayback::finish(Core& core, const std::function<void()>& after_each) {
  if (is_recording_) feed_until(std::numeric_limits<std::int64_t>::max(), core, after_each);
}

void RobotPlayback::feed(const Waiting& waiting, Core& core, const std::function<void()>& after_each) {
  if (const auto* message = std::get_if<RobotMessage>(&waiting.what)) {
    feed_message(*message, core);
  } else if (const auto* lobes = std::get_if<LobesUsedMessage>(&waiting.what)) {
    feed_lobes(*lobes, core);
  } else if (const auto* timing = std::get_if<LoopTiming>(&waiting.what)) {
    core.add_timing(*timing);
  } else {
    const Silence& silence = std::get<Silence>(waiting.what);
    for (std::int64_t t = silence.first_ns; t <= silence.last_ns; t += kSilentStep_ns) {
      core.advance(t);
      after_each();
    }
  }
}

void RobotPlayback::feed_message(const RobotMessage& message, Core& core) {
  if (listener_) listener_(message);
  if (const auto* state = std::get_if<RobotState>(&message)) {
    core.add_robot_state(*state);
    if (is_recording_ || !pace_.due(*state)) return;
    if (const auto diagram = predictor_.at(*state)) core.add_lobes(*diagram);
  } else if (const auto* ack = std::get_if<CorrectionAck>(&message)) {
    core.add_ack(*ack);
  } else {
    core.add_lobes(predictor_.along(std::get<RobotPath>(message)));
  }
}

void RobotPlayback::feed_lobes(const LobesUsedMessage& message, Core& core) {
  const std::string question(message.question.begin(), message.question.end());
  auto found = computed_.find(question);
  if (found == computed_.end()) {
    if (computed_.size() >= kMostComputed) computed_.clear();
    std::optional<LobeDiagram> diagram;
    if (message.used.ahead) {
      if (const auto path = decode_robot_path(message.question, message.used.posture_stamp_ns); path.ok())
        diagram = predictor_.along(path.value);
    } else if (const auto state = decode_robot_state(message.question, 0); state.ok()) {
      diagram = predictor_.again(state.value);
    }
    found = computed_.emplace(question, diagram).first;
  }
  if (!found->second) {
    ++lobes_missing_;
    return;
  }
  LobeDiagram diagram = *found->second;
  diagram.posture_stamp_ns = message.used.posture_stamp_ns;
  diagram.usable_from_ns = message.used.usable_from_ns;
  diagram.usable_until_ns = message.used.usable_until_ns;
  core.add_lobes(diagram);
}

}  // namespace stillcut
