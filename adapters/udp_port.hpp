// A UDP socket: binds or calls, waits for packets, tells when and from whom each came.
#pragma once

#include <netinet/in.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace stillcut {

// Monotonic nanoseconds, the clock of all that an adapter does.
std::int64_t steady_ns();

// "ADDRESS:PORT" in numbers, or "49152" for every address of this host; nothing where it is neither.
std::optional<sockaddr_in> read_ipv4_address(const std::string& text);
// The same of a text that was checked.
sockaddr_in ipv4_address(const std::string& text);

class UdpPort {
 public:
  // Listens at `address`; 0 as the port: any that is free. Throws ComponentError.
  explicit UdpPort(const sockaddr_in& address);
  ~UdpPort();
  UdpPort(const UdpPort&) = delete;
  UdpPort& operator=(const UdpPort&) = delete;

  // The next packet, when one is there within the time; its bytes stay valid until the next call. Empty: none.
  struct Packet {
    std::span<const std::uint8_t> bytes;
    std::int64_t arrived_ns = 0;
    sockaddr_in from{};
  };
  Packet receive(int wait_ms);
  bool send(const sockaddr_in& to, std::string_view bytes);

 private:
  int socket_ = -1;
  std::array<std::uint8_t, 65536> buffer_{};
};

bool same_peer(const sockaddr_in& a, const sockaddr_in& b);

}  // namespace stillcut
