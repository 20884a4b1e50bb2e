#include "tools/recorder.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cstring>

#include "drivers/can/candump_log.hpp"
#include "drivers/lcm/telemetry_messages.hpp"

namespace stillcut {
namespace {

constexpr std::chrono::milliseconds kPoll{20};
constexpr double kFlushEvery_s = 0.4;  // with the poll and the disk's own time: the last second at most is lost
constexpr double kTellTimesEvery_s = 1.0;
constexpr double kTryAgain_s = 5.0;  // after the disk refused
constexpr std::size_t kMostWaiting = 4096;

double steady_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

MessageBytes text_bytes(const std::string& text) { return {text.begin(), text.end()}; }

std::string why_marked(const Event& event) {
  switch (event.type) {
    case EventType::chatter_onset:
      return "chatter onset";
    case EventType::correction:
      return "correction";
    case EventType::fault:
      return std::string("fault: ") + event.note.data();
    default:
      return {};
  }
}

}  // namespace

Recorder::Recorder(LoopChannels& channels, RecordingSettings settings, std::string interface)
    : channels_{channels},
      interface_{std::move(interface)},
      folder_{std::move(settings), recording_name(realtime_ns())} {
  begin(steady_s());
  if (folder_.error() != 0)
    throw InputError(folder_.folder().string(), 0,
                     std::string("nothing can be recorded there: ") + std::strerror(folder_.error()));
  thread_ = std::jthread{[this](const std::stop_token& stop) { run(stop); }};
}

Recorder::~Recorder() { finish(); }

std::int64_t Recorder::add_question(MessageBytes question, bool ahead) {
  const std::lock_guard lock{mutex_};
  auto& questions = questions_[ahead ? 1 : 0];
  questions.emplace(++last_question_, std::move(question));
  if (questions.size() > kMostWaiting) questions.erase(questions.begin());
  return last_question_;
}

void Recorder::add_output(const Output& output) {
  Message message{};
  if (output.type == Output::Type::event)
    message = {output.event.stamp_ns, kEventChannel, encode(output.event)};
  else if (output.type == Output::Type::correction)
    message = {output.correction.stamp_ns, kCorrectionChannel, encode(output.correction)};
  else
    message = {output.status.stamp_ns, kStatusChannel, encode(output.status)};
  const std::lock_guard lock{mutex_};
  if (messages_.size() < kMostWaiting) messages_.push_back(std::move(message));
  if (output.type != Output::Type::event) return;
  if (std::string why = why_marked(output.event); !why.empty()) marks_.push_back(std::move(why));
}

void Recorder::add_path(const RobotPath& path) {
  Message message{path.stamp_ns, kRobotPathChannel, encode(path)};
  const std::lock_guard lock{mutex_};
  if (messages_.size() < kMostWaiting) messages_.push_back(std::move(message));
}

void Recorder::mark(std::string why) {
  const std::lock_guard lock{mutex_};
  marks_.push_back(std::move(why));
}

void Recorder::finish() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
  drain();
  end_silence();
  note_loop_times();
  flush(steady_s());
  folder_.close(steady_s());
  counters_.bytes = folder_.bytes_written();
}

void Recorder::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    drain();
    if (const double now_s = steady_s(); now_s >= next_flush_s_) {
      next_flush_s_ = now_s + kFlushEvery_s;
      flush(now_s);
    }
    std::this_thread::sleep_for(kPoll);
  }
}

// All that is lost while the disk refuses is counted; nothing waits, so that the loop's ring never fills.
void Recorder::drain() {
  CoreInput input;
  while (channels_.recorded.pop(input)) {
    if (!folder_.is_open()) {
      ++counters_.lost;
      continue;
    }
    if (!std::holds_alternative<Silence>(input)) end_silence();
    std::visit(
        [this](const auto& in) {
          using In = std::decay_t<decltype(in)>;
          if constexpr (std::is_same_v<In, RobotState>) {
            write_message(newest_ns_ = in.stamp_ns, kRobotStateChannel, encode(in));
          } else if constexpr (std::is_same_v<In, CorrectionAck>) {
            write_message(newest_ns_ = in.stamp_ns, kRobotAckChannel, encode(in, in.reason.data()));
          } else if constexpr (std::is_same_v<In, LoopTiming>) {
            write_message(newest_ns_ = in.stamp_ns, kTimingChannel, encode(in));
          } else {
            write(in);
          }
        },
        input);
  }
  drain_messages();
}

