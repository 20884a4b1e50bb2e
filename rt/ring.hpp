// A ring buffer that carries a stream of items, in order, from exactly one thread to exactly one other without either
// ever waiting: what the real-time thread hands to the publisher, the recorder and the telemetry passes through one.
//
//   thread     method         progress                   note
//   producer   push           wait-free, no system call  false: the ring is full, the item is not taken, and it is
//   counted consumer   pop            wait-free, no system call  false: the ring is empty any        size_approx
//   wait-free                  exact only while producer and consumer rest any        refused        wait-free how many
//   pushes found the ring full
//
// Indices count up for ever and are masked on use (capacity is a power of two), so full and empty differ and every slot
// serves. Each side keeps the last value it saw of the other's index and reads the shared one only when that value no
// longer suffices: most calls touch no cache line that the other side writes, but for the item itself.
#pragma once

#include <atomic>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <stdexcept>
#include <type_traits>

#include "rt/cache_line.hpp"

namespace stillcut {

template <typename T>
class Ring {
  static_assert(std::is_trivially_copyable_v<T>, "items are copied by value while the other thread works on its own");
  static_assert(std::default_initializable<T>);
  static_assert(std::atomic<std::size_t>::is_always_lock_free && std::atomic<std::uint64_t>::is_always_lock_free);

 public:
  // Allocates all slots at once and touches them. Throws std::invalid_argument unless capacity is a power of two.
  explicit Ring(std::size_t capacity) : mask_{checked(capacity) - 1}, items_{make_items(capacity)} {}

  Ring(const Ring&) = delete;
  Ring& operator=(const Ring&) = delete;

  // Producer only.
  [[nodiscard]] bool push(const T& item) noexcept {
    const std::size_t tail = producer_.tail.load(std::memory_order_relaxed);  // written by this thread alone
    if (tail - producer_.head_seen > mask_) {
      // SYNC POINT B: acquires what pop released. The consumer has finished copying out of every slot before this head,
      // so the write below cannot overtake its read.
      producer_.head_seen = consumer_.head.load(std::memory_order_acquire);
      if (tail - producer_.head_seen > mask_) {
        producer_.refused.store(producer_.refused.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
        return false;
      }
    }
    items_[tail & mask_] = item;
    // SYNC POINT A: releases the slot just written to the consumer.
    producer_.tail.store(tail + 1, std::memory_order_release);
    return true;
  }

  // Consumer only. Leaves `item` alone when there is none.
  [[nodiscard]] bool pop(T& item) noexcept {
    const std::size_t head = consumer_.head.load(std::memory_order_relaxed);  // written by this thread alone
    if (head == consumer_.tail_seen) {
      // SYNC POINT A: acquires what push released, so every slot before this tail is seen complete.
      consumer_.tail_seen = producer_.tail.load(std::memory_order_acquire);
      if (head == consumer_.tail_seen) return false;
    }
    item = items_[head & mask_];
    // SYNC POINT B: releases the slot to the producer, after the copy.
    consumer_.head.store(head + 1, std::memory_order_release);
    return true;
  }

  [[nodiscard]] std::size_t capacity() const noexcept { return mask_ + 1; }

  // Items waiting. Never above capacity.
  [[nodiscard]] std::size_t size_approx() const noexcept {
    // The acquire keeps the two loads in order: head first, so that tail, which is never behind it, cannot be either.
    const std::size_t head = consumer_.head.load(std::memory_order_acquire);
    const std::size_t size = producer_.tail.load(std::memory_order_relaxed) - head;
    return size > capacity() ? capacity() : size;  // both sides may have moved on between the loads
  }

  [[nodiscard]] std::uint64_t refused() const noexcept { return producer_.refused.load(std::memory_order_relaxed); }

 private:
  struct Free {
    void operator()(T* items) const noexcept { ::operator delete[](items, std::align_val_t{kAlignment}); }
  };
  static constexpr std::size_t kAlignment = alignof(T) > kCacheLine ? alignof(T) : kCacheLine;

  static std::size_t checked(std::size_t capacity) {
    if (!std::has_single_bit(capacity)) throw std::invalid_argument("Ring: the capacity must be a power of two");
    return capacity;
  }
  static std::unique_ptr<T[], Free> make_items(std::size_t count) {
    T* items = static_cast<T*>(::operator new[](count * sizeof(T), std::align_val_t{kAlignment}));
    std::uninitialized_value_construct_n(items, count);
    return std::unique_ptr<T[], Free>{items};
  }

  struct alignas(kCacheLine) ProducerSide {
    std::atomic<std::size_t> tail{0};  // next slot to write
    std::size_t head_seen = 0;         // at or behind the consumer's head: the ring is never fuller than this says
    std::atomic<std::uint64_t> refused{0};
  };
  struct alignas(kCacheLine) ConsumerSide {
    std::atomic<std::size_t> head{0};  // next slot to read
    std::size_t tail_seen = 0;         // at or behind the producer's tail: the ring is never emptier than this says
  };
  static_assert(sizeof(ProducerSide) == kCacheLine && sizeof(ConsumerSide) == kCacheLine, "one line for each writer");

  // Read by both, written by none after construction: a line of their own, that stays in both caches.
  alignas(kCacheLine) const std::size_t mask_;
  const std::unique_ptr<T[], Free> items_;
  ProducerSide producer_;
  ConsumerSide consumer_;
};

}  // namespace stillcut
