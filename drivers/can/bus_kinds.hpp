// The three kinds of CAN bus behind open_can_bus, and the counters they share. For drivers/can only.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "drivers/can/can_bus.hpp"

namespace stillcut {

std::unique_ptr<CanBus> open_socketcan_bus(const std::string& interface, std::span<const std::uint32_t> ids);
std::unique_ptr<CanBus> open_log_bus(const std::string& file_and_speed);
std::unique_ptr<CanBus> open_local_bus(const std::string& name);

// A number that one thread raises and any thread reads. Wait-free; relaxed, since each stands for itself.
class Counter {
 public:
  void add(std::int64_t n) noexcept { set(get() + n); }
  void set(std::int64_t n) noexcept { value_.store(n, std::memory_order_relaxed); }
  [[nodiscard]] std::int64_t get() const noexcept { return value_.load(std::memory_order_relaxed); }

 private:
  static_assert(std::atomic<std::int64_t>::is_always_lock_free);
  std::atomic<std::int64_t> value_{0};
};

// BusCounters while they are counted: the thread of receive() raises them, any thread takes a copy.
struct CountedBus {
  static constexpr std::uint32_t kBusOff = 0x40;  // CAN_ERR_BUSOFF of linux/can/error.h
  Counter frames, frames_bad, dropped, error_frames, bus_off, reopened;

  void delivered(const CanFrame& frame) noexcept {
    frames.add(1);
    if (!frame.is_error()) return;
    error_frames.add(1);
    if ((frame.id & kBusOff) != 0) bus_off.add(1);
  }
  [[nodiscard]] BusCounters copy() const noexcept {
    return {.frames = frames.get(),
            .frames_bad = frames_bad.get(),
            .dropped = dropped.get(),
            .error_frames = error_frames.get(),
            .bus_off = bus_off.get(),
            .reopened = reopened.get()};
  }
};

}  // namespace stillcut
