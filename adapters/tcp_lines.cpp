#include "adapters/tcp_lines.hpp"

#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

constexpr std::size_t kLongestLine = 4096;
constexpr std::string_view kLineEnds = "\r\n";

void send_at_once(int socket) {
  const int on = 1;
  setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

}  // namespace

TcpLines::~TcpLines() { close(socket_); }

std::optional<std::string> TcpLines::buffered() {
  received_.erase(0, std::min(received_.find_first_not_of(kLineEnds), received_.size()));
  const auto end = received_.find_first_of(kLineEnds);
  if (end == std::string::npos) {
    if (received_.size() > kLongestLine) received_.clear();  // no line of this protocol
    return std::nullopt;
  }
  std::string line = received_.substr(0, end);
  received_.erase(0, end);
  return line;
}

std::optional<std::string> TcpLines::next(int wait_ms) {
  if (auto line = buffered()) return line;
  pollfd ready{socket_, POLLIN, 0};
  if (gone_ || poll(&ready, 1, wait_ms) <= 0) return std::nullopt;
  std::array<char, kLongestLine> bytes{};
  const ssize_t size = recv(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT);
  if (size == 0 || (size < 0 && errno != EAGAIN && errno != EINTR)) gone_ = true;
  if (size <= 0) return std::nullopt;
  received_.append(bytes.data(), static_cast<std::size_t>(size));
  return buffered();
}

bool TcpLines::send(std::string_view bytes) {
  while (!bytes.empty() && !gone_) {
    const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) gone_ = true;
    if (sent > 0) bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return !gone_;
}

int tcp_connect(const sockaddr_in& address, int wait_ms) {
  const int connecting = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  int error = 0;
  socklen_t size = sizeof error;
  pollfd ready{connecting, POLLOUT, 0};
  const bool at_once = connect(connecting, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  if (!at_once && (errno != EINPROGRESS || poll(&ready, 1, wait_ms) <= 0 ||
                   getsockopt(connecting, SOL_SOCKET, SO_ERROR, &error, &size) != 0 || error != 0)) {
    close(connecting);
    return -1;
  }
  const timeval longest{1, 0};  // of a send: from here on it may wait, but not for ever
  setsockopt(connecting, SOL_SOCKET, SO_SNDTIMEO, &longest, sizeof longest);
  send_at_once(connecting);
  return connecting;
}

int tcp_listen(const sockaddr_in& address) {
  const int listening = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int on = 1;
  setsockopt(listening, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (bind(listening, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 && listen(listening, 4) == 0)
    return listening;
  const std::string why = std::strerror(errno);
  close(listening);
  throw ComponentError("cannot listen on TCP port " + std::to_string(ntohs(address.sin_port)) + ": " + why);
}

int tcp_accept(int listening, int wait_ms) {
  pollfd ready{listening, POLLIN, 0};
  if (poll(&ready, 1, wait_ms) <= 0) return -1;
  const int accepted = accept4(listening, nullptr, nullptr, SOCK_CLOEXEC);
  if (accepted >= 0) send_at_once(accepted);
  return accepted;
}

}  // namespace stillcut
