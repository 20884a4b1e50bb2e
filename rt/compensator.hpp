// Turns heard chatter into corrections for the controller: choose a setting, go there on a jerk-limited ramp, give it
// time to act, look again, try the next, remember what worked, return when the reason is gone. Like the monitor it is a
// function of its inputs: no clock, no thread.
//
// Modes: off computes nothing; shadow computes and publishes everything as shown-only; active asks to be followed, and
// does so only while the controller is alive and has acknowledged. Every message carries its expiry, and every failure
// ends in release to nominal. docs/compensation.md.
#pragma once

#include <cstdint>

#include "dsp/monitor.hpp"
#include "models/lobe_diagram.hpp"
#include "rt/compensation_limits.hpp"
#include "rt/correction_ladder.hpp"
#include "rt/correction_memory.hpp"
#include "rt/cut_setting.hpp"
#include "rt/output_queue.hpp"
#include "rt/signals.hpp"

namespace stillcut {

struct CompensatorSettings {
  RuntimeMode mode = RuntimeMode::shadow;
  int teeth = 0;
  CompensationLimits limits;
};

struct CompensatorInputs {
  std::int64_t now_ns = 0;
  const MonitorView* monitor = nullptr;
  const LobeDiagram* lobes = nullptr;        // nullptr: none to be trusted
  const LobeDiagram* lobes_ahead = nullptr;  // least limits along the announced path; nullptr: none announced
  const RobotState* robot = nullptr;         // nullptr: none heard
  double axial_depth = 0.0;                  // m; NaN unknown
  double coming_depth = 0.0;                 // m, that the cut is on its way to; NaN unknown
  double feed_direction = 0.0;               // rad, as it is
  double nominal_speed = 0.0;                // rad/s, as programmed; 0: take the measured speed
  bool controller_alive = false;             // robot_state arrives
  bool in_time = true;                       // the loop keeps time
};

class Compensator {
 public:
  explicit Compensator(const CompensatorSettings& settings) noexcept : settings_{settings} {}

  // One step in data time; what is to be published goes to `out`.
  void step(const CompensatorInputs& in, OutputQueue& out) noexcept;
  void acknowledge(const CorrectionAck& ack) noexcept;

  [[nodiscard]] bool correcting() const noexcept { return phase_ != Phase::none; }

 private:
  static constexpr std::int64_t kAirEndsCut_ns = 1'000'000'000;  // shorter gaps in the part are of the same cut

  static constexpr double kTurned = 0.05;  // rad, another direction than the programmed one

  // acting: a candidate moves and has its time; holding: chatter has ended, its setting stays; returning: slowly back
  // to the program; stopped: a stop was asked for.
  enum class Phase : std::uint8_t { none, acting, holding, returning, stopped };

