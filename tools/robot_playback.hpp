// What goes into the core beside the frames, played back in step with them: of an LCM log of the network the robot's
// messages, each with the lobes of its posture; of a recording exactly what the live run fed, and what it published, to
// compare.
#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/lcm/lcm_log.hpp"
#include "drivers/lcm/recording_messages.hpp"
#include "drivers/lcm/telemetry_messages.hpp"
#include "rt/core.hpp"
#include "tools/predictor.hpp"

namespace stillcut {

class RobotPlayback {
 public:
  // Logs in the order of their times; none: no robot. Throws InputError.
  RobotPlayback(std::vector<std::filesystem::path> logs, double offset_s, Predictor& predictor);

  // Told of each state and acknowledgement as it goes into the core; before the first is fed.
  void set_listener(std::function<void(const RobotMessage&)> listener) { listener_ = std::move(listener); }

  // Hands over all whose time has come; `after_each` is told of each, as the core's outputs are to be taken.
  void feed_until(std::int64_t stamp_ns, Core& core, const std::function<void()>& after_each);
  // After the last frame: what a recording has left.
  void finish(Core& core, const std::function<void()>& after_each);

  // Made by the recorder: nothing but what it holds went into the core.
  [[nodiscard]] bool is_recording() const { return is_recording_; }
  // Inputs of the core that the recorder had to leave out.
  [[nodiscard]] std::int64_t lost() const { return lost_; }
  [[nodiscard]] std::int64_t bad() const { return bad_; }
  // Diagrams that cannot be made again, as the question is not in the recording.
  [[nodiscard]] std::int64_t lobes_missing() const { return lobes_missing_; }
  // Events and corrections that the live run published, as bytes, in their order; all of them after finish().
  [[nodiscard]] const std::vector<MessageBytes>& published() const { return published_; }

  // Where the live loop's time went, by the newest message of it; nothing where the recording holds none.
  [[nodiscard]] const std::optional<LatencyReport>& loop_times() const { return loop_times_; }

 private:
  struct Waiting {
    std::int64_t stamp_ns = 0;
    std::variant<RobotMessage, LobesUsedMessage, Silence, LoopTiming> what;
  };

  bool refill();
  std::optional<Waiting> read(LcmLogReader& log, const LcmLogEvent& event);
  void feed(const Waiting& waiting, Core& core, const std::function<void()>& after_each);
  void feed_message(const RobotMessage& message, Core& core);
  void feed_lobes(const LobesUsedMessage& message, Core& core);

  Predictor& predictor_;
  PredictionPace pace_;
  std::int64_t offset_ns_;
  std::deque<std::filesystem::path> logs_;
  std::unique_ptr<LcmLogReader> log_;
  bool is_recording_ = false;
  std::optional<Waiting> waiting_;
  std::map<std::string, std::optional<LobeDiagram>> computed_;  // by question; a robot that stands asks the same
  std::vector<MessageBytes> published_;
  std::function<void(const RobotMessage&)> listener_;
  std::optional<LatencyReport> loop_times_;
  std::int64_t bad_ = 0, lobes_missing_ = 0, lost_ = 0;
};

}  // namespace stillcut
