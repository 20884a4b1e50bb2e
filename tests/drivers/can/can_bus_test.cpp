#include "drivers/can/can_bus.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <thread>
#include <vector>

#include "drivers/files/input_error.hpp"
#include "tests/drivers/can/temporary_file.hpp"

namespace stillcut {
namespace {

TEST(CanBus, RefusesAnUnknownKindAndNamesTheThree) {
  for (const char* bus : {"", "can0", "socketcam:can0", "socketcan:", "log:", "local:"}) {
    EXPECT_EQ(message_of<InputError>([bus] { open_can_bus(bus); }),
              std::string("CAN bus '") + bus + "': write socketcan:IFACE, log:FILE or local:NAME");
  }
}

TEST(CanBus, NamesTheCommandThatStartsAMissingInterface) {
  const std::string error = message_of<ComponentError>([] { open_can_bus("socketcan:can9"); });
  const int socket = ::socket(PF_CAN, SOCK_RAW, 1);
  if (socket >= 0) {
    ::close(socket);
    EXPECT_NE(error.find("socketcan:can9: no such interface; start it with `ip link set can9 up"), std::string::npos);
  } else {
    EXPECT_EQ(
        error,
        "socketcan:can9: this kernel has no CAN sockets; load them with `modprobe can_raw`, or use log: or local:");
  }
}

TEST(LogBus, DeliversTheLogAndThenHasEnded) {
  std::string text = "no frame\n";
  for (int i = 0; i < 100; ++i) text += "(1.0000" + std::to_string(10 + i % 90) + ") can0 123#11\n";
  text += "(2.000000) can0 20000040#0000000000000000\n";
  const TemporaryFile file(text);
  const auto bus = open_can_bus("log:" + file.string());
  EXPECT_EQ(bus->state(), BusState::up);
  std::array<CanFrame, 30> frames;
  std::size_t delivered = 0;
  while (bus->state() != BusState::ended) {
    const std::size_t n = bus->receive(frames);
    ASSERT_GT(n, 0U);
    delivered += n;
  }
  EXPECT_EQ(delivered, 101U);
  EXPECT_EQ(bus->receive(frames), 0U);
  const BusCounters counters = bus->counters();
  EXPECT_EQ(counters.frames, 101);
  EXPECT_EQ(counters.frames_bad, 1);
  EXPECT_EQ(counters.error_frames, 1);
  EXPECT_EQ(counters.bus_off, 1);
  EXPECT_FALSE(bus->send(CanFrame{}));
}

TEST(LogBus, PacedHoldsBackFramesUntilTheirTime) {
  const TemporaryFile file("(1.000000) can0 123#01\n(1.050000) can0 123#02\n(9999.000000) can0 123#03\n");
  const auto bus = open_can_bus("log:" + file.string() + "?speed=0.5");
  std::array<CanFrame, 8> frames;
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(bus->receive(frames), 1U);
  while (bus->receive(frames) == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(100));  // never early
  EXPECT_EQ(frames[0].stamp_ns, 1'050'000'000);
  EXPECT_EQ(bus->receive(frames), 0U);
  EXPECT_EQ(bus->state(), BusState::up);
}

TEST(LogBus, RefusesBadFilesAndSpeeds) {
  EXPECT_EQ(message_of<InputError>([] { open_can_bus("log:/nowhere/x.log"); }),
            "/nowhere/x.log: cannot be opened: No such file or directory");
  const TemporaryFile file("(1.000000) can0 123#01\n");
  for (const char* speed : {"", "x", "0", "-1", "inf", "nan", "1x"}) {
    const std::string bus = "log:" + file.string() + "?speed=" + speed;
    EXPECT_EQ(message_of<InputError>([&bus] { open_can_bus(bus); }),
              "CAN bus '" + bus + "': speed is a number above 0; 1 is real time");
  }
}

}  // namespace
}  // namespace stillcut