  void hear_chatter(const CompensatorInputs& in, OutputQueue& out) noexcept;
  void hear_nothing(const CompensatorInputs& in, OutputQueue& out) noexcept;
  void follow_stop(const CompensatorInputs& in, OutputQueue& out) noexcept;
  void ask_next(const CompensatorInputs& in, OutputQueue& out) noexcept;
  void meet_controller(const CompensatorInputs& in) noexcept;
  void tell_refusal(const CompensatorInputs& in, OutputQueue& out) noexcept;
  void leave_what_is_refused(const CompensatorInputs& in, OutputQueue& out) noexcept;
  [[nodiscard]] ShortText with_refusal(const char* reason) const noexcept;
  void retarget_shadow(const CompensatorInputs& in, OutputQueue& out) noexcept;
  void start(const CompensatorInputs& in, const Candidate& candidate, OutputQueue& out) noexcept;
  void begin_motion(const CompensatorInputs& in) noexcept;
  void begin_turn_back(const CompensatorInputs& in) noexcept;
  void follow_turn_back(const CompensatorInputs& in) noexcept;
  bool gives_more_time(const CompensatorInputs& in) noexcept;
  void start_return(const CompensatorInputs& in) noexcept;
  void say_none(const CompensatorInputs& in, const Candidate& candidate, OutputQueue& out) noexcept;
  void publish(const CompensatorInputs& in, OutputQueue& out) noexcept;
  void release(const CompensatorInputs& in, const char* reason, OutputQueue& out) noexcept;
  void remember(const CompensatorInputs& in) noexcept;
  void give_up_candidate(const CompensatorInputs& in) noexcept;
  [[nodiscard]] const char* reason_to_hold_back(const CompensatorInputs& in) noexcept;
  [[nodiscard]] ChatterSituation situation(const CompensatorInputs& in) const noexcept;
  [[nodiscard]] Prediction prediction(const CompensatorInputs& in) const noexcept;
  [[nodiscard]] CutPlace place(const CompensatorInputs& in) const noexcept;
  [[nodiscard]] CutSetting programmed(const CompensatorInputs& in) const noexcept;
  [[nodiscard]] CutSetting uncorrected(const CompensatorInputs& in) const noexcept;
  [[nodiscard]] bool is_told_on_its_turn(const CompensatorInputs& in) const noexcept;
  [[nodiscard]] double frequency_of_chatter(const CompensatorInputs& in) const noexcept;
  [[nodiscard]] bool has_its_time(const CompensatorInputs& in) const noexcept;
  [[nodiscard]] bool deafened(const CompensatorInputs& in) const noexcept;
  [[nodiscard]] bool is_heard(const CompensatorInputs& in) const noexcept {
    return in.monitor->chatter || in.monitor->structural || deafened(in);
  }
  [[nodiscard]] bool tool_chatters(const CompensatorInputs& in) const noexcept;
  [[nodiscard]] bool is_contradicted(const CompensatorInputs& in) const noexcept;
  [[nodiscard]] bool structure_chatters(const CompensatorInputs& in) const noexcept;
  [[nodiscard]] Prediction coming_prediction(const CompensatorInputs& in) const noexcept;
  [[nodiscard]] bool program_changed(const CompensatorInputs& in) const noexcept;
  [[nodiscard]] bool reason_is_gone(const CompensatorInputs& in) const noexcept;
  [[nodiscard]] std::int64_t time_to_act_ns(const CompensatorInputs& in) const noexcept;
  [[nodiscard]] double motion_time(std::int64_t now_ns) const noexcept {
    return static_cast<double>(now_ns - began_ns_) * 1e-9;
  }

  CompensatorSettings settings_;
  Phase phase_ = Phase::none;
  Candidate candidate_;        // in force, or the last one
  CutSetting programmed_;      // by the program, when the correction began
  SettingMotion motion_;       // since began_ns_
  bool turns_back_ = false;    // released, the feed is on its way back to programmed_; motion_ goes with it
  bool turn_is_told_ = false;  // the robot tells the direction of the motion, not that of the program
  double turn_ = 0.0;          // rad, of the feed from the program's, when it was released
  std::int64_t turn_until_ns_ = 0;
  Attempts attempts_;  // in this cut
  CorrectionMemory memory_;
  bool remembered_ = false;     // the candidate in force, as one that worked
  bool return_failed_ = false;  // chatter came back on the way to the program: no second time in this cut
  bool held_back_ = false;      // a condition failed; released until it holds again
  bool said_none_ = false;
  bool unanswered_ = false;                         // the controller did not answer: no more in this episode
  bool controller_met_ = false;                     // heard, and not silent since
  CorrectionKind asked_ = CorrectionKind::release;  // that was last asked for
  bool taken_ = false;                              // the controller has accepted the candidate
  ShortText refusal_{};                             // why it last refused one, in its own words
  bool refusal_is_news_ = false;
  CutSetting before_;  // in force when the candidate was chosen
  std::int64_t sequence_ = 0;
  std::int64_t first_sequence_ = 0, last_asked_sequence_ = 0;  // messages of this candidate
  std::int64_t began_ns_ = 0, act_until_ns_ = 0, next_publish_ns_ = 0;
  std::int64_t answered_ns_ = 0;  // last acknowledgement, or the first message of this correction
  std::int64_t chatter_since_ns_ = 0, quiet_since_ns_ = 0, air_since_ns_ = 0, saturated_since_ns_ = 0,
               safe_since_ns_ = 0;      // 0: is not
  std::int64_t unheard_since_ns_ = 0;   // 0: chatter is heard
  std::int64_t believed_since_ns_ = 0;  // the chatter that goes on was first answered; 0: none does
  double nominal_speed_ = 0.0;          // rad/s, as the robot told it when the candidate was chosen
  double loudest_ = 0.0;                // m/s^2, of this chatter
  double checked_ = 0.0;                // when its effect was last looked at
  double tolerated_ = 0.0;              // what is left of it and stays; 0: nothing was left
  double chatter_frequency_hz_ = 0.0;
  double chatter_depth_ = 0.0, chatter_margin_ = 0.0;  // m; predicted at the programmed speed when it was heard
};

}  // namespace stillcut
