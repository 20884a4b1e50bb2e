// socketcan:IFACE: a CAN interface of the Linux kernel. The real-time thread reads the socket; an ordinary thread
// watches the interface and, after it was removed and came back, hands over a new socket.
//
// Handing over. Who owns a descriptor may use and close it:
//   watcher opens one, then       incoming_.store(fd, release)       it is the receiver's from the moment it takes it
//   receiver, at its next call    incoming_.exchange(-1, acquire)    -> its own descriptor_
//                                 retired_.store(old, release)       it is the watcher's again, which closes it
// The watcher hands over the next one only when incoming_ and retired_ are both -1, so that neither store can overwrite
// a descriptor. The receiver's part is wait-free and makes no system call. In between, the old descriptor stays open:
// its receive calls return nothing.
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

#include "drivers/can/bus_kinds.hpp"
#include "drivers/can/can_socket.hpp"
#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

constexpr auto kWatchPeriod = std::chrono::milliseconds(100);
constexpr int kNoDescriptor = -1;

BusState bus_state(InterfaceState state) {
  switch (state) {
    case InterfaceState::up:
      return BusState::up;
    case InterfaceState::down:
      return BusState::down;
    case InterfaceState::gone:
      break;
  }
  return BusState::gone;
}

class SocketCanBus final : public CanBus {
 public:
  SocketCanBus(std::string interface, std::span<const std::uint32_t> ids)
      : interface_(std::move(interface)), ids_(ids.begin(), ids.end()), index_(interface_index(interface_)) {
    descriptor_ = open_can_socket(index_, ids_);
    if (descriptor_ < 0) throw ComponentError("socketcan:" + interface_ + ": " + std::strerror(errno));
    state_.store(bus_state(interface_state(interface_)), std::memory_order_relaxed);
    watcher_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
  }

  ~SocketCanBus() override {
    watcher_.request_stop();
    watcher_.join();
    for (const int descriptor : {descriptor_, incoming_.load(), retired_.load()}) {
      if (descriptor != kNoDescriptor) ::close(descriptor);
    }
  }

  SocketCanBus(const SocketCanBus&) = delete;
  SocketCanBus& operator=(const SocketCanBus&) = delete;

  std::size_t receive(std::span<CanFrame> frames) noexcept override {
    take_new_descriptor();
    std::size_t n = 0;
    bool told_down = false;
    while (n < frames.size()) {
      const std::span<CanFrame> room = frames.subspan(n);
      const CanBatch::Result result = batch_.receive(descriptor_, room);
      if (result.received == 0) {
        note_error(result.error);
        // "Down" comes once and ahead of the frames, also when the interface is up again by now.
        if (result.error != ENETDOWN || std::exchange(told_down, true)) break;
        continue;
      }
      for (std::size_t i = 0; i < result.frames; ++i) counted_.delivered(room[i]);
      counted_.dropped.add(result.dropped);
      counted_.frames_bad.add(static_cast<std::int64_t>(result.received - result.frames));
      n += result.frames;
      if (result.received < CanBatch::kFrames) break;  // nothing more is waiting
    }
    return n;
  }

  bool send(const CanFrame& frame) noexcept override {
    take_new_descriptor();
    return send_frame(descriptor_, frame);
  }

  [[nodiscard]] BusState state() const noexcept override { return state_.load(std::memory_order_relaxed); }
  [[nodiscard]] BusCounters counters() const noexcept override { return counted_.copy(); }

 private:
  void take_new_descriptor() noexcept {
    if (incoming_.load(std::memory_order_relaxed) == kNoDescriptor) return;
    const int old = std::exchange(descriptor_, incoming_.exchange(kNoDescriptor, std::memory_order_acquire));
    retired_.store(old, std::memory_order_release);
    lost_.store(false, std::memory_order_relaxed);
    batch_.reset();
    counted_.reopened.add(1);
  }

  // Down is told once by the socket (ENETDOWN), removal once too (ENODEV); the watcher finds both as well, within its
  // period, and it alone tells when they are over.
  void note_error(int error) noexcept {
    if (error == ENETDOWN) state_.store(BusState::down, std::memory_order_relaxed);
    if (error != ENODEV) return;
    state_.store(BusState::gone, std::memory_order_relaxed);
    lost_.store(true, std::memory_order_relaxed);  // also when the new interface gets the old one's number
  }

  void watch(const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any wake;
    std::unique_lock lock(mutex);
    while (!wake.wait_for(lock, stop, kWatchPeriod, [] { return false; }) && !stop.stop_requested()) {
      const int old = retired_.exchange(kNoDescriptor, std::memory_order_acquire);
      if (old != kNoDescriptor) ::close(old);
      const unsigned index = interface_index(interface_);
      const bool replaced = index != index_ || lost_.load(std::memory_order_relaxed);
      if (index != 0 && replaced) reopen(index);
      // A removed and re-created interface is gone until its new socket is handed over.
      const bool ours = index != 0 && index == index_;
      state_.store(ours ? bus_state(interface_state(interface_)) : BusState::gone, std::memory_order_relaxed);
    }
  }

  void reopen(unsigned index) {
    const bool still_waiting = incoming_.load(std::memory_order_acquire) != kNoDescriptor ||
                               retired_.load(std::memory_order_acquire) != kNoDescriptor;
    if (still_waiting) return;
    const int descriptor = open_can_socket(index, ids_);
    if (descriptor < 0) return;  // removed again meanwhile; the next round tries once more
    index_ = index;
    incoming_.store(descriptor, std::memory_order_release);
  }

  const std::string interface_;
  const std::vector<std::uint32_t> ids_;
  unsigned index_;  // watcher's
  int descriptor_;  // receiver's
  CanBatch batch_;  // receiver's
  std::atomic<int> incoming_{kNoDescriptor}, retired_{kNoDescriptor};
  std::atomic<bool> lost_{false};  // the receiver was told ENODEV
  std::atomic<BusState> state_{BusState::up};
  CountedBus counted_;
  std::jthread watcher_;
  static_assert(std::atomic<int>::is_always_lock_free && std::atomic<BusState>::is_always_lock_free);
};

}  // namespace

std::unique_ptr<CanBus> open_socketcan_bus(const std::string& interface, std::span<const std::uint32_t> ids) {
  const std::string bus = "socketcan:" + interface;
  if (!kernel_has_can()) {
    throw ComponentError(bus +
                         ": this kernel has no CAN sockets; load them with `modprobe can_raw`, or use log: or local:");
  }
  if (interface_index(interface) == 0) {
    throw ComponentError(bus + ": no such interface; start it with `ip link set " + interface +
                         " up type can bitrate 1000000 dbitrate 5000000 fd on`, or for a virtual one `ip link add " +
                         interface + " type vcan && ip link set " + interface + " mtu 72 up`");
  }
  return std::make_unique<SocketCanBus>(interface, ids);
}

}  // namespace stillcut
