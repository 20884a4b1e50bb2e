// The memory that processes on a local bus share: a ring of the newest frames that any of them writes and all of them
// read, each at its own pace, as nodes on a CAN bus do. All-zero memory is an empty ring, so nobody has to set it up,
// and no process's death leaves anything locked.
//
// A writer takes a ticket (its frame's place in the order of all frames), marks the slot ticket % kLocalSlots as being
// written, writes, and marks it as holding the ticket. A reader at place p takes the slot's words only when the slot
// says "holds p" before and after the copy. The words are atomic with release stores and acquire loads: a reader that
// sees one word of a later writer also sees that writer's mark, and drops the copy.
//
//   writer of ticket t                    reader at p = t
//   mark = 2t+1   (acq_rel)               mark == 2p+2 ?        (acquire)  else: not there yet, or lost
//   words         (release)               copy words            (acquire)
//   mark = 2t+2   (release)               mark == 2p+2 still ?             else: overwritten meanwhile, lost
//
// Progress: write() and read() are wait-free. A writer that dies inside a slot costs the readers that one frame (they
// pass it once kLocalPatience later ones were begun), and writers one frame a lap, since nobody may write where it
// stopped.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <optional>

#include "rt/can_frame.hpp"

namespace stillcut {

inline constexpr std::uint64_t kLocalSlots = 16384;  // 6 s of 2667 frames/s; a power of two
inline constexpr std::uint64_t kLocalPatience = 64;

class LocalRing {
 public:
  // Any process, any thread. False: the slot's last writer has not finished; the frame is not sent.
  bool write(const CanFrame& frame, std::uint32_t member) noexcept {
    const std::optional<std::uint64_t> ticket = begin_write();
    if (!ticket) return false;
    Slot& slot = slots_[*ticket % kLocalSlots];
    std::array<std::uint64_t, kWords> words{member};
    std::memcpy(words.data() + 1, &frame, sizeof frame);
    for (std::size_t i = 0; i < kWords; ++i) slot.words[i].store(words[i], std::memory_order_release);
    slot.mark.store(2 * *ticket + 2, std::memory_order_release);
    return true;
  }

  // The first half of write(), and all that a writer does that dies in the middle.
  std::optional<std::uint64_t> begin_write() noexcept {
    const std::uint64_t ticket = next_ticket_.fetch_add(1, std::memory_order_acq_rel);
    std::atomic<std::uint64_t>& slot_mark = slots_[ticket % kLocalSlots].mark;
    std::uint64_t mark = slot_mark.load(std::memory_order_relaxed);
    if ((mark & 1) != 0 || mark > 2 * ticket) return std::nullopt;
    if (!slot_mark.compare_exchange_strong(mark, 2 * ticket + 1, std::memory_order_acq_rel)) return std::nullopt;
    return ticket;
  }

  enum class Read : std::uint8_t { nothing, frame, lost };

  // `place` is the reader's own and moves on past what was read or lost; `lost` says how many frames were passed.
  Read read(std::uint64_t& place, CanFrame& frame, std::uint32_t& member, std::uint64_t& lost) const noexcept {
    const std::uint64_t newest = next_ticket_.load(std::memory_order_acquire);
    if (newest - place > kLocalSlots) {  // overrun; half a ring on, so that the next writers do not overtake at once
      lost = newest - kLocalSlots / 2 - place;
      place += lost;
      return Read::lost;
    }
    if (place == newest) return Read::nothing;
    const Slot& slot = slots_[place % kLocalSlots];
    const std::uint64_t wanted = 2 * place + 2;
    const std::uint64_t mark = slot.mark.load(std::memory_order_acquire);
    if (mark < wanted && newest - place <= kLocalPatience) return Read::nothing;
    if (mark == wanted) {
      std::array<std::uint64_t, kWords> words{};
      for (std::size_t i = 0; i < kWords; ++i) words[i] = slot.words[i].load(std::memory_order_acquire);
      if (slot.mark.load(std::memory_order_relaxed) == wanted) {
        member = static_cast<std::uint32_t>(words[0]);
        std::memcpy(static_cast<void*>(&frame), words.data() + 1, sizeof frame);
        ++place;
        return Read::frame;
      }
    }
    lost = 1;
    ++place;
    return Read::lost;
  }

  // Where a reader begins that wants what is sent from now on.
  [[nodiscard]] std::uint64_t end() const noexcept { return next_ticket_.load(std::memory_order_acquire); }

  // A number for each member, so that it can leave out its own frames.
  std::uint32_t join() noexcept { return members_.fetch_add(1, std::memory_order_relaxed); }

 private:
  static constexpr std::size_t kWords = 1 + (sizeof(CanFrame) + 7) / 8;
  struct Slot {
    std::atomic<std::uint64_t> mark;
    std::array<std::atomic<std::uint64_t>, kWords> words;
  };
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);  // across processes only lock-free atomics work
  static_assert(sizeof(CanFrame) % 8 == 0);

  alignas(64) std::atomic<std::uint64_t> next_ticket_;
  std::atomic<std::uint32_t> members_;
  alignas(64) std::array<Slot, kLocalSlots> slots_;
};

}  // namespace stillcut
