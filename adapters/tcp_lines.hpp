// Lines over TCP: what linuxcncrsh and its clients talk through.
#pragma once

#include <netinet/in.h>

#include <optional>
#include <string>
#include <string_view>

namespace stillcut {

class TcpLines {
 public:
  explicit TcpLines(int socket) : socket_{socket} {}
  ~TcpLines();
  TcpLines(const TcpLines&) = delete;
  TcpLines& operator=(const TcpLines&) = delete;

  // The next whole line without its end, empty ones left out; nothing within the time, or when the other side has gone.
  std::optional<std::string> next(int wait_ms);
  bool send(std::string_view bytes);  // false: the other side has gone
  [[nodiscard]] bool gone() const { return gone_; }

 private:
  std::optional<std::string> buffered();

  int socket_;
  std::string received_;
  bool gone_ = false;
};

// A connected socket; -1 when nobody listens there, or too long.
int tcp_connect(const sockaddr_in& address, int wait_ms);
// A listening socket. Throws ComponentError.
int tcp_listen(const sockaddr_in& address);
// A client's socket; -1: none within the time.
int tcp_accept(int listening, int wait_ms);

}  // namespace stillcut
