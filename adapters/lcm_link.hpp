// The adapter's side towards the monitor: corrections come in, acknowledgements and robot states go out, on threads of
// their own. A publishing that takes long must not make the controller's cycle late; the two sides meet in rings only.
#pragma once

#include <thread>

#include "adapters/correction_follower.hpp"
#include "drivers/lcm/monitor_listener.hpp"
#include "drivers/lcm/publisher.hpp"
#include "rt/ring.hpp"

namespace stillcut {

struct HeardCorrection {
  Correction correction;
  std::int64_t received_ns = 0;  // steady_ns()
};

struct LinkOutput {
  enum class Type : std::int8_t { answer, state } type = Type::state;
  Answer answer;
  RobotState state;
};

class LcmLink {
 public:
  explicit LcmLink(const LcmConnection& connection);

  // All of these: the controller's thread only.
  bool next(HeardCorrection& heard) { return corrections_.pop(heard); }
  void say(const Answer& answer) { (void)outputs_.push({LinkOutput::Type::answer, answer, {}}); }
  void say(const RobotState& state) { (void)outputs_.push({LinkOutput::Type::state, {}, state}); }

  [[nodiscard]] std::int64_t sent() const { return publisher_.sent(); }
  [[nodiscard]] std::int64_t failed() const { return publisher_.failed(); }

 private:
  void publish(const std::stop_token& stop);

  Ring<HeardCorrection> corrections_{256};
  Ring<LinkOutput> outputs_{1024};
  Publisher publisher_;
  MonitorListener listener_;
  std::jthread thread_;  // last: it uses all else
};

}  // namespace stillcut
