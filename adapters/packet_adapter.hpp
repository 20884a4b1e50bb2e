// An adapter without its sockets: a controller's packets and the monitor's corrections in, answers out, byte for byte
// the same whenever the same comes in at the same times. For protocols in which the controller sends a packet each
// cycle and waits for one: KUKA RSI, ABB EGM.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "adapters/controller_session.hpp"

namespace stillcut {

struct AnswerHead {
  std::uint32_t number = 0;   // counts the answers
  std::uint32_t time_ms = 0;  // since the first packet
};

// How a protocol writes its packets.
struct PacketProtocol {
  std::function<ParsedReport(std::span<const std::uint8_t>)> parse;
  std::function<std::string(const ControllerReport&, const Setpoint&, const AnswerHead&)> build;
};

struct PacketOutput {
  std::string answer;  // empty: the packet must not be answered
  std::optional<RobotState> state;
  const char* why_not = nullptr;  // why the packet was dropped as bad
  bool settled = false;           // nothing moves any more because of a correction
};

class PacketAdapter {
 public:
  PacketAdapter(PacketProtocol protocol, const SessionSettings& settings)
      : protocol_{std::move(protocol)}, session_{settings} {}

  std::optional<Answer> receive(const Correction& correction, std::int64_t now_ns) {
    return session_.receive(correction, now_ns);
  }
  // From now on back to the program, and no correction is followed any more.
  void end() { session_.hold_back("the adapter ends"); }
  PacketOutput packet(std::span<const std::uint8_t> bytes, std::int64_t now_ns);

  [[nodiscard]] const ControllerSession& session() const { return session_; }
  [[nodiscard]] std::int64_t bad() const { return bad_; }
  [[nodiscard]] std::int64_t late_answers() const { return late_answers_; }  // as the controller counts them

 private:
  PacketProtocol protocol_;
  ControllerSession session_;
  std::int64_t bad_ = 0, late_answers_ = 0, first_ns_ = 0;
  std::uint32_t answers_ = 0;
};

}  // namespace stillcut
