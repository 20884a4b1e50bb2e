#include "adapters/udp_port.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>

#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

// Kernel arrival stamps are of CLOCK_REALTIME; how long ago that was is what counts.
std::int64_t arrival_ns(const msghdr& message) {
  timespec real{}, stamp{};
  const std::int64_t now = steady_ns();
  for (cmsghdr* head = CMSG_FIRSTHDR(&message); head != nullptr;
       head = CMSG_NXTHDR(const_cast<msghdr*>(&message), head)) {
    if (head->cmsg_level != SOL_SOCKET || head->cmsg_type != SCM_TIMESTAMPNS) continue;
    std::memcpy(&stamp, CMSG_DATA(head), sizeof stamp);
    clock_gettime(CLOCK_REALTIME, &real);
    const std::int64_t ago = (real.tv_sec - stamp.tv_sec) * 1'000'000'000 + (real.tv_nsec - stamp.tv_nsec);
    if (ago > 0 && ago < 1'000'000'000) return now - ago;
  }
  return now;
}

}  // namespace

std::int64_t steady_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

std::optional<sockaddr_in> read_ipv4_address(const std::string& text) {
  const auto colon = text.rfind(':');
  const std::string host = colon == std::string::npos ? "0.0.0.0" : text.substr(0, colon);
  const std::string_view port = std::string_view{text}.substr(colon == std::string::npos ? 0 : colon + 1);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  std::uint16_t number = 0;
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), number);
  if (error != std::errc{} || end != port.data() + port.size() ||
      inet_pton(AF_INET, host.c_str(), &address.sin_addr) != 1)
    return std::nullopt;
  address.sin_port = htons(number);
  return address;
}

sockaddr_in ipv4_address(const std::string& text) { return read_ipv4_address(text).value(); }

bool same_peer(const sockaddr_in& a, const sockaddr_in& b) {
  return a.sin_addr.s_addr == b.sin_addr.s_addr && a.sin_port == b.sin_port;
}

UdpPort::UdpPort(const sockaddr_in& address) : socket_{socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)} {
  const int on = 1;
  setsockopt(socket_, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
  if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return;
  const std::string why = std::strerror(errno);
  close(socket_);
  throw ComponentError("cannot listen on UDP port " + std::to_string(ntohs(address.sin_port)) + ": " + why +
                       "; is another adapter running, or the address not this host's?");
}

UdpPort::~UdpPort() { close(socket_); }

UdpPort::Packet UdpPort::receive(int wait_ms) {
  pollfd ready{socket_, POLLIN, 0};
  if (poll(&ready, 1, wait_ms) <= 0) return {};
  Packet packet;
  iovec part{buffer_.data(), buffer_.size()};
  alignas(cmsghdr) std::array<char, 256> control{};
  msghdr message{};
  message.msg_name = &packet.from;
  message.msg_namelen = sizeof packet.from;
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t size = recvmsg(socket_, &message, MSG_DONTWAIT);
  if (size <= 0) return {};
  packet.bytes = {buffer_.data(), static_cast<std::size_t>(size)};
  packet.arrived_ns = arrival_ns(message);
  return packet;
}

bool UdpPort::send(const sockaddr_in& to, std::string_view bytes) {
  return sendto(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT, reinterpret_cast<const sockaddr*>(&to), sizeof to) ==
         static_cast<ssize_t>(bytes.size());
}

}  // namespace stillcut
