#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <memory>
#include <thread>
#include <vector>

#include "drivers/can/can_bus.hpp"
#include "drivers/can/local_ring.hpp"
#include "drivers/files/input_error.hpp"
#include "tests/drivers/can/temporary_file.hpp"

namespace stillcut {
namespace {

std::string unique_name(const char* test) { return std::string(test) + "-" + std::to_string(::getpid()); }

bool memory_exists(const std::string& name) {
  const int descriptor = ::shm_open(("/stillcut-can-1-" + name).c_str(), O_RDWR, 0);
  if (descriptor >= 0) ::close(descriptor);
  return descriptor >= 0;
}

CanFrame numbered(std::uint32_t number) {
  CanFrame frame;
  frame.id = 0x123;
  frame.fd = true;
  frame.length = 64;
  for (std::size_t i = 0; i < 16; ++i) std::memcpy(frame.data.data() + 4 * i, &number, 4);
  return frame;
}

std::uint32_t number_of(const CanFrame& frame) {
  std::uint32_t number = 0;
  std::memcpy(&number, frame.data.data(), 4);
  for (std::size_t i = 1; i < 16; ++i) {  // a torn frame would mix two numbers
    EXPECT_EQ(std::memcmp(frame.data.data() + 4 * i, &number, 4), 0);
  }
  return number;
}

// Receives until `count` frames have come or the other side fell silent.
std::vector<CanFrame> receive_some(CanBus& bus, std::size_t count) {
  std::vector<CanFrame> all;
  std::array<CanFrame, 32> frames;
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (all.size() < count && std::chrono::steady_clock::now() < give_up) {
    const std::size_t n = bus.receive(frames);
    all.insert(all.end(), frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(n));
    if (n == 0) std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  return all;
}

TEST(LocalBus, DeliversToAllOthersAndNotToTheSender) {
  const std::string bus = "local:" + unique_name("all");
  const auto a = open_can_bus(bus), b = open_can_bus(bus), c = open_can_bus(bus);
  for (std::uint32_t i = 0; i < 100; ++i) ASSERT_TRUE(a->send(numbered(i)));
  ASSERT_TRUE(b->send(numbered(1000)));
  std::array<CanFrame, 200> frames;
  ASSERT_EQ(a->receive(frames), 1U);
  EXPECT_EQ(number_of(frames[0]), 1000U);
  ASSERT_EQ(b->receive(frames), 100U);
  ASSERT_EQ(c->receive(frames), 101U);
  for (std::uint32_t i = 0; i < 100; ++i) EXPECT_EQ(number_of(frames[i]), i);
  EXPECT_EQ(frames[0].id, 0x123U);
  EXPECT_TRUE(frames[0].fd);
  EXPECT_GT(frames[0].stamp_ns, 1'600'000'000'000'000'000);
  EXPECT_EQ(frames[0].stamp_ns % 1'000, 0);
  EXPECT_EQ(c->counters().frames, 101);
  EXPECT_EQ(c->counters().dropped, 0);
}

TEST(LocalBus, GivesANewMemberOnlyWhatIsSentFromThenOn) {
  const std::string bus = "local:" + unique_name("late");
  const auto a = open_can_bus(bus);
  a->send(numbered(1));
  const auto b = open_can_bus(bus);
  a->send(numbered(2));
  std::array<CanFrame, 4> frames;
  ASSERT_EQ(b->receive(frames), 1U);
  EXPECT_EQ(number_of(frames[0]), 2U);
}

TEST(LocalBus, CountsWhatASlowReceiverLost) {
  const std::string bus = "local:" + unique_name("slow");
  const auto a = open_can_bus(bus), b = open_can_bus(bus);
  constexpr std::uint32_t kSent = 40'000;
  for (std::uint32_t i = 0; i < kSent; ++i) ASSERT_TRUE(a->send(numbered(i)));
  std::array<CanFrame, 256> frames;
  std::int64_t received = 0, last = -1;
  for (std::size_t n = b->receive(frames); n > 0; n = b->receive(frames)) {
    for (std::size_t i = 0; i < n; ++i) {
      ASSERT_GT(number_of(frames[i]), last);
      last = number_of(frames[i]);
    }
    received += static_cast<std::int64_t>(n);
  }
  EXPECT_EQ(last, kSent - 1);
  EXPECT_GT(received, 0);
  EXPECT_GT(b->counters().dropped, 0);
  EXPECT_EQ(received + b->counters().dropped, kSent);
}

TEST(LocalBus, CarriesFramesBetweenProcessesAndOutlivesASendersDeath) {
  const std::string name = unique_name("fork");
  const auto bus = open_can_bus("local:" + name);
  for (int life = 0; life < 2; ++life) {  // the second sender comes after the first was killed
    const pid_t child = ::fork();
    if (child == 0) {
      const auto sender = open_can_bus("local:" + name);
      for (std::uint32_t i = 0; i < 2'000; ++i) sender->send(numbered(i));
      ::kill(::getpid(), SIGKILL);
    }
    const std::vector<CanFrame> frames = receive_some(*bus, 2'000);
    ASSERT_EQ(frames.size(), 2'000U);
    for (std::uint32_t i = 0; i < 2'000; ++i) ASSERT_EQ(number_of(frames[i]), i);
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status));
  }
  EXPECT_EQ(bus->counters().dropped, 0);
}

TEST(LocalBus, RemovesItsMemoryWithItsLastMember) {
  const std::string name = unique_name("last");
  auto a = open_can_bus("local:" + name);
  auto b = open_can_bus("local:" + name);
  a.reset();
  EXPECT_TRUE(memory_exists(name));
  b.reset();
  EXPECT_FALSE(memory_exists(name));
}

TEST(LocalBus, CleansUpAfterMembersThatWereKilled) {
  const std::string name = unique_name("killed");
  const pid_t child = ::fork();
  if (child == 0) {
    const auto member = open_can_bus("local:" + name);
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(memory_exists(name));
  open_can_bus("local:" + name).reset();
  EXPECT_FALSE(memory_exists(name));
}

TEST(LocalBus, RefusesNamesAndMemoryThatAreNotItsOwn) {
  for (const char* name : {"a/b", "..", "a b"}) {
    EXPECT_EQ(message_of<InputError>([name] { open_can_bus(std::string("local:") + name); }),
              std::string("CAN bus 'local:") + name + "': a name has up to 64 letters, digits, '-' and '_'");
  }
  const std::string name = unique_name("foreign");
  const int descriptor = ::shm_open(("/stillcut-can-1-" + name).c_str(), O_RDWR | O_CREAT, 0600);
  ASSERT_EQ(::ftruncate(descriptor, 100), 0);
  EXPECT_EQ(message_of<ComponentError>([&name] { open_can_bus("local:" + name); }),
            "local bus: shared memory /dev/shm/stillcut-can-1-" + name + " has not the expected size; remove it");
  ::close(descriptor);
  ::shm_unlink(("/stillcut-can-1-" + name).c_str());
}

// A writer that stopped between taking its ticket and finishing the slot (here: at the slot's first use and never
// again).
TEST(LocalRing, PassesASlotWhoseWriterDied) {
  const auto ring = std::make_unique<LocalRing>();
  std::uint64_t place = ring->end(), lost = 0, total_lost = 0;
  std::uint32_t member = 0;
  CanFrame frame;
  ASSERT_TRUE(ring->write(numbered(0), 1));
  ASSERT_TRUE(ring->begin_write().has_value());  // and no more
  for (std::uint32_t i = 1; i <= kLocalPatience + 10; ++i) ASSERT_TRUE(ring->write(numbered(i), 1));
  std::uint32_t next = 0;
  for (;;) {
    const LocalRing::Read result = ring->read(place, frame, member, lost);
    if (result == LocalRing::Read::nothing) break;
    if (result == LocalRing::Read::lost) {
      total_lost += lost;
      continue;
    }
    ASSERT_EQ(number_of(frame), next++);
  }
  EXPECT_EQ(total_lost, 1U);
  EXPECT_EQ(next, kLocalPatience + 11);
}

// Two writers and two readers at once: every reader sees each writer's frames whole and in order, or counts them as
// lost.
TEST(LocalRing, NeverDeliversATornFrame) {
  const auto ring = std::make_unique<LocalRing>();
  constexpr std::uint32_t kEach = 60'000;
  const auto write = [&ring](std::uint32_t member) {
    for (std::uint32_t i = 1; i <= kEach; ++i) ring->write(numbered(i), member);
  };
  const auto read = [&ring] {
    std::uint64_t place = 0, passed = 0;
    std::array<std::uint32_t, 3> last{};
    while (place < 2 * kEach) {
      CanFrame frame;
      std::uint32_t member = 0;
      std::uint64_t lost = 0;
      const LocalRing::Read result = ring->read(place, frame, member, lost);
      passed += result == LocalRing::Read::lost ? lost : result == LocalRing::Read::frame ? 1 : 0;
      if (result != LocalRing::Read::frame) continue;
      const std::uint32_t number = number_of(frame);
      EXPECT_GT(number, last.at(member));
      last.at(member) = number;
    }
    EXPECT_EQ(place, passed);
  };
  std::vector<std::thread> threads;
  threads.emplace_back(read);
  threads.emplace_back(read);
  threads.emplace_back(write, 0);
  threads.emplace_back(write, 1);
  threads[2].join();
  threads[3].join();
  // A writer that stood still for a whole lap made the other one fail; readers pass such places once later frames come.
  for (std::uint32_t i = 1; i <= kLocalPatience + 1; ++i) ring->write(numbered(i), 2);
  threads[0].join();
  threads[1].join();
}

}  // namespace
}  // namespace stillcut
