#include "adapters/linuxcnc_adapter.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "adapters/linuxcnc_lines.hpp"
#include "models/machining.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kAnswerWithin_ns = 1'000'000'000;
constexpr std::int64_t kHoldBackAfterRefusal_ns = 5'000'000'000;
constexpr std::array<const char*, 7> kReadings{"GET REL_ACT_POS",   "GET JOINT_POS",     "GET PROGRAM_CODES",
                                               "GET PROGRAM_LINE",  "GET FEED_OVERRIDE", "GET SPINDLE_OVERRIDE 0",
                                               "GET PROGRAM_STATUS"};
constexpr double kMmPerInch = 25.4, kMmPerCm = 10.0, kMetersPerMm = 1e-3;
constexpr double kHighestPercent = 1000.0, kLastLine = 2e9;
constexpr const char* kHand = "the operator, or a limit of LinuxCNC, has changed an override";
constexpr const char* kEnds = "the adapter ends";
constexpr const char* kNotRunning = "the program does not run";
constexpr const char* kNotTaken = "LinuxCNC does not take overrides; is the machine on, and no other client enabled?";

int whole_percent(double value) { return static_cast<int>(std::lround(std::clamp(value, 0.0, kHighestPercent))); }

}  // namespace

std::array<const char*, 6> linuxcnc_refusals() {
  return {nullptr, nullptr, nullptr, "LinuxCNC: the feed direction stays with the program", nullptr, nullptr};
}

LinuxCncAdapter::LinuxCncAdapter(const SessionSettings& settings, LinuxCncLogin login)
    : settings_{settings}, login_{std::move(login)}, session_{settings}, programmed_rpm_{settings.nominal_speed_rpm} {
  disconnected();
}

void LinuxCncAdapter::disconnected() {
  phase_ = Phase::greeting;
  waiting_ = false;
  // Verbose first: only then are the others acknowledged.
  commands_ = {"HELLO " + login_.connect_password + " stillcut 1.0",
               "SET VERBOSE ON",
               "SET ECHO OFF",
               "SET ENABLE " + login_.enable_password,
               "GET USER_LINEAR_UNITS",
               "GET JOINT_TYPE"};
}

std::optional<Answer> LinuxCncAdapter::receive(const Correction& correction, std::int64_t now_ns) {
  return session_.receive(correction, now_ns);
}

CncOutput LinuxCncAdapter::line(std::string_view text, std::int64_t now_ns) {
  if (waiting_ && !text.empty()) {
    const CncReply reply = reply_to(commands_.front(), text);
    if (reply == CncReply::none) return {};
    const std::string command = std::move(commands_.front());
    commands_.pop_front();
    waiting_ = false;
    if (reply == CncReply::done) {
      take(command, text);
    } else if (phase_ == Phase::greeting && !command.starts_with("GET")) {
      return {{},
              {},
              command.starts_with("HELLO") ? "LinuxCNC refuses the connection password"
                                           : "LinuxCNC refuses to be controlled; check the enable password"};
    } else {
      ++refused_;
      if (phase_ == Phase::reading) report_good_ = false;
      if (phase_ == Phase::setting) {
        set_refused_ns_ = now_ns;
        warning_ = kNotTaken;
      }
    }
  }
  if (waiting_) {
    if (now_ns - sent_ns_ > kAnswerWithin_ns) return {{}, {}, "LinuxCNC does not answer"};
    return {};
  }
  if (!commands_.empty()) return send_next(now_ns);
  CncOutput output;
  if (phase_ == Phase::reading) {
    end_reading(now_ns);
    output.state = report_good_ ? session_.state_due(now_ns) : std::nullopt;
    phase_ = Phase::setting;
    if (!commands_.empty()) output.send = send_next(now_ns).send;
    output.warning = warning_;
    warning_ = nullptr;
    return output;
  }
  phase_ = Phase::resting;
  if (cycles_ > 0 && now_ns - cycle_started_ns_ < settings_.cycle_ns) return output;
  cycle_started_ns_ = now_ns;
  start_cycle();
  return send_next(now_ns);
}

CncOutput LinuxCncAdapter::send_next(std::int64_t now_ns) {
  waiting_ = true;
  sent_ns_ = now_ns;
  return {commands_.front() + "\r\n", {}, nullptr, nullptr};
}

void LinuxCncAdapter::start_cycle() {
  ++cycles_;
  phase_ = Phase::reading;
  report_good_ = true;
  commands_.assign(kReadings.begin(), kReadings.end());
}

void LinuxCncAdapter::take(std::string_view command, std::string_view text) {
  if (Override* set = override_of(command)) set->taken = true;
  if (!command.starts_with("GET ") || take_value(command.substr(4, command.find(' ', 4) - 4), text)) return;
  ++bad_;
  report_good_ = false;
}

LinuxCncAdapter::Override* LinuxCncAdapter::override_of(std::string_view command) {
  if (command.starts_with("SET FEED_OVERRIDE")) return &feed_;
  return command.starts_with("SET SPINDLE_OVERRIDE") ? &spindle_ : nullptr;
}

