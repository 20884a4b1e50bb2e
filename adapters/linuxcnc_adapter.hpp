// The LinuxCNC adapter without its socket: lines of the server and corrections in, lines to the server, answers and
// states out. It asks: each cycle it reads position, program and overrides, one command after the other, and then sets
// the overrides that the corrections want.
//
// The operator's overrides are the program here: corrections scale them, and what was there before comes back. Where
// somebody else moves an override meanwhile, the adapter leaves that one alone and ends the correction.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "adapters/controller_session.hpp"

namespace stillcut {

struct LinuxCncLogin {
  std::string connect_password = "EMC", enable_password = "EMCTOO";
};

struct CncOutput {
  std::string send;  // one line, its end included; empty: nothing
  std::optional<RobotState> state;
  const char* hang_up = nullptr;  // why the connection is of no use
  const char* warning = nullptr;
};

class LinuxCncAdapter {
 public:
  LinuxCncAdapter(const SessionSettings& settings, LinuxCncLogin login);

  std::optional<Answer> receive(const Correction& correction, std::int64_t now_ns);
  // A line of the server; an empty one: only time has passed. To be called at least once a cycle.
  CncOutput line(std::string_view text, std::int64_t now_ns);
  void disconnected();
  // From now on back to the program, and no correction is followed any more.
  void end() { ending_ = true; }
  // The lines that give the operator's overrides back at once; empty: nothing of ours is set.
  [[nodiscard]] std::string farewell() const;

  [[nodiscard]] const ControllerSession& session() const { return session_; }
  [[nodiscard]] std::int64_t bad() const { return bad_; }          // replies that could not be read
  [[nodiscard]] std::int64_t refused() const { return refused_; }  // commands that LinuxCNC did not take

 private:
  struct Override {  // of feed or spindle, per cent
    int reported = 100, base = 100;
    std::optional<int> set;  // what we made of it; nothing: it is as the operator has it
    bool taken = false;      // LinuxCNC has acknowledged that
    bool hand = false;       // somebody else has moved it meanwhile
  };
  enum class Phase { greeting, reading, setting, resting };

  CncOutput send_next(std::int64_t now_ns);
  void take(std::string_view command, std::string_view text);
  Override* override_of(std::string_view command);
  bool take_value(std::string_view name, std::string_view text);
  void take_status(std::string_view status);
  void start_cycle();
  void end_reading(std::int64_t now_ns);
  void want(Override& value, const char* name, double share);
  void decide_who_holds_the_overrides(std::int64_t now_ns);

  SessionSettings settings_;
  LinuxCncLogin login_;
  ControllerSession session_;
  Phase phase_ = Phase::greeting;
  std::deque<std::string> commands_;  // the first one is sent and not yet answered while waiting_
  bool waiting_ = false, ending_ = false;
  std::int64_t sent_ns_ = 0, cycle_started_ns_ = 0, cycles_ = 0, set_refused_ns_ = 0;
  const char* warning_ = nullptr;

  double mm_per_unit_ = 1.0;
  bool joints_turn_ = false;
  ControllerReport report_;
  bool report_good_ = true, running_ = false, paused_seen_ = false, stopping_ = false;
  Override feed_, spindle_;
  double programmed_rpm_ = 0.0;
  std::int64_t bad_ = 0, refused_ = 0;
};

std::array<const char*, 6> linuxcnc_refusals();

}  // namespace stillcut
