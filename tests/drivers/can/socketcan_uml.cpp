// The socketcan bus against a real kernel's CAN sockets. A program of its own: it needs an interface vcan0 (mtu 72),
// the right to add and remove interfaces, and `ip` and `cansend`: root on a spare machine, or a guest of User-mode
// Linux.
#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "drivers/can/can_bus.hpp"
#include "drivers/can/can_socket.hpp"
#include "drivers/files/input_error.hpp"
#include "tests/drivers/can/temporary_file.hpp"

namespace stillcut {
namespace {

using Clock = std::chrono::steady_clock;

void run(const std::string& command) { ASSERT_EQ(std::system(command.c_str()), 0) << command; }

void make_interface(const std::string& name, const std::string& option = "") {
  run("ip link add " + name + " " + option + " type vcan");
  run("ip link set " + name + " mtu 72 up");
}

bool wait_until(const std::function<bool()>& condition) {
  const auto give_up = Clock::now() + std::chrono::seconds(20);
  while (!condition()) {
    if (Clock::now() > give_up) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

std::vector<CanFrame> receive_all(CanBus& bus) {
  std::vector<CanFrame> all;
  std::array<CanFrame, 50> frames;
  for (std::size_t n = bus.receive(frames); n > 0; n = bus.receive(frames)) {
    all.insert(all.end(), frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(n));
  }
  return all;
}

CanFrame fd_frame(std::uint8_t number) {
  CanFrame frame;
  frame.id = 0x120;
  frame.fd = true;
  frame.fd_flags = 1;
  frame.length = 64;
  for (std::uint8_t& byte : frame.data) byte = number++;
  return frame;
}

std::int64_t now_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  return now.tv_sec * 1'000'000'000LL + now.tv_nsec;
}

TEST(SocketCan, DeliversFdAndClassicFramesWithKernelStamps) {
  const auto a = open_can_bus("socketcan:vcan0"), b = open_can_bus("socketcan:vcan0");
  EXPECT_EQ(b->state(), BusState::up);
  const std::int64_t before = now_ns();
  for (std::uint8_t i = 0; i < 100; ++i) ASSERT_TRUE(a->send(fd_frame(i)));
  run("cansend vcan0 18FEF100#1122334455667788");
  run("cansend vcan0 123#R");
  const std::int64_t after = now_ns();
  const std::vector<CanFrame> frames = receive_all(*b);
  ASSERT_EQ(frames.size(), 102U);
  std::int64_t last = before / 1'000 * 1'000;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_GE(frames[i].stamp_ns, last);
    EXPECT_LE(frames[i].stamp_ns, after);
    EXPECT_EQ(frames[i].stamp_ns % 1'000, 0);
    last = frames[i].stamp_ns;
    if (i >= 100) continue;
    EXPECT_TRUE(frames[i].fd);
    EXPECT_EQ(frames[i].fd_flags & 3, 1);
    EXPECT_EQ(frames[i].length, 64);
    EXPECT_EQ(frames[i].data, fd_frame(static_cast<std::uint8_t>(i)).data);
  }
  EXPECT_EQ(frames[100].id, 0x18FEF100U | CanFrame::kExtended);
  EXPECT_FALSE(frames[100].fd);
  EXPECT_EQ(frames[100].length, 8);
  EXPECT_EQ(frames[101].id, 0x123U | CanFrame::kRemote);
  EXPECT_EQ(b->counters().frames, 102);
  EXPECT_EQ(b->counters().dropped, 0);
  EXPECT_EQ(receive_all(*a).size(), 2U) << "a sender does not hear itself";
}

TEST(SocketCan, LetsThroughOnlyTheIdentifiersAskedForAndErrorFrames) {
  const std::vector<std::uint32_t> ids = {0x120, 0x18FEF100U | CanFrame::kExtended};
  const auto bus = open_can_bus("socketcan:vcan0", ids);
  for (const char* frame :
       {"120#01", "121#01", "18FEF100#01", "18FEF101#01", "00000120#01", "120#R", "20000040#0000000000000000"}) {
    run(std::string("cansend vcan0 ") + frame);
  }
  const std::vector<CanFrame> frames = receive_all(*bus);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0].id, ids[0]);
  EXPECT_EQ(frames[1].id, ids[1]);
  EXPECT_TRUE(frames[2].is_error());
}

TEST(SocketCan, DeliversAndCountsErrorFrames) {
  const auto bus = open_can_bus("socketcan:vcan0");
  for (const char* frame : {"20000040#0000000000000000", "20000004#0008000000000000", "20000100#0000000000000000",
                            "20000020#0000000000000000"}) {
    run(std::string("cansend vcan0 ") + frame);
  }
  const std::vector<CanFrame> frames = receive_all(*bus);
  ASSERT_EQ(frames.size(), 4U);
  for (const CanFrame& frame : frames) EXPECT_TRUE(frame.is_error());
  EXPECT_EQ(bus->counters().error_frames, 4);
  EXPECT_EQ(bus->counters().bus_off, 1);
}

// More than the receive buffer holds: what was delivered and what the kernel says it dropped is what was sent. The
// kernel tells of drops with the first frame that comes after them.
TEST(SocketCan, CountsEveryFrameOfAFlood) {
  const auto sender = open_can_bus("socketcan:vcan0"), bus = open_can_bus("socketcan:vcan0");
  constexpr int kSent = 40'000;
  int sent = 0;
  for (int i = 0; i < kSent; ++i) sent += sender->send(fd_frame(static_cast<std::uint8_t>(i))) ? 1 : 0;
  auto received = static_cast<std::int64_t>(receive_all(*bus).size());
  ASSERT_TRUE(sender->send(fd_frame(0)));
  received += static_cast<std::int64_t>(receive_all(*bus).size());
  EXPECT_GT(bus->counters().dropped, 0);
  EXPECT_EQ(received + bus->counters().dropped, sent + 1);
  RecordProperty("received", std::to_string(received));
  std::printf("flood: %d sent, %lld received, %lld dropped\n", sent, static_cast<long long>(received),
              static_cast<long long>(bus->counters().dropped));
}

TEST(SocketCan, GoesOnAfterTheInterfaceWasDown) {
  const auto sender = open_can_bus("socketcan:vcan0"), bus = open_can_bus("socketcan:vcan0");
  run("ip link set vcan0 down");
  EXPECT_TRUE(wait_until([&] { return bus->receive({}) == 0 && bus->state() == BusState::down; }));
  EXPECT_TRUE(receive_all(*bus).empty());
  EXPECT_EQ(bus->state(), BusState::down);
  EXPECT_FALSE(sender->send(fd_frame(0)));
  run("ip link set vcan0 up");
  EXPECT_TRUE(wait_until([&] { return bus->state() == BusState::up; }));
  EXPECT_TRUE(sender->send(fd_frame(0)));
  EXPECT_EQ(receive_all(*bus).size(), 1U);
  EXPECT_EQ(bus->counters().reopened, 0);
}

TEST(SocketCan, OpensOnAnInterfaceThatIsStillDown) {
  run("ip link set vcan0 down");
  const auto bus = open_can_bus("socketcan:vcan0");
  EXPECT_EQ(bus->state(), BusState::down);
  run("ip link set vcan0 up");
  EXPECT_TRUE(wait_until([&] { return bus->state() == BusState::up; }));
  run("cansend vcan0 123#01");
  EXPECT_EQ(receive_all(*bus).size(), 1U);
}

TEST(SocketCan, ReopensAnInterfaceThatWasRemovedAndCameBack) {
  make_interface("vcan7");
  const auto bus = open_can_bus("socketcan:vcan7");
  for (int life = 1; life <= 3; ++life) {
    run("ip link del vcan7");
    EXPECT_TRUE(wait_until([&] { return receive_all(*bus).empty() && bus->state() == BusState::gone; }));
    make_interface("vcan7", life == 1 ? "" : "index 4242");  // from life 2 to 3 its number stays the same
    EXPECT_TRUE(wait_until(
        [&] { return receive_all(*bus).empty() && bus->state() == BusState::up && bus->counters().reopened == life; }));
    run("cansend vcan7 123##1" + std::string(128, 'A'));
    const std::vector<CanFrame> frames = receive_all(*bus);
    ASSERT_EQ(frames.size(), 1U) << "life " << life;
    EXPECT_EQ(frames[0].length, 64);
    EXPECT_EQ(bus->counters().reopened, life);
  }
  run("ip link del vcan7");
}

// Also when nobody received while the interface was away, so that the socket told nobody.
TEST(SocketCan, ReopensWithoutHavingSeenTheError) {
  make_interface("vcan8");
  const auto bus = open_can_bus("socketcan:vcan8");
  run("ip link del vcan8");
  make_interface("vcan8");
  EXPECT_TRUE(wait_until([&] { return bus->receive({}) == 0 && bus->counters().reopened == 1; }));
  run("cansend vcan8 123#01");
  EXPECT_EQ(receive_all(*bus).size(), 1U);
  run("ip link del vcan8");
}

TEST(SocketCan, NamesTheCommandForAMissingInterface) {
  const std::string error = message_of<ComponentError>([] { open_can_bus("socketcan:can9"); });
  EXPECT_EQ(error.find("socketcan:can9: no such interface; start it with `ip link set can9 up"), 0U) << error;
}

}  // namespace
}  // namespace stillcut

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
