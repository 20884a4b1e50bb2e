// Runs an adapter: sockets, threads, signals and log around the code that decides.
#pragma once

#include <csignal>
#include <cstdint>
#include <string>

#include "adapters/adapter_options.hpp"
#include "adapters/packet_adapter.hpp"

namespace stillcut {

inline constexpr std::int64_t kLongestEnd_ns = 20'000'000'000;  // for the way back to the program

// SIGINT and SIGTERM, kept from killing the process: asked for instead. Make it before any thread.
class EndSignal {
 public:
  explicit EndSignal(double duration_s);
  [[nodiscard]] bool came() const;        // a signal, or the end of the duration
  [[nodiscard]] bool came_again() const;  // a signal

 private:
  sigset_t signals_{};
  std::int64_t ends_ns_ = 0;  // 0: never by itself
};

void set_up_log(const std::string& program);

// Asks for a fixed priority of the calling thread, so that an answer is not late; says what mends a refusal.
void raise_priority();

// What was counted, for the log.
std::string summary_of(const SessionCounters& session, const FollowerCounters& corrections);

struct UdpAdapterOptions {
  AdapterOptions adapter;
  std::string program;
  std::string listen;  // ADDRESS:PORT or PORT
};

// Until a signal or the end of the duration. Throws InputError and ComponentError before it listens; after that nothing
// that comes in can end it.
void run_udp_adapter(const UdpAdapterOptions& options, const AdapterSettings& settings, const PacketProtocol& protocol);

}  // namespace stillcut
