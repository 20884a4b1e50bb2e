// What a service manager is told, heard on a socket of our own: breaks where ready comes before the loop ticks, or the
// watchdog is fed while it does not.
#include "tools/service_notify.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

class ManagerSocket {
 public:
  explicit ManagerSocket(const char* watchdog_us) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string name = (folder_.path() / "notify").string();
    name.copy(address.sun_path, sizeof address.sun_path - 1);
    socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) std::abort();
    ::setenv("NOTIFY_SOCKET", name.c_str(), 1);
    ::setenv("WATCHDOG_USEC", watchdog_us, 1);
    ::unsetenv("WATCHDOG_PID");
  }
  ~ManagerSocket() {
    ::close(socket_);
    ::unsetenv("NOTIFY_SOCKET");
    ::unsetenv("WATCHDOG_USEC");
  }
  ManagerSocket(const ManagerSocket&) = delete;
  ManagerSocket& operator=(const ManagerSocket&) = delete;

  std::vector<std::string> heard() const {
    std::vector<std::string> messages;
    std::array<char, 256> text{};
    for (ssize_t n = 0; (n = ::recv(socket_, text.data(), text.size(), 0)) >= 0;)
      messages.emplace_back(text.data(), static_cast<std::size_t>(n));
    return messages;
  }

 private:
  TempFolder folder_;
  int socket_ = -1;
};

using Messages = std::vector<std::string>;

TEST(ServiceNotify, IsReadyAtTheFirstTickAndFedByTicksAlone) {
  const ManagerSocket manager{"1000000"};
  ServiceNotify service;
  Status status;
  service.progress(0, status, kSecond_ns / 2);
  EXPECT_EQ(manager.heard(), Messages{}) << "the loop has not ticked";
  service.progress(5, status, kSecond_ns * 6 / 10);
  EXPECT_EQ(manager.heard(), (Messages{"READY=1", "WATCHDOG=1"}));
  service.progress(6, status, kSecond_ns * 7 / 10);
  EXPECT_EQ(manager.heard(), Messages{}) << "fed a tenth of a second ago";
  service.progress(7, status, kSecond_ns * 9 / 10);
  EXPECT_EQ(manager.heard(), Messages{"WATCHDOG=1"});
  for (int i = 10; i < 50; ++i) service.progress(7, status, kSecond_ns * i / 10);
  for (const std::string& message : manager.heard()) EXPECT_NE(message, "WATCHDOG=1") << "the loop hangs";
  service.progress(8, status, kSecond_ns * 5);
  EXPECT_EQ(manager.heard(), Messages{"WATCHDOG=1"});
  service.stopping();
  EXPECT_EQ(manager.heard(), Messages{"STOPPING=1"});
}

TEST(ServiceNotify, TellsTheStateInALine) {
  const ManagerSocket manager{""};
  ServiceNotify service;
  const Status status{.state = State::chatter,
                      .mode = RuntimeMode::active,
                      .spindle_speed_rpm = 8500.2,
                      .frames = 1234,
                      .frames_lost = 2};
  service.progress(1, status, kSecond_ns);
  service.progress(2, status, 2 * kSecond_ns);  // the same again says nothing
  EXPECT_EQ(manager.heard(), (Messages{"READY=1", "STATUS=chatter, active, 8500 rpm, 1234 frames, 2 lost"}));
}

TEST(ServiceNotify, SaysNothingWithoutAManager) {
  ServiceNotify service;
  service.progress(1, {}, kSecond_ns);
  service.stopping();
}

}  // namespace
}  // namespace stillcut
