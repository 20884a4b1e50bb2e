#include "adapters/adapter_run.hpp"

#include <pthread.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <cstring>
#include <memory>

#include "adapters/correction_intake.hpp"
#include "adapters/exchange_log.hpp"
#include "adapters/lcm_link.hpp"
#include "adapters/udp_port.hpp"

namespace stillcut {
namespace {

constexpr int kWait_ms = 20;
constexpr int kPriority = 60;  // SCHED_FIFO; below the monitor's loop
constexpr std::int64_t kPeerForgotten_ns = 1'000'000'000;

// The one controller that is served: the first to speak, until it has been silent for a second.
class ServedPeer {
 public:
  bool serves(const sockaddr_in& peer, std::int64_t now_ns) const {
    return heard_ns_ == 0 || same_peer(peer, peer_) || now_ns - heard_ns_ > kPeerForgotten_ns;
  }
  void heard(const sockaddr_in& peer, std::int64_t now_ns) {
    peer_ = peer;
    heard_ns_ = now_ns;
  }

 private:
  sockaddr_in peer_{};
  std::int64_t heard_ns_ = 0;
};

struct WireCounters {
  std::int64_t late = 0;       // answers that left later than a cycle after the packet came
  std::int64_t strangers = 0;  // packets of somebody else while a controller is served
};

class UdpAdapterLoop {
 public:
  UdpAdapterLoop(const UdpAdapterOptions& options, const AdapterSettings& settings, const PacketProtocol& protocol)
      : cycle_ns_{settings.session.cycle_ns},
        recorder_{options.adapter.record, options.program + ' ' + options.adapter.cell},
        adapter_{protocol, settings.session},
        port_{ipv4_address(options.listen)},
        link_{open_lcm(settings.lcm_url)} {}

  // False: nothing moves because of a correction, or no packet came.
  bool turn() {
    const UdpPort::Packet packet = port_.receive(kWait_ms);
    const std::int64_t now = steady_ns();
    take_corrections(link_, recorder_, adapter_, complaints_);
    if (packet.bytes.empty()) return false;
    if (!peer_.serves(packet.from, now)) {
      ++wire_.strangers;
      return corrected_;
    }
    recorder_.put(now, ExchangeKind::packet, text_of(packet.bytes));
    const PacketOutput output = adapter_.packet(packet.bytes, now);
    if (output.why_not != nullptr) complaints_.say(output.why_not, now);
    if (output.answer.empty()) return corrected_;
    peer_.heard(packet.from, now);
    port_.send(packet.from, output.answer);
    if (steady_ns() - packet.arrived_ns > cycle_ns_) ++wire_.late;
    recorder_.put(now, ExchangeKind::answer, output.answer);
    if (output.state) {
      link_.say(*output.state);
      recorder_.put(now, *output.state);
    }
    corrected_ = !output.settled;
    return corrected_;
  }
  // Brings the controller back to its program, for as long as it speaks and no second signal comes.
  void end(const EndSignal& signal) {
    adapter_.end();
    const std::int64_t longest = steady_ns() + kLongestEnd_ns;
    while (turn() && steady_ns() < longest && !signal.came_again()) {
    }
  }

  [[nodiscard]] std::string summary() const {
    return summary_of(adapter_.session().counters(), adapter_.session().follower_counters()) + ", packets bad " +
           std::to_string(adapter_.bad()) + ", of strangers " + std::to_string(wire_.strangers) + ", answers late " +
           std::to_string(wire_.late) + ", late as the controller counts " + std::to_string(adapter_.late_answers()) +
           ", published " + std::to_string(link_.sent());
  }

 private:
  std::int64_t cycle_ns_;
  Complaints complaints_;
  bool corrected_ = false;
  ExchangeRecorder recorder_;
  PacketAdapter adapter_;
  ServedPeer peer_;
  WireCounters wire_;
  UdpPort port_;
  LcmLink link_;
};

}  // namespace

EndSignal::EndSignal(double duration_s) {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGTERM);
  sigaddset(&signals_, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  if (duration_s > 0.0) ends_ns_ = steady_ns() + static_cast<std::int64_t>(duration_s * 1e9);
}

bool EndSignal::came() const { return came_again() || (ends_ns_ > 0 && steady_ns() >= ends_ns_); }

bool EndSignal::came_again() const {
  const timespec at_once{0, 0};
  return sigtimedwait(&signals_, nullptr, &at_once) > 0;
}

void set_up_log(const std::string& program) {
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>(program, std::make_shared<spdlog::sinks::stderr_sink_mt>()));
  spdlog::set_pattern("%H:%M:%S.%e %l %v");
}

void raise_priority() {
  const sched_param raised{kPriority};
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &raised); error != 0)
    spdlog::warn("no real-time priority ({}): answers may be late under load; give CAP_SYS_NICE", std::strerror(error));
}

std::string summary_of(const SessionCounters& session, const FollowerCounters& corrections) {
  const auto text = [](std::int64_t number) { return std::to_string(number); };
  return "cycles " + text(session.cycles) + ", sessions " + text(session.sessions) + ", reports lost " +
         text(session.lost) + ", old " + text(session.old) + ", corrections accepted " + text(corrections.accepted) +
         ", refused " + text(corrections.refused) + ", shadow " + text(corrections.shadow) + ", old " +
         text(corrections.old) + ", lost " + text(corrections.lost) + ", lapsed " + text(corrections.lapsed);
}

void run_udp_adapter(const UdpAdapterOptions& options, const AdapterSettings& settings,
                     const PacketProtocol& protocol) {
  set_up_log(options.program);
  const EndSignal end{options.adapter.duration_s};
  UdpAdapterLoop loop{options, settings, protocol};
  raise_priority();  // after the threads of the link were made: they stay ordinary
  spdlog::info("{} listens on UDP {}, LCM {}", options.program, options.listen, settings.lcm_url);
  while (!end.came()) loop.turn();
  loop.end(end);
  spdlog::info("ended: {}", loop.summary());
}

}  // namespace stillcut