void Recorder::drain_messages() {
  std::vector<Message> messages;
  std::vector<std::string> marks;
  {
    const std::lock_guard lock{mutex_};
    messages.swap(messages_);
    marks.swap(marks_);
  }
  if (folder_.is_open())
    for (const Message& message : messages) write_message(message.stamp_ns, message.channel, message.bytes);
  for (const std::string& why : marks) folder_.mark(why, steady_s());
  counters_.marks += std::ssize(marks);
}

void Recorder::write(const CanFrame& frame) {
  std::array<char, kMaxCandumpLine> line{};
  can_.append(line.data(), format_candump_line(frame, interface_, line));
  newest_ns_ = std::max(newest_ns_, frame.stamp_ns);
  ++frames_held_;
}

void Recorder::write(const LobesUsed& used) {
  MessageBytes question;
  {
    const std::lock_guard lock{mutex_};
    auto& questions = questions_[used.ahead ? 1 : 0];
    if (const auto found = questions.find(used.question); found != questions.end()) question = found->second;
    questions.erase(questions.begin(), questions.upper_bound(used.question));  // older answers never come any more
  }
  write_message(used.fed_ns, kLobesChannel, encode(used, question));
}

// Steps of a millisecond are told together.
void Recorder::write(const Silence& silence) {
  newest_ns_ = std::max(newest_ns_, silence.last_ns);
  if (silence_ && silence.first_ns == silence_->last_ns + kSilentStep_ns) {
    silence_->last_ns = silence.last_ns;
    return;
  }
  end_silence();
  silence_ = silence;
}

void Recorder::end_silence() {
  if (silence_ && folder_.is_open()) write_message(silence_->first_ns, kSilenceChannel, encode(*silence_));
  silence_.reset();
}

void Recorder::write_message(std::int64_t stamp_ns, const char* channel, const MessageBytes& bytes) {
  append_lcm_event(lcm_, counters_.messages++, stamp_ns, channel, bytes);
}

// A recording with a hole says so: what comes after it need not be decided again as it was.
void Recorder::note_lost() {
  const std::uint64_t refused = channels_.recorded.refused();
  counters_.lost += static_cast<std::int64_t>(refused - refused_seen_);
  if (refused > refused_seen_)
    spdlog::warn("recording: {} inputs came too fast to be recorded", refused - refused_seen_);
  refused_seen_ = refused;
  if (counters_.lost == lost_told_) return;
  const std::string text = "lost " + std::to_string(counters_.lost - lost_told_);
  lost_told_ = counters_.lost;
  write_message(newest_ns_, kRecordingChannel, text_bytes(text));
}

// Where the loop's time went until now, for who reads the recording.
void Recorder::note_loop_times() {
  if (folder_.is_open() && newest_ns_ != 0)
    write_message(newest_ns_, kLatencyChannel, encode(latency_report(channels_.times, realtime_ns())));
}

void Recorder::flush(double now_s) {
  if (!folder_.is_open()) {
    if (now_s < next_try_s_) return;
    next_try_s_ = now_s + kTryAgain_s;
    if (!folder_.has_room()) return;
    begin(now_s);
    if (!folder_.is_open()) return;
    spdlog::warn("recording goes on in {}", folder_.folder().string());
  }
  end_silence();
  note_lost();
  if (now_s >= next_times_s_) {
    next_times_s_ = now_s + kTellTimesEvery_s;
    note_loop_times();
  }
  const bool good = folder_.write_can(can_) && folder_.write_lcm(lcm_) && folder_.flush(now_s);
  (good ? counters_.frames : counters_.lost) += frames_held_;
  frames_held_ = 0;
  can_.clear();
  lcm_.clear();
  if (!good) return stop_recording(now_s);
  if (folder_.is_due(now_s)) begin(now_s);
  if (!folder_.is_open()) stop_recording(now_s);
}

void Recorder::begin(double now_s) {
  can_.clear();
  lcm_.clear();
  if (!folder_.begin(now_s)) return;
  write_message(newest_ns_, kRecordingChannel,
                text_bytes("stillcut " STILLCUT_VERSION " segment " + std::to_string(folder_.number())));
}

void Recorder::stop_recording(double now_s) {
  folder_.close(now_s);  // and with it what its files were refused
  const int error = folder_.error();
  silence_.reset();
  ++counters_.stops;
  ++counters_.lost;  // at least
  next_try_s_ = now_s + kTryAgain_s;
  spdlog::error("recording stopped: {}: {}; monitoring goes on, recording when there is room",
                folder_.folder().string(), std::strerror(error));
}

}  // namespace stillcut
