// Adapter and simulated controller in one closed loop without sockets, in simulated time, for the tests.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "adapters/exchange_log.hpp"
#include "adapters/packet_adapter.hpp"
#include "adapters/simulated_controller.hpp"
#include "tests/adapters/correction_messages.hpp"

namespace stillcut {

// The demo cell's spindle and programmed speed.
inline SessionSettings demo_session(const std::array<const char*, 6>& refusals) {
  SessionSettings settings;
  settings.nominal_speed_rpm = 8500.0;
  settings.follower.refusals = refusals;
  settings.follower.min_speed_rpm = 6000.0;
  settings.follower.max_speed_rpm = 14000.0;
  settings.follower.speed_rate_rpm_per_s = 4000.0;
  return settings;
}

class AdapterLoop {
 public:
  AdapterLoop(const PacketProtocol& protocol, const SessionSettings& settings, SimulatedController& controller)
      : adapter{protocol, settings}, controller{controller}, cycle_ns_{settings.cycle_ns} {}

  void run(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      now_ns += cycle_ns_;
      last_packet = controller.cycle();
      const PacketOutput output = adapter.packet(bytes_of(last_packet), now_ns);
      last_answer = output.answer;
      if (!output.answer.empty()) controller.answer(output.answer);
      if (output.state) states.push_back(*output.state);
    }
  }
  std::optional<Answer> say(Correction correction) {
    correction.sequence = ++sequence;
    correction.stamp_ns = now_ns;
    return adapter.receive(correction, now_ns);
  }
  // Said every tenth of a second, as the monitor does.
  void hold(const Correction& correction, int cycles) {
    const auto every = static_cast<int>(100'000'000 / cycle_ns_);
    for (int i = 0; i < cycles; ++i) {
      if (i % every == 0) say(correction);
      run(1);
    }
  }

  std::int64_t now_ns = 1'000'000'000, sequence = 0;
  PacketAdapter adapter;
  SimulatedController& controller;
  std::string last_packet, last_answer;
  std::vector<RobotState> states;

 private:
  std::int64_t cycle_ns_;
};

// A packet with some bytes changed, taken out, or put in twice.
inline std::string mutated(std::string packet, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>{0, n - 1}(random); };
  for (std::size_t changes = 1 + below(8); changes > 0 && !packet.empty(); --changes) {
    const std::size_t at = below(packet.size());
    switch (below(4)) {
      case 0:
        packet[at] = static_cast<char>(below(256));
        break;
      case 1:
        packet.erase(at, 1 + below(8));
        break;
      case 2:
        packet.insert(at, packet.substr(below(packet.size()), 1 + below(16)));
        break;
      default:
        packet.resize(at);
    }
  }
  return packet;
}

}  // namespace stillcut
