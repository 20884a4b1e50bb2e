// The newest value of something, passed from exactly one thread to exactly one other (triple buffer): the lobes of the
// present posture and the robot's state reach the core through it. The reader sees complete values only, never older
// after newer, and may miss values that were replaced before it looked.
//
//   thread   method    progress   note
//   writer   publish   wait-free  replaces what the reader has not fetched yet
//   reader   update    wait-free  true: a newer value has arrived and is now the one that value() shows
//   reader   value     wait-free  stays the same, in place and content, until the next update()
//
// Three slots: `back` belongs to the writer, `front` to the reader, and `middle` lies between them to be exchanged.
// Each method is one copy or none and one atomic exchange (a single instruction on x86-64 and ARMv8.1; a retried pair,
// so lock-free, on older ARM).
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

#include "rt/cache_line.hpp"

namespace stillcut {

template <typename T>
class Snapshot {
  static_assert(std::is_trivially_copyable_v<T>, "values are copied by value while the other thread works on its own");
  static_assert(std::atomic<std::uint32_t>::is_always_lock_free);

 public:
  // Before the first publish the reader sees `initial`.
  explicit Snapshot(const T& initial = T{}) noexcept {
    for (Slot& slot : slots_) slot.value = initial;
  }

  Snapshot(const Snapshot&) = delete;
  Snapshot& operator=(const Snapshot&) = delete;

  // Writer only.
  void publish(const T& value) noexcept {
    slots_[back_].value = value;
    // SYNC POINT A, release: the reader that takes this slot sees the whole value.
    // SYNC POINT B, acquire: the slot got back is one that the reader has finished with (or never had).
    back_ = middle_.exchange(back_ | kNewer, std::memory_order_acq_rel) & kIndex;
  }

  // Reader only.
  bool update() noexcept {
    // Relaxed is enough to look: only this thread takes the mark away, and the exchange below synchronises.
    if ((middle_.load(std::memory_order_relaxed) & kNewer) == 0) return false;
    // SYNC POINT A, acquire: pairs with the publish that filled the slot taken here.
    // SYNC POINT B, release: the reads of the slot given back are over before the writer may fill it.
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    return true;
  }

  // Reader only.
  [[nodiscard]] const T& value() const noexcept { return slots_[front_].value; }

 private:
  static constexpr std::uint32_t kIndex = 3, kNewer = 4;

  struct alignas(kCacheLine) Slot {
    T value;
  };
  static_assert(sizeof(Slot) % kCacheLine == 0, "no line is shared by two slots");

  std::array<Slot, 3> slots_;
  alignas(kCacheLine) std::atomic<std::uint32_t> middle_{1};  // slot index, with kNewer when not yet fetched
  alignas(kCacheLine) std::uint32_t back_ = 0;                // writer's
  alignas(kCacheLine) std::uint32_t front_ = 2;               // reader's
};

}  // namespace stillcut
