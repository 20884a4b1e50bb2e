// UDP packets and TCP lines on the loopback interface.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "adapters/exchange_log.hpp"
#include "adapters/tcp_lines.hpp"
#include "adapters/udp_port.hpp"
#include "drivers/files/input_error.hpp"
#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

constexpr int kPatience_ms = 10'000;  // a broken link, not a slow machine

// A loopback address with a port that was free a moment ago.
sockaddr_in free_address(int type) {
  const int probe = socket(AF_INET, type, 0);
  sockaddr_in address = ipv4_address("127.0.0.1:0");
  socklen_t size = sizeof address;
  bind(probe, reinterpret_cast<const sockaddr*>(&address), size);
  getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size);
  close(probe);
  return address;
}

TEST(Addresses, AreAPortOrAnAddressWithAPort) {
  const auto address = read_ipv4_address("192.168.1.2:49152");
  ASSERT_TRUE(address);
  EXPECT_EQ(ntohl(address->sin_addr.s_addr), 0xC0A80102U);
  EXPECT_EQ(ntohs(address->sin_port), 49152);
  EXPECT_EQ(read_ipv4_address("6510")->sin_addr.s_addr, INADDR_ANY);
  for (const char* text : {"", "x", "1.2.3:5", "1.2.3.4:", "1.2.3.4:x", "70000", "-1", "host:1", "1.2.3.4:1 "})
    EXPECT_FALSE(read_ipv4_address(text)) << text;
}

TEST(UdpPort, CarriesPacketsWithSenderAndTimeOfArrival) {
  const sockaddr_in address = free_address(SOCK_DGRAM);
  UdpPort server{address}, client{ipv4_address("127.0.0.1:0")};
  EXPECT_TRUE(server.receive(0).bytes.empty());
  const std::int64_t before = steady_ns();
  ASSERT_TRUE(client.send(address, "question"));
  const auto question = server.receive(kPatience_ms);
  EXPECT_EQ(text_of(question.bytes), "question");
  EXPECT_LE(question.arrived_ns, steady_ns());
  EXPECT_GE(question.arrived_ns, before - 1'000'000'000);
  ASSERT_TRUE(server.send(question.from, "answer"));
  const auto answer = client.receive(kPatience_ms);
  EXPECT_EQ(text_of(answer.bytes), "answer");
  EXPECT_TRUE(same_peer(answer.from, address));
  EXPECT_FALSE(same_peer(answer.from, question.from));
}

TEST(UdpPort, SaysThatAPortIsTaken) {
  const sockaddr_in address = free_address(SOCK_DGRAM);
  const UdpPort first{address};
  const std::string message = message_of<ComponentError>([&] { UdpPort{address}; });
  EXPECT_NE(message.find("cannot listen on UDP port " + std::to_string(ntohs(address.sin_port))), std::string::npos);
}

TEST(TcpLines, PartsLinesHoweverTheyCome) {
  const sockaddr_in address = free_address(SOCK_STREAM);
  EXPECT_LT(tcp_connect(address, 100), 0);  // nobody listens yet
  const int listening = tcp_listen(address);
  EXPECT_LT(tcp_accept(listening, 0), 0);
  TcpLines client{tcp_connect(address, kPatience_ms)};
  {
    TcpLines server{tcp_accept(listening, kPatience_ms)};
    EXPECT_FALSE(server.next(0));
    client.send("one\r\ntwo\n\rth");
    EXPECT_EQ(server.next(kPatience_ms), "one");
    EXPECT_EQ(server.next(kPatience_ms), "two");
    EXPECT_FALSE(server.next(0));
    client.send("ree\n");
    std::optional<std::string> line;
    while (!(line = server.next(kPatience_ms))) ASSERT_FALSE(server.gone());
    EXPECT_EQ(line, "three");
    for (int i = 0; i < 20; ++i) client.send(std::string(1000, 'x'));  // a line without an end is dropped
    client.send("\nlast\n");
    for (line.reset(); line != "last"; line = server.next(kPatience_ms)) ASSERT_FALSE(server.gone());
  }
  EXPECT_FALSE(client.next(kPatience_ms));
  EXPECT_TRUE(client.gone());
  while (client.send("more")) {
  }
  close(listening);
}

}  // namespace
}  // namespace stillcut