// False: the reply cannot be read.
bool LinuxCncAdapter::take_value(std::string_view name, std::string_view text) {
  const auto values = values_of(text);
  if (name == "USER_LINEAR_UNITS") {
    mm_per_unit_ = values[0] == "INCH" ? kMmPerInch : values[0] == "CM" ? kMmPerCm : 1.0;
    return true;
  }
  if (name == "JOINT_TYPE") {
    joints_turn_ = values.size() >= 3 && std::all_of(values.begin(), values.begin() + 3,
                                                     [](std::string_view type) { return type == "ANGULAR"; });
    return true;
  }
  if (name == "PROGRAM_STATUS") {
    take_status(values[0]);
    return true;
  }
  if (name == "PROGRAM_CODES") {
    if (const auto speed = programmed_speed_rpm(text)) programmed_rpm_ = *speed;
    return true;
  }
  if (name == "REL_ACT_POS" || name == "JOINT_POS") {
    const auto places = cnc_places(text);
    if (!places) return false;
    if (name == "JOINT_POS") {
      for (std::size_t i = 0; i < places->size(); ++i)
        report_.joints[i] = joints_turn_ ? deg_to_rad((*places)[i]) : 0.0;
    } else {
      for (std::size_t i = 0; i < 3; ++i) report_.position[i] = (*places)[i] * mm_per_unit_ * kMetersPerMm;
    }
    return true;
  }
  const auto number = cnc_number(values.back());  // newer versions put the spindle's number before its override
  if (!number || !(*number >= 0.0)) return false;
  if (name == "PROGRAM_LINE") {
    if (*number > kLastLine) return false;
    report_.block = static_cast<std::int32_t>(*number);
    return true;
  }
  if (*number > kHighestPercent) return false;
  (name == "FEED_OVERRIDE" ? feed_ : spindle_).reported = whole_percent(*number);
  return true;
}

void LinuxCncAdapter::take_status(std::string_view status) {
  running_ = status == "RUNNING";
  if (running_ && paused_seen_) session_.started_again();  // a person has resumed it, or started it anew
  paused_seen_ = !running_;
}

// An override that is not what we made it, or a refusal to set one, ends the correction.
void LinuxCncAdapter::decide_who_holds_the_overrides(std::int64_t now_ns) {
  for (Override* value : {&feed_, &spindle_}) {
    if (value->set && value->taken && *value->set != value->reported) {
      value->hand = true;
      value->set.reset();
      warning_ = kHand;
    }
    if (!value->set) value->base = value->reported;
  }
  const bool not_taken = set_refused_ns_ > 0 && now_ns - set_refused_ns_ < kHoldBackAfterRefusal_ns;
  const char* reason = running_ || stopping_ ? nullptr : kNotRunning;
  if (not_taken) reason = kNotTaken;
  if (feed_.hand || spindle_.hand) reason = kHand;
  if (ending_) reason = kEnds;
  session_.hold_back(reason);
}

void LinuxCncAdapter::end_reading(std::int64_t now_ns) {
  if (!report_good_) return;
  decide_who_holds_the_overrides(now_ns);
  report_.counter = cycles_;
  report_.clock_us = now_ns / 1000;  // LinuxCNC tells no time that is finer
  report_.spindle_speed_rpm = programmed_rpm_ * 0.01 * spindle_.base;
  if (reason_to_doubt(report_) != nullptr) {
    ++bad_;
    report_good_ = false;
    return;
  }
  const auto setpoint = session_.cycle(report_, now_ns);
  if (!setpoint) return;
  const double programmed = report_.spindle_speed_rpm;
  const double speed_share = programmed > 0.0 ? setpoint->spindle_speed_rpm / programmed : 1.0;
  if (setpoint->spindle_change_rpm == 0.0 && setpoint->feed_override == 1.0) feed_.hand = spindle_.hand = false;
  want(feed_, "FEED_OVERRIDE", setpoint->feed_override);
  want(spindle_, "SPINDLE_OVERRIDE", speed_share);
  stopping_ = setpoint->stop;
  if (stopping_ && running_) commands_.emplace_back("SET PAUSE");
}

void LinuxCncAdapter::want(Override& value, const char* name, double share) {
  const bool nominal = share == 1.0;
  if (value.hand || (nominal && !value.set)) return;  // the operator's, and none of our business
  const int percent = nominal ? value.base : whole_percent(value.base * share);
  if (nominal && value.reported == percent) {
    value.set.reset();
    return;
  }
  if (value.set == percent && value.taken) return;
  value.set = percent;
  value.taken = false;
  commands_.push_back("SET " + std::string{name} + ' ' + std::to_string(percent));
}

std::string LinuxCncAdapter::farewell() const {
  std::string lines;
  if (feed_.set) lines += "SET FEED_OVERRIDE " + std::to_string(feed_.base) + "\r\n";
  if (spindle_.set) lines += "SET SPINDLE_OVERRIDE " + std::to_string(spindle_.base) + "\r\n";
  return lines;
}

}  // namespace stillcut
